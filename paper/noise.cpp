// Noise of the path tracer: the mesh in the bundled studio without ground, with each measurement's fit of form extended,
// 8 lobes, and with the measurement itself. Directions to the light are sampled from the prepared mixture or from the cosine; the
// environment is sampled in all cases. Prints the number of paths needed for the same error, relative to the fit with
// its mixture, and in brackets the time on one thread, also relative. The error is the mean squared error of the
// displayed picture (tone-mapped, sRGB) over the mesh's pixels, against a picture with 16 times as many paths; the
// number of paths is its inverse.
//   usage: noise MESH FILE...
#include <fmt/format.h>

#include <ctime>
#include <filesystem>

#include "extras/render/path.h"
#include "models/pm/search/fit_pm.h"
#include "srbf/measured.h"

namespace srbf {
namespace {

constexpr int k_size = 128, k_samples = 32;

struct Cost {
    double error, seconds;  ///< of k_samples paths per pixel
};

PathPicture picture(const PathScene& scene, int samples, std::uint64_t seed) {
    return render_paths(
        scene, {.width = k_size, .height = k_size, .samples = samples, .seed = seed, .threads = 1, .progress = {}});
}

Cost cost(const PathScene& scene, const Image& reference, const std::vector<float>& depth) {
    const float exposure = automatic_exposure(reference);
    Cost sum{0, 0};
    constexpr int k_repeats = 4;
    for (int repeat = 0; repeat < k_repeats; ++repeat) {
        const std::clock_t start = std::clock();  // CPU time, since other processes may run
        const Image noisy = picture(scene, k_samples, std::uint64_t(repeat) + 1).rendering.radiance;
        sum.seconds += double(std::clock() - start) / CLOCKS_PER_SEC / k_repeats;
        double squares = 0, pixels = 0;
        for (std::size_t i = 0; i < depth.size(); ++i) {
            if (!(depth[i] > 0)) continue;
            const Rgb8 a = to_srgb8(reference.pixels[i], exposure), b = to_srgb8(noisy.pixels[i], exposure);
            for (std::size_t c = 0; c < 3; ++c) squares += std::pow((a[c] - b[c]) / 255.0, 2) / 3;
            ++pixels;
        }
        sum.error += squares / pixels / k_repeats;
    }
    return sum;
}

Result<Done> print_row(const std::string& path, const Mesh& mesh, const Environment& studio) {
    const auto measured = load_measured(path);
    if (!measured) return measured.error();
    const auto observations = observe(signed_evaluator(*measured), {});
    if (!observations) return observations.error();
    const auto fit = fit_pm(*observations, {});
    if (!fit) return fit.error();
    const PmModel& model = fit->model;
    PathScene scene{{{&mesh, 0}}, {}, camera_of(mesh, {}, 1), {}, {}, &studio};
    std::vector<Cost> costs;
    const auto add_costs = [&](const auto& brdf) {
        scene.materials = {prepare(brdf, propose(evaluator(brdf)))};
        const PathPicture reference = picture(scene, 16 * k_samples, 0);
        costs.push_back(cost(scene, reference.rendering.radiance, reference.first.depth));
        scene.materials = {prepare(brdf, CosineProposal{})};
        costs.push_back(cost(scene, reference.rendering.radiance, reference.first.depth));
    };
    add_costs(model);
    add_costs(*measured);
    fmt::print("| {} | {:.1f} |", std::filesystem::path(path).stem().string(), -10 * std::log10(costs[0].error));
    for (std::size_t i = 1; i < costs.size(); ++i) {
        const double paths = costs[i].error / costs[0].error;
        fmt::print(" {:.3g} ({:.3g}) |", paths, paths * costs[i].seconds / costs[0].seconds);
    }
    fmt::print("\n");
    return Done{};
}

}  // namespace
}  // namespace srbf

int main(int argc, char** argv) {
    using namespace srbf;
    if (argc < 3) return fmt::print(stderr, "usage: {} MESH FILE...\n", argv[0]), 2;
    const auto mesh = load_mesh(argv[1]);
    const auto studio = load_environment("studio");
    if (!mesh || !studio) return fmt::print(stderr, "{}\n", message(mesh ? studio.error() : mesh.error())), 1;
    fmt::print(
        "| {} | PSNR of the fit by its mixture, {} paths [dB] | fit by the cosine | table by its mixture | table "
        "by the cosine |\n",
        std::filesystem::path(argv[1]).stem().string(), k_samples);
    fmt::print("|---|---|---|---|---|\n");
    for (int i = 2; i < argc; ++i)
        if (const auto printed = print_row(argv[i], *mesh, *studio); !printed) {
            fmt::print(stderr, "{}\n", message(printed.error()));
            return 1;
        }
    return 0;
}
