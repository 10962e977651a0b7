// Frames per second of the fitted models, for comparison with Table 7.2 of Tsai 2009.
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "app/memory.h"
#include "extras/render/material.h"
#include "extras/report/study.h"
#ifdef SRBF_RASTER
#include "extras/render/frames.h"
#include "models/su/su_functions.h"
#endif

namespace SRBF_NAMESPACE {

#ifdef SRBF_RASTER
namespace {

struct TimedModel {
    std::string id;
    bool by_texture;  ///< evaluates a view-by-view model with an index texture, as in Tsai 2009
};

/// The models of Tsai 2009's timings, and the default model, if they were fitted.
std::vector<TimedModel> timed_models(const Study& study) {
    std::vector<TimedModel> models;
    const Json& fits = study.material.at("fits");
    const auto add = [&](auto&& matches, bool by_texture) {
        const auto fit = std::ranges::find_if(fits, matches);
        if (fit != fits.end()) models.push_back({(*fit)["id"], by_texture});
    };
    const auto by_role = [](const char* role) { return [role](const Json& fit) { return fit["role"] == role; }; };
    const auto by_id = [](const char* id) { return [id](const Json& fit) { return fit["id"] == id; }; };
    add(by_role("su"), true);
    add(by_role("su"), false);
    add(by_id("pm-source-6x3-raw"), false);
    add(by_id("pm-source-8x4-raw"), false);
    add(by_role("pm"), false);
    add(by_role("ggx"), false);
    return models;
}

}  // namespace

Result<Done> time_study(Study& study, const StudyOptions& options) {
    if (const auto can_draw = check_drawing(); !can_draw) return can_draw;
    const auto context = OffscreenContext::make(Dialect::gl_450);
    if (!context) return context.error();
    const FrameOptions frame_options{.frames = options.sweep == Sweep::whole   ? 60
                                               : options.sweep == Sweep::quick ? 20
                                                                               : 1};
    auto mesh = load_mesh(options.mesh);
    if (!mesh) return mesh.error();
    const Scene scene = scene_of(*std::move(mesh), {.azimuth = 0.4, .z_up = options.z_up},
                                 double(frame_options.width) / frame_options.height);
    const std::vector<TimedModel> models = timed_models(study);
    std::vector<Material> materials{Flat{}};
    for (const TimedModel& timed : models) {
        auto model = load_model((std::filesystem::path(study.folder) / (timed.id + ".srbf")).string());
        if (!model) return model.error();
        if (timed.by_texture) {
            auto& su = std::get<SuModel>(model->model);
            su.interpolation = SuInterpolation::plain;
            su.index = index_texture(su, DirectionMap::cube);
        }
        materials.push_back(material_of(*model));
    }
    const auto costs = time_frames(*context, scene, materials, frame_options);
    if (!costs) return costs.error();
    const bool on_cpu = draws_on_cpu(*context);
    Json rows = Json::array();
    for (std::size_t i = 0; i < costs->size(); ++i) {
        const FrameCost& cost = (*costs)[i];
        // If the library renders on the CPU, only wall-clock time includes all of its work.
        const double milliseconds = on_cpu ? cost.least.wall : cost.least.gpu;
        rows.push_back({{"id", i == 0 ? "constant" : models[i - 1].id},
                        {"drawn", i == 0                     ? "constant f_r"
                                  : models[i - 1].by_texture ? "by index texture"
                                                             : "formula"},
                        {"data_bytes", cost.data_bytes},
                        {"auxiliary_bytes", cost.auxiliary_bytes},
                        {"total_bytes", cost.data_bytes + cost.auxiliary_bytes},
                        {"frames_per_second", 1e3 / milliseconds},
                        {"milliseconds", milliseconds},
                        {"cpu_milliseconds", cost.least.cpu}});
    }
    study.frames = {{"renderer", context->renderer()},
                    {"mesh", options.mesh},
                    {"triangles", scene.mesh.triangles.size()},
                    {"width", frame_options.width},
                    {"height", frame_options.height},
                    {"frames", frame_options.frames},
                    {"rows", rows}};
    return write_json(study.frames, (std::filesystem::path(study.folder) / "frames.json").string());
}
#else
Result<Done> time_study(Study&, const StudyOptions&) {
    return Error{"renderer raster", {}, "this program", "one built with libepoxy", "one without"};
}
#endif

}  // namespace srbf
