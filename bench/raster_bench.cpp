// Table 7.2 of Tsai 2009: frames per second of a mesh under three directional lights at 640 x 480, rendered off screen,
// and the cost of shading: the time of a frame (CPU ms of all threads if the library renders on the CPU, otherwise its
// own clock) minus that of the same frame with a constant f_r. Minimum over 60 frames (20 in one pass), with
// alternating materials and back faces culled. The load average shows other activity on the machine; the column ms CPU
// is least sensitive to it.
//
// In two passes each pixel is shaded once. In one pass every triangle that touches a block of 4 x 2 pixels shades the
// whole block, and scans have more triangles than pixels. (There llvmpipe's clock does not include its threads: fps GPU
// is meaningless.)
//
// SU by the index texture is limited by its lookups and by K J = 15 exponentials per light: a texel of neighbours, 4
// directions and 30 texels of parameters per pixel, read once for the three lights. PM reads its numbers from a uniform
// buffer, which takes half of its time on llvmpipe. General lobes cost twice as much as axial ones for the same
// function.
#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "extras/render/frames.h"
#include "models/pm/search/fit_pm.h"
#include "models/su/fit_su.h"
#include "models/su/su_functions.h"
#include "srbf/metrics.h"

namespace srbf {
namespace {

struct NamedMaterial {
    std::string name;
    Material material;
};

/// The compared materials: the vinyl film as either model, after a constant f_r.
std::vector<NamedMaterial> materials() {
    const Measured film = *load_measured(SRBF_SOURCE_DIR "/data/cc_ibiza_sunset_rgb.bsdf");
    const Evaluate f = signed_evaluator(film);
    const Observations observations = *observe(f, {});
    std::vector<NamedMaterial> all{{"constant f_r", Flat{}}};
    const auto add_pm = [&](const char* name, PmForm form, bool axial, int lobes, int variates) {
        PmFitOptions options;
        options.form = form, options.lobes = lobes, options.variates = variates;
        PmModel model = rounded(fit_pm(observations, options)->model);
        model.axial = axial;  // the same function, evaluated like a general one
        all.push_back({name, std::move(model)});
    };
    add_pm("PM source    J=6 N=3 axial", PmForm::gaussian, true, 6, 3);
    add_pm("PM source    J=6 N=3 general", PmForm::gaussian, false, 6, 3);
    add_pm("PM extended  J=8 N=4 axial", PmForm::extended, true, 8, 4);
    SuFitOptions options;
    options.lobes = 5;
    SuModel su = rounded(fit_su(*tabulate(f), options)->model);
    su.index = index_texture(su, DirectionMap::cube);
    su.interpolation = SuInterpolation::plain;
    all.push_back({"SU index texture  J=5 K=3", su});
    su.interpolation = SuInterpolation::rotated;
    all.push_back({"SU rotated        J=5", su});
    return all;
}

/// A table of all materials on one mesh: in two passes without multisampling, or in one pass with four samples.
Result<Done> compare(const OffscreenContext& context, const Scene& scene, const std::vector<NamedMaterial>& all,
                     PixelInput input) {
    const bool two_passes = input == PixelInput::surface;
    std::vector<Material> materials;
    for (const NamedMaterial& named : all) materials.push_back(named.material);
    const auto costs = time_frames(context, scene, materials, {.input = input, .frames = two_passes ? 60 : 20});
    if (!costs) return costs.error();
    // If the library renders on the CPU, its CPU time is measured.
    const auto work = [&](std::size_t i) {
        return draws_on_cpu(context) ? (*costs)[i].least.cpu : (*costs)[i].least.gpu;
    };
    const auto shading = [&](std::size_t i) { return work(i) - work(0); };
    fmt::print("{:30}{:>9}{:>10}{:>10}{:>10}{:>12}{:>9}{:>11}\n",
               two_passes ? "two passes, 1 sample" : "one pass, 4 samples", "fps GPU", "fps wall", "ms wall", "ms CPU",
               "ms shading", "bytes", "auxiliary");
    for (std::size_t i = 0; i < costs->size(); ++i) {
        const auto& [least, data_bytes, auxiliary_bytes] = (*costs)[i];
        fmt::print("  {:28}{:9.1f}{:10.1f}{:10.2f}{:10.2f}{:12.2f}{:9}{:11}\n", all[i].name, 1e3 / least.gpu,
                   1e3 / least.wall, least.wall, least.cpu, shading(i), data_bytes, auxiliary_bytes);
    }
    fmt::print("  shading, SU by the index texture : PM of the source's form = {:.1f} (axial), {:.1f} (general)\n",
               shading(4) / shading(1), shading(4) / shading(2));
    return Done{};
}

Result<Done> run() {
    const auto context = OffscreenContext::make(Dialect::gl_450);
    if (!context) return context.error();
    double load = 0;
    getloadavg(&load, 1);
    fmt::print("{}, {} cores, load average before {:.1f}\n", context->renderer(), std::thread::hardware_concurrency(),
               load);
    const char* const data = std::getenv("SRBF_DATA");
    const auto folder =
        (data ? std::filesystem::path(data) : std::filesystem::path(SRBF_SOURCE_DIR "/../shared/data")) / "meshes";
    const auto all = materials();
    for (const std::string name : {"bunny.ply", "buddha.obj", "dragon.ply", "knot"}) {
        const bool is_file = std::filesystem::exists(folder / name);
        if (!is_file && name != "knot") continue;
        auto mesh = load_mesh(is_file ? (folder / name).string() : name);
        if (!mesh) return mesh.error();
        const Scene scene = scene_of(*std::move(mesh), {.azimuth = 0.4, .z_up = name.starts_with("buddha")}, 4.0 / 3);
        fmt::print("\n{}: {} vertices, {} triangles\n", name, scene.mesh.positions.size(), scene.mesh.triangles.size());
        for (const PixelInput input : {PixelInput::surface, PixelInput::triangles})
            if (const auto done = compare(*context, scene, all, input); !done) return done;
    }
    return Done{};
}

}  // namespace
}  // namespace srbf

/// Skipped if `--benchmark_filter=WORD` does not match it, like the other benchmarks.
int main(int argc, char** argv) {
    constexpr std::string_view option = "--benchmark_filter=";
    for (const std::string_view argument : std::span(argv, std::size_t(argc)))
        if (argument.starts_with(option) && !std::string_view("raster").starts_with(argument.substr(option.size())))
            return 0;
    const auto done = srbf::run();
    if (!done) fmt::print("{}\n", srbf::message(done.error()));
}
