// Quality of importance sampling: the relative variance of f cosθl / pdf (luminance) and the fraction of lost samples,
// for the multivariate and the view-by-view model with their own proposals, and for the measurement with its own
// proposal, that of its multivariate model, and the cosine. Multivariate fits are of form extended with 8 lobes, the
// view-by-view one has 5 lobes.
//   usage: sampling FILE...
// It prints the median and the largest variance over views every 3° to 85° of prepared measurements and models, and the
// largest fraction of lost samples to 89.9°, as CSV in descending order of the largest variance.
//   usage: sampling --views FILE...
// With --horizon it also prints the largest weight of a sample, at 121 views uniform in √cosθv, from the normal to
// cosθv = 10⁻⁴. The limit for 95 % of views is printed twice: of these views, a third of which are beyond 84°, and of
// views uniform in solid angle, that is in cosθv:
//   usage: sampling --horizon FILE...
// The mean variance over 16 azimuths of the view, prepared without and with azimuths, for anisotropic files:
//   usage: sampling --azimuths FILE...
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "base/weighted_quantile.h"
#include "brdf/directions.h"
#include "models/pm/search/fit_pm.h"
#include "models/su/fit_su.h"
#include "srbf/load.h"
#include "srbf/measured.h"
#include "srbf/prepared.h"

