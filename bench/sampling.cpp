// Quality of importance sampling: the relative variance of f cosθl / pdf (luminance) and the share of lost samples. For
// the multivariate and the view-by-view model with their own proposals; for the measurement with its own proposal, that
// of its multivariate model, and the cosine. Fits are the program's defaults, the view-by-view one with 5 lobes.
//   usage: sampling FILE...
#include <fmt/format.h>

#include <filesystem>
#include <string>
#include <vector>

#include "fit/fits.h"
#include "srbf/directions.h"
#include "srbf/measured.h"
#include "srbf/sampling.h"

namespace srbf {
namespace {

constexpr double k_thetas[] = {0, 45, 60, 75, 85};

struct Quality {
    double variance, lost;
};

/// Var(f cosθl / pdf) / E² by quadrature, ∫ (f cosθl)²/pdf dωl / (∫ f cosθl dωl)² − 1, and the lost share of 65,536
/// uniform samples.
Quality quality(const Evaluate& brdf, const Proposal& proposal, double theta) {
    const Vec3f wv = to_float(spherical(theta, 0.3));
    const Quadrature points = MirrorMixture(k_pi / 2).quadrature(to_double(wv), 1 << 17);
    std::vector<Rgb> f(points.w.size());
    brdf(points.w, std::vector<Vec3f>(f.size(), wv), f);
    double whole = 0, squared = 0;
    for (std::size_t i = 0; i < f.size(); ++i) {
        const double g = is_finite(f[i]) ? luminance(f[i]) * double(points.w[i].z) : 0;
        if (!(g > 0)) continue;
        whole += points.weight[i] * g;
        squared += points.weight[i] * g * g / double(pdf(proposal, points.w[i], wv));
    }
    int lost = 0;
    constexpr int draws = 1 << 16;
    std::mt19937_64 random(1);
    for (int i = 0; i < draws; ++i) {
        const double u1 = uniform(random), u2 = uniform(random), u3 = uniform(random);
        lost += !(sample(proposal, wv, {float(u1), float(u2)}, float(u3)).z > 0);
    }
    return {squared / (whole * whole) - 1, double(lost) / draws};
}

Result<Done> print_rows(const std::string& path) {
    const auto measured = load_measured(path);
    if (!measured) return measured.error();
    const auto observations = observe(signed_evaluator(*measured), {});
    if (!observations) return observations.error();
    const auto pm = fit_pm(*observations, FitOptions{});
    if (!pm) return pm.error();
    const auto matrix = tabulate(signed_evaluator(*measured));
    if (!matrix) return matrix.error();
    const auto su = fit_su(*matrix, {.lobes = 5});
    if (!su) return su.error();

    const Evaluate of_pm = evaluator(pm->model), of_su = evaluator(su->model), of_table = evaluator(*measured);
    const Proposal by_pm = propose(of_pm), by_su = propose(su->model), by_table = propose(of_table), cosine;
    const std::pair<const Evaluate&, const Proposal&> columns[] = {
        {of_pm, by_pm}, {of_su, by_su}, {of_table, by_table}, {of_table, by_pm}, {of_table, cosine}};
    for (const double theta : k_thetas) {
        fmt::print("| {} | {}° |", std::filesystem::path(path).stem().string(), theta);
        for (const auto& [brdf, proposal] : columns) {
            const Quality q = quality(brdf, proposal, theta * k_degree);
            fmt::print(" {:.{}f}, {:.1f} % |", q.variance,
                       q.variance < 0.1  ? 4
                       : q.variance < 10 ? 2
                                         : 0,
                       100 * q.lost);
        }
        fmt::print("\n");
    }
    return Done{};
}

}  // namespace
}  // namespace srbf

int main(int argc, char** argv) {
    fmt::print(
        "| measurement | θv | multivariate | view by view | table, its own | table, its model's | table, cosine |\n");
    fmt::print("|---|---|---|---|---|---|---|\n");
    for (int i = 1; i < argc; ++i)
        if (const auto printed = srbf::print_rows(argv[i]); !printed) {
            fmt::print(stderr, "{}\n", srbf::message(printed.error()));
            return 1;
        }
    return 0;
}
