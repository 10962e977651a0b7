// Accuracy of the view-by-view model compared with the multivariate one: for each file a table over the number of
// lobes, and the error at novel views as a function of the number of sampled views, of the interpolation and of the
// index texture. Objective raw, directions within 80 degrees.
//   usage: su_accuracy FILE...
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "fit/fits.h"
#include "srbf/measured.h"
#include "srbf/metrics.h"
#include "srbf/model.h"

namespace srbf {
namespace {

constexpr double k_cap = 80 * k_degree;
const MeasureOptions k_within{k_cap, 0};

/// CPU seconds of all threads.
double processor_seconds() { return double(std::clock()) / CLOCKS_PER_SEC; }

double percent(const Measures& measures) { return 100 * measures.squared_error_ratio; }

SuModel with(SuModel model, SuInterpolation interpolation, int neighbours = 3) {
    model.interpolation = interpolation;
    model.neighbours = neighbours;
    return model;
}

void print_lobes(const Measured& measured) {
    fmt::print(
        "\n| J | SU bytes | matrix | held out | plain | processor s | PM source bytes | matrix | held out | PM "
        "extended bytes | "
        "matrix | held out |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n");
    const Evaluate f = evaluator(measured);
    const auto matrix = *tabulate(signed_evaluator(measured));
    const auto observations = *observe(signed_evaluator(measured), {.objective = Objective::raw});
    for (const int lobes : {2, 3, 4, 5, 6, 8}) {
        const double start = processor_seconds();
        const auto fit = *fit_su(matrix, {.lobes = lobes, .objective = Objective::raw});
        const double seconds = processor_seconds() - start;
        const SuModel plain = with(fit.model, SuInterpolation::plain);
        const Evaluate su[] = {evaluator(fit.model), evaluator(plain)};
        const auto own = measure_matrix(f, std::span(su).first(1), k_within, fit.model.direction),
                   heldout = measure_heldout(f, su, k_within);
        fmt::print("| {} | {} | {:.3g} % | {:.3g} % | {:.3g} % | {:.2f} |", lobes, payload_bytes(fit.model),
                   percent(own[0]), percent(heldout[0]), percent(heldout[1]), seconds);
        for (const PmForm form : {PmForm::gaussian, PmForm::extended}) {
            const auto pm = *fit_pm(observations, {.form = form, .lobes = lobes});
            const Evaluate others[] = {evaluator(pm.model)};
            fmt::print(" {} | {:.3g} % | {:.3g} % |", payload_bytes(pm.model),
                       percent(measure_matrix(f, others, k_within)[0]),
                       percent(measure_heldout(f, others, k_within)[0]));
        }
        fmt::print("\n");
        std::fflush(stdout);
    }
}

void print_directions(const Measured& measured) {
    fmt::print(
        "\n| n | bytes | matrix | rotated | plain, K = 3 | K = 4 | K = 7 | matrix alone: matrix | rotated | plain |\n"
        "|---|---|---|---|---|---|---|---|---|---|\n");
    const Evaluate f = evaluator(measured);
    for (const int n : {384, 768, 1536, 3072}) {
        const auto fit_of = [&](int between) {
            const auto matrix = *tabulate(signed_evaluator(measured), {.directions = n, .between = between});
            return fit_su(matrix, {.lobes = 4, .objective = Objective::raw})->model;
        };
        const SuModel model = fit_of(TabulateOptions{}.between), alone = fit_of(0);
        const SuModel models[] = {model,
                                  with(model, SuInterpolation::plain, 3),
                                  with(model, SuInterpolation::plain, 4),
                                  with(model, SuInterpolation::plain, 7),
                                  alone,
                                  with(alone, SuInterpolation::plain, 3)};
        std::vector<Evaluate> others;
        for (const SuModel& one : models) others.push_back(evaluator(one));
        const auto heldout = measure_heldout(f, others, k_within),
                   own = measure_matrix(f, others, k_within, model.direction);
        fmt::print(
            "| {} | {} | {:.3g} % | {:.3g} % | {:.3g} % | {:.3g} % | {:.3g} % | {:.3g} % | {:.3g} % | {:.3g} % |\n", n,
            payload_bytes(model), percent(own[0]), percent(heldout[0]), percent(heldout[1]), percent(heldout[2]),
            percent(heldout[3]), percent(own[4]), percent(heldout[4]), percent(heldout[5]));
        std::fflush(stdout);
    }
}

/// Neighbours from a texel compared with the exact ones: the squared error ratio between the two, at independent pairs.
void print_textures(const Measured& measured) {
    const auto matrix = *tabulate(signed_evaluator(measured));
    const SuModel model =
        with(fit_su(matrix, {.lobes = 4, .objective = Objective::raw})->model, SuInterpolation::plain);
    fmt::print("\n| texels a side | 16 | 32 | 64 | 128 | 256 |\n|---|---|---|---|---|---|\n");
    for (const auto map : {DirectionMap::cube, DirectionMap::parabolic}) {
        fmt::print("| {} |", name(map));
        for (const int size : {16, 32, 64, 128, 256}) {
            const IndexTexture index = index_texture(model, map, size);
            const Evaluate exact = evaluator(model);
            const Evaluate others[] = {[&](std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f) {
                for (std::size_t i = 0; i < f.size(); ++i) f[i] = value(model, index, wl[i], wv[i]);
            }};
            fmt::print(" {:.2g} % |", percent(measure_heldout(exact, others, k_within)[0]));
        }
        fmt::print("\n");
    }
}

}  // namespace
}  // namespace srbf

int main(int argc, char** argv) {
    using namespace srbf;
    if (argc < 2) {
        fmt::print(stderr, "usage: {} FILE...\n", argv[0]);
        return 2;
    }
    for (int i = 1; i < argc; ++i) {
        const auto measured = load_measured(argv[i]);
        if (!measured) {
            fmt::print(stderr, "{}\n", message(measured.error()));
            return 1;
        }
        fmt::print("\n## {}\n", std::filesystem::path(argv[i]).stem().string());
        print_lobes(*measured);
        print_directions(*measured);
        print_textures(*measured);
    }
    return 0;
}
