// Frames per second of the fitted models, for comparison with Table 7.2 of Tsai 2009.
#include <algorithm>
#include <ctime>
#include <filesystem>
#include <limits>

#include "app/memory.h"
#include "extras/render/material.h"
#include "extras/report/study.h"
#ifdef SRBF_RASTER
#include <epoxy/gl.h>

#include "extras/render/offscreen.h"
#include "extras/render/raster.h"
#include "models/su/su_functions.h"
#endif

namespace SRBF_NAMESPACE {

#ifdef SRBF_RASTER
namespace {

struct TimedModel {
    std::string id;
    bool by_texture;  ///< evaluates a view-by-view model with an index texture, as in Tsai 2009
};

/// The models of Tsai 2009's timings, and the model of the main fit, if they were fitted.
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

/// Milliseconds of a frame: by the graphics library's clock, by the wall clock, and as CPU time of all threads.
struct FrameTime {
    double gpu, wall, cpu;
};

/// Draws a frame and waits for it. With `on_cpu` the query ends only after that, because a library that draws later
/// on other threads would stop its clock before it begins.
template <typename Draw> FrameTime time_frame(const Draw& draw, bool on_cpu) {
    GLuint query = 0;
    glGenQueries(1, &query);
    glFinish();
    const std::clock_t cpu_before = std::clock();
    const Stopwatch watch;
    glBeginQuery(GL_TIME_ELAPSED, query);
    draw();
    if (on_cpu) glFinish();
    glEndQuery(GL_TIME_ELAPSED);
    glFinish();
    const double wall = 1e3 * watch.seconds(), cpu = 1e3 * double(std::clock() - cpu_before) / CLOCKS_PER_SEC;
    GLuint64 nanoseconds = 0;
    glGetQueryObjectui64v(query, GL_QUERY_RESULT, &nanoseconds);
    glDeleteQueries(1, &query);
    return {1e-6 * double(nanoseconds), wall, cpu};
}

/// The cost of drawing with a material: the minimum over all frames, separately for each clock, and the size of the
/// data that a pixel looks up.
struct FrameCost {
    FrameTime min;
    std::size_t data_bytes, auxiliary_bytes;
};

constexpr int k_frame_width = 640, k_frame_height = 480;

/// Draws the scene with each material in two passes with one sample per pixel, with back faces culled. Materials
/// alternate, so that other load on the machine affects all of them equally.
Result<std::vector<FrameCost>> time_frames(Dialect dialect, bool on_cpu, const Scene& scene,
                                           std::span<const Material> materials, int frames) {
    const RasterMesh mesh(scene.mesh);
    const RasterView view{scene.camera, double(k_frame_width) / k_frame_height, scene.lights, 3, false};
    const auto surface = RasterSurface::make(dialect, k_frame_width, k_frame_height);
    if (!surface) return surface.error();
    const auto target = RasterTarget::make_for(*surface);
    if (!target) return target.error();
    std::vector<RasterMaterial> raster_materials;
    std::vector<FrameCost> costs;
    constexpr double never = std::numeric_limits<double>::infinity();
    for (const Material& content : materials) {
        auto material = RasterMaterial::make(content, {.dialect = dialect, .input = PixelInput::surface});
        if (!material) return material.error();
        costs.push_back({{never, never, never}, material->data_bytes(), material->auxiliary_bytes()});
        raster_materials.push_back(*std::move(material));
    }
    for (int round = -2; round < frames; ++round)  // the first two rounds warm up caches
        for (std::size_t i = 0; i < raster_materials.size(); ++i) {
            const FrameTime time = time_frame(
                [&] {
                    surface->draw(mesh, view);
                    target->begin();
                    raster_materials[i].draw(*surface, view);
                },
                on_cpu);
            if (round < 0) continue;
            FrameTime& min = costs[i].min;
            min = {std::min(min.gpu, time.gpu), std::min(min.wall, time.wall), std::min(min.cpu, time.cpu)};
        }
    return costs;
}

}  // namespace

Result<Done> time_study(Study& study, const StudyOptions& options) {
    if (const auto can_draw = check_drawing(); !can_draw) return can_draw;
    const auto context = OffscreenContext::make(Dialect::gl_450);
    if (!context) return context.error();
    // If the library renders on the CPU, only wall-clock time includes all of its work.
    const bool on_cpu = context->renderer().find("llvmpipe") != std::string::npos;
    const int frames = options.sweep == Sweep::whole ? 60 : options.sweep == Sweep::quick ? 20 : 1;
    auto mesh = load_mesh(options.mesh);
    if (!mesh) return mesh.error();
    const Scene scene =
        scene_of(*std::move(mesh), {.azimuth = 0.4, .z_up = options.z_up}, double(k_frame_width) / k_frame_height);
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
    const auto costs = time_frames(context->dialect(), on_cpu, scene, materials, frames);
    if (!costs) return costs.error();
    Json rows = Json::array();
    for (std::size_t i = 0; i < costs->size(); ++i) {
        const FrameCost& cost = (*costs)[i];
        const double milliseconds = on_cpu ? cost.min.wall : cost.min.gpu;
        rows.push_back({{"id", i == 0 ? "constant" : models[i - 1].id},
                        {"drawn", i == 0                     ? "constant f_r"
                                  : models[i - 1].by_texture ? "by index texture"
                                                             : "formula"},
                        {"data_bytes", cost.data_bytes},
                        {"auxiliary_bytes", cost.auxiliary_bytes},
                        {"total_bytes", cost.data_bytes + cost.auxiliary_bytes},
                        {"frames_per_second", 1e3 / milliseconds},
                        {"milliseconds", milliseconds},
                        {"cpu_milliseconds", cost.min.cpu}});
    }
    study.frames = {{"renderer", context->renderer()},
                    {"mesh", options.mesh},
                    {"triangles", scene.mesh.triangles.size()},
                    {"width", k_frame_width},
                    {"height", k_frame_height},
                    {"frames", frames},
                    {"rows", rows}};
    return write_json(study.frames, (std::filesystem::path(study.folder) / "frames.json").string());
}
#else
Result<Done> time_study(Study&, const StudyOptions&) {
    return Error{"renderer raster", {}, "this program", "one built with libepoxy", "one without"};
}
#endif

}  // namespace