namespace srbf {
namespace {

constexpr double k_thetas[] = {0, 45, 60, 75, 85};

struct Quality {
    double variance, lost;
};

/// The lost fraction of `draws` uniform samples.
double lost(const Proposal& proposal, Vec3f wv, int draws) {
    int count = 0;
    std::mt19937_64 random(1);
    for (int i = 0; i < draws; ++i) {
        const double u1 = uniform(random), u2 = uniform(random), u3 = uniform(random);
        count += !(sample(proposal, wv, {float(u1), float(u2)}, float(u3)).z > 0);
    }
    return double(count) / draws;
}

/// Var(f cosθl / pdf) / E² = ∫ (f cosθl)²/pdf dωl / (∫ f cosθl dωl)² − 1 by quadrature with `count` points.
double variance(const Evaluate& brdf, const Proposal& proposal, Vec3f wv, int count) {
    const Quadrature points = MirrorMixture(k_pi / 2).quadrature(to_double(wv), count);
    std::vector<Rgb> f(points.w.size());
    brdf(points.w, std::vector<Vec3f>(f.size(), wv), f);
    double sum = 0, squares = 0;
    for (std::size_t i = 0; i < f.size(); ++i) {
        const double g = is_finite(f[i]) ? luminance(f[i]) * double(points.w[i].z) : 0;
        if (!(g > 0)) continue;
        sum += points.weight[i] * g;
        squares += points.weight[i] * g * g / double(pdf(proposal, points.w[i], wv));
    }
    return squares / (sum * sum) - 1;
}

Quality quality(const Evaluate& brdf, const Proposal& proposal, double theta) {
    const Vec3f wv = to_float(spherical(theta, 0.3));
    return {variance(brdf, proposal, wv, 1 << 17), lost(proposal, wv, 1 << 16)};
}

Result<Done> print_rows(const std::string& path) {
    const auto measured = load_measured(path);
    if (!measured) return measured.error();
    const auto observations = observe(signed_evaluator(*measured), {});
    if (!observations) return observations.error();
    const auto pm = fit_pm(*observations, PmFitOptions{});
    if (!pm) return pm.error();
    const auto matrix = tabulate(signed_evaluator(*measured));
    if (!matrix) return matrix.error();
    const auto su = fit_su(*matrix, {.lobes = 5});
    if (!su) return su.error();

    const Evaluate f_pm = evaluator(pm->model), f_su = evaluator(su->model), f_table = evaluator(*measured);
    const Proposal pm_proposal = propose(f_pm), su_proposal = propose(su->model), cosine,
                   table_proposal = propose(f_table);
    const std::pair<const Evaluate&, const Proposal&> columns[] = {
        {f_pm, pm_proposal}, {f_su, su_proposal}, {f_table, table_proposal}, {f_table, pm_proposal}, {f_table, cosine}};
    for (const double theta : k_thetas) {
        fmt::print("| {} | {}° |", std::filesystem::path(path).stem().string(), theta);
        for (const auto& [brdf, proposal] : columns) {
            const Quality q = quality(brdf, proposal, theta * k_degree);
            const int decimals = q.variance < 10 ? 2 : 0;
            fmt::print(" {:.{}f}, {:.1f} % |", q.variance, q.variance < 0.1 ? 4 : decimals, 100 * q.lost);
        }
        fmt::print("\n");
    }
    return Done{};
}

/// The largest number over views, and the angle of its view [degrees].
struct Maximum {
    double value = 0, theta = 0;
    void include(const Maximum& other) {
        if (other.value > value) *this = other;
    }
};
/// The quality over the views of a file.
struct ViewQuality {
    std::string file;
    bool is_measured = false;
    double median = 0;
    Maximum variance = {}, lost = {};
    std::vector<double> variances = {};  ///< at views to 85°, in ascending order
    std::vector<double> grazing = {};    ///< variances at 87° and 89.4°
};

Result<ViewQuality> view_quality(const std::string& path) {
    const auto loaded = load_brdf(path);
    if (!loaded) return loaded.error();
    const PreparedBrdf brdf = std::visit([](const auto& kind) { return prepare(kind, ProposeOptions{}); }, *loaded);
    ViewQuality quality{std::filesystem::path(path).stem().string(), std::holds_alternative<Measured>(*loaded)};
    std::vector<double> variances;
    for (double theta = 0; theta < 90; theta += theta < 84 ? 3 : 0.7) {
        const Vec3f wv = to_float(spherical(theta * k_degree, 0.3));
        quality.lost.include({lost(proposal(brdf), wv, 1 << 14), theta});
        if (theta > 85) continue;
        variances.push_back(variance(evaluator(brdf), proposal(brdf), wv, 1 << 15));
        quality.variance.include({variances.back(), theta});
    }
    for (const double theta : {87.0, 89.4})
        quality.grazing.push_back(
            variance(evaluator(brdf), proposal(brdf), to_float(spherical(theta * k_degree, 0.3)), 1 << 15));
    std::ranges::sort(variances);
    quality.median = variances[variances.size() / 2];
    quality.variances = std::move(variances);
    return quality;
}

void print_views(std::span<const ViewQuality> all, const char* which, std::vector<double> ViewQuality::*variances) {
    std::vector<double> views;
    for (const ViewQuality& file : all) views.insert(views.end(), (file.*variances).begin(), (file.*variances).end());
    std::ranges::sort(views);
    if (!views.empty())
        fmt::print(stderr, "{} views {}: median {:.4f}, 95 % {:.4f}, largest {:.4f}\n", views.size(), which,
                   views[views.size() / 2], views[views.size() * 95 / 100], views.back());
}

Result<Done> print_worst(std::span<char*> paths) {
    std::vector<ViewQuality> all;
    for (const char* path : paths) {
        const auto quality = view_quality(path);
        if (!quality) return quality.error();
        all.push_back(*quality);
    }
    std::stable_sort(all.begin(), all.end(),
                     [](const auto& a, const auto& b) { return a.variance.value > b.variance.value; });
    fmt::print("file,of,median variance,largest variance,at [degrees],most lost,lost at [degrees]\n");
    for (const ViewQuality& quality : all)
        fmt::print("{},{},{:.4f},{:.4f},{:.1f},{:.4f},{:.1f}\n", quality.file,
                   quality.is_measured ? "measurement" : "fit", quality.median, quality.variance.value,
                   quality.variance.theta, quality.lost.value, quality.lost.theta);
    print_views(all, "to 85 degrees", &ViewQuality::variances);
    print_views(all, "at 87 and 89.4 degrees", &ViewQuality::grazing);
    return Done{};
}

/// Variance and largest weight by 20,000 samples a view.
Result<Done> print_horizon(std::span<char*> paths) {
    constexpr int k_views = 121, k_samples = 20'000;
    fmt::print("file,median variance,95 %,95 % of solid angle,largest variance,at cosine,largest weight,at cosine\n");
    for (const char* path : paths) {
        const auto loaded = load_brdf(path);
        if (!loaded) return loaded.error();
        const PreparedBrdf brdf = std::visit([](const auto& kind) { return prepare(kind, ProposeOptions{}); }, *loaded);
        std::vector<std::pair<double, double>> variances, weights;  // and the cosine of the view
        std::vector<std::pair<double, double>> by_solid_angle;      // variances, and d cosθv
        for (int i = 0; i < k_views; ++i) {
            const double cosine = std::max(elementary::square(1 - double(i) / (k_views - 1)), 1e-4);
            const Vec3f wv = to_float(spherical(std::acos(cosine), 0.3));
            std::mt19937_64 random(1);
            double sum = 0, squares = 0, largest = 0;
            for (int k = 0; k < k_samples; ++k) {
                const double u1 = uniform(random), u2 = uniform(random), u3 = uniform(random);
                const double weight = luminance(sample(brdf, wv, {float(u1), float(u2)}, float(u3)).weight);
                sum += weight;
                squares += weight * weight;
                largest = std::max(largest, weight);
            }
            variances.emplace_back(k_samples * squares / (sum * sum) - 1, cosine);
            by_solid_angle.emplace_back(variances.back().first, std::sqrt(cosine));
            weights.emplace_back(largest, cosine);
        }
        std::ranges::sort(variances);
        const auto [weight, cosine_of_weight] = std::ranges::max(weights);
        fmt::print("{},{:.4f},{:.4f},{:.4f},{:.4f},{:.5f},{:.2f},{:.5f}\n", std::filesystem::path(path).stem().string(),
                   variances[k_views / 2].first, variances[k_views * 95 / 100].first,
                   weighted_quantile(by_solid_angle, 0.95), variances.back().first, variances.back().second, weight,
                   cosine_of_weight);
    }
    return Done{};
}

Result<Done> print_azimuths(std::span<char*> paths) {
    constexpr int k_azimuths = 16;
    fmt::print("file,azimuths");
    for (const double theta : k_thetas) fmt::print(",{}°", theta);
    fmt::print("\n");
    for (const char* path : paths) {
        const auto loaded = load_brdf(path);
        if (!loaded) return loaded.error();
        for (const int azimuths : {1, k_anisotropic_azimuths}) {
            const PreparedBrdf brdf =
                std::visit([&](const auto& kind) { return prepare(kind, {.azimuths = azimuths}); }, *loaded);
            fmt::print("{},{}", std::filesystem::path(path).stem().string(), azimuths);
            for (const double theta : k_thetas) {
                double sum = 0;
                for (int i = 0; i < k_azimuths; ++i) {
                    const Vec3f wv = to_float(spherical(theta * k_degree, 2 * k_pi * (i + 0.5) / k_azimuths));
                    sum += variance(evaluator(brdf), proposal(brdf), wv, 1 << 15);
                }
                fmt::print(",{:.3f}", sum / k_azimuths);
            }
            fmt::print("\n");
        }
    }
    return Done{};
}

}  // namespace
}  // namespace srbf

int main(int argc, char** argv) {
    const std::string mode = argc > 1 ? argv[1] : "";
    if (mode == "--views" || mode == "--horizon" || mode == "--azimuths") {
        const std::span files(argv + 2, std::size_t(argc - 2));
        const auto printed = mode == "--views"     ? srbf::print_worst(files)
                             : mode == "--horizon" ? srbf::print_horizon(files)
                                                   : srbf::print_azimuths(files);
        if (!printed) fmt::print(stderr, "{}\n", srbf::message(printed.error()));
        return printed ? 0 : 1;
    }
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
