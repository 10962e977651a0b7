// Table 7.2 of the source anew: frames a second of a mesh under three directional lights at 640 x 480, 4 samples a pixel, drawn off
// screen, and what shading costs: a frame's time less that of the same frame in one flat colour.
#include <epoxy/gl.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "render/raster.h"
#include "srbf/fit.h"
#include "srbf/metrics.h"

namespace srbf {
namespace {

constexpr int k_width = 640, k_height = 480, k_samples = 4, k_rounds = 24;

using Clock = std::chrono::steady_clock;

/// Milliseconds of a frame by the graphics library's own clock, where it has one, and by ours.
struct FrameTime {
    double gpu = 0, wall = 0;
};

FrameTime timed(const RasterTarget& target, const RasterMaterial& material, const RasterMesh& mesh,
                const RasterView& view) {
    GLuint query = 0;
    glGenQueries(1, &query);
    glFinish();
    const auto begin = Clock::now();
    glBeginQuery(GL_TIME_ELAPSED, query);
    target.begin();
    material.draw(mesh, view);
    glEndQuery(GL_TIME_ELAPSED);
    glFinish();
    const double wall = 1e3 * std::chrono::duration<double>(Clock::now() - begin).count();
    GLuint64 nanoseconds = 0;
    glGetQueryObjectui64v(query, GL_QUERY_RESULT, &nanoseconds);
    glDeleteQueries(1, &query);
    return {1e-6 * double(nanoseconds), wall};
}

double median(std::vector<double> of) {
    std::nth_element(of.begin(), of.begin() + std::ptrdiff_t(of.size() / 2), of.end());
    return of[of.size() / 2];
}

struct NamedMaterial {
    std::string name;
    Material material;
};

std::vector<NamedMaterial> materials() {
    const Measured film = *load_measured(SRBF_SOURCE_DIR "/data/cc_ibiza_sunset_rgb.bsdf");
    const Evaluate f = signed_evaluator(film);
    ObserveOptions what;
    what.objective = Objective::raw;
    const Observations observations = *observe(f, what);
    std::vector<NamedMaterial> all{{"one colour", Flat{}}};
    const auto add_pm = [&](const char* name, PmForm form, bool axial, int lobes, int variates) {
        FitOptions options;
        options.form = form, options.lobes = lobes, options.variates = variates;
        PmModel model = rounded(fit_pm(observations, options)->model);
        model.axial = axial;  // what an axial model costs as a general one; it is the same function
        all.push_back({name, std::move(model)});
    };
    add_pm("PM source, J = 6, N = 3, general", PmForm::source, false, 6, 3);
    add_pm("PM source, J = 6, N = 3, axial", PmForm::source, true, 6, 3);
    add_pm("PM extended, J = 8, N = 4, axial", PmForm::extended, true, 8, 4);
    SuFitOptions su;
    su.lobes = 5, su.objective = Objective::raw;
    SuModel model = rounded(fit_su(*tabulate(f), su)->model);
    all.push_back({"SU rotated, J = 5", model});
    model.interpolation = SuInterpolation::plain;
    model.index = index_texture(model, DirectionMap::cube);
    all.push_back({"SU texture, J = 5, K = 3", model});
    return all;
}

int run() {
    const auto context = OffscreenContext::make(Dialect::gl_450);
    if (!context) return fmt::print("{}\n", message(context.error())), 0;
    fmt::print("{}\n", context->renderer());
    const char* const data = std::getenv("SRBF_DATA");
    const auto folder =
        (data ? std::filesystem::path(data) : std::filesystem::path(SRBF_SOURCE_DIR "/../shared/data")) / "meshes";
    const auto target = RasterTarget::make(k_width, k_height, k_samples, RasterTarget::Format::bytes);
    const auto all = materials();

    for (const char* name : {"bunny.ply", "buddha.obj", "dragon.ply", "knot", "sphere"}) {
        const bool is_built_in = std::ranges::find(k_built_in_meshes, name) != k_built_in_meshes.end();
        if (!is_built_in && !std::filesystem::exists(folder / name)) continue;
        const auto loaded = load_mesh(is_built_in ? name : (folder / name).string());
        if (!loaded) return fmt::print("{}\n", message(loaded.error())), 1;
        const bool z_up = std::string_view(name).starts_with("buddha");
        const Scene scene = scene_of(*loaded, {.azimuth = 0.4, .z_up = z_up}, double(k_width) / k_height);
        const RasterMesh mesh(scene.mesh);
        const RasterView view{scene.camera, double(k_width) / k_height, scene.lights, 1};

        std::vector<RasterMaterial> made;
        for (const NamedMaterial& of : all) {
            auto material = RasterMaterial::make(of.material, {Dialect::gl_450, PixelOutput::shown, 3});
            if (!material) return fmt::print("{}\n", message(material.error())), 1;
            made.push_back(*std::move(material));
        }
        std::vector<std::vector<double>> gpu(made.size()), wall(made.size());
        for (int round = -2; round < k_rounds; ++round)  // in turn, so that what else the machine does hits all alike
            for (std::size_t i = 0; i < made.size(); ++i) {
                const FrameTime time = timed(*target, made[i], mesh, view);
                if (round < 0) continue;
                gpu[i].push_back(time.gpu), wall[i].push_back(time.wall);
            }
        fmt::print("\n{}: {} vertices, {} triangles\n{:34}{:>10}{:>10}{:>12}{:>12}{:>10}{:>12}\n", name,
                   scene.mesh.positions.size(), scene.mesh.triangles.size(), "", "fps GPU", "fps wall", "ms a frame",
                   "ms shading", "bytes", "auxiliary");
        for (std::size_t i = 0; i < made.size(); ++i)
            fmt::print("{:34}{:10.1f}{:10.1f}{:12.2f}{:12.2f}{:10}{:12}\n", all[i].name, 1e3 / median(gpu[i]),
                       1e3 / median(wall[i]), median(wall[i]), median(wall[i]) - median(wall[0]), made[i].data_bytes(),
                       made[i].auxiliary_bytes());
    }
    return 0;
}

}  // namespace
}  // namespace srbf

int main() { return srbf::run(); }
