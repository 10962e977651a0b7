#include "observe/pair_weights.h"

#include "base/parallel.h"
#include "base/weighted_quantile.h"

namespace SRBF_NAMESPACE {

namespace {

#define SRBF_FN inline
#include "observe/appearance_weights.inl"
#undef SRBF_FN

/// The least fitted value that `relative` distinguishes from 0, as a fraction of the mean.
constexpr double k_darkest = 1e-9;

/// The weights of cube roots are constant below this fraction of the mean.
constexpr double k_min_rooted = 0.01;
double cube_root_weight(double f, double mean, double, double) {
    return elementary::pow(std::max(f, k_min_rooted * mean) / mean, -4.0 / 3);
}
double diffuse_weight(double f, double mean, double cos_l, double cos_v) {
    return cos_l * cos_v * cube_root_weight(f, mean, cos_l, cos_v);
}
double cube_root_slope(double f, double mean, double) {
    return elementary::pow(std::max(f, k_min_rooted * mean), -2.0 / 3) / 3;
}
/// f cosθl as a display shows it.
double displayed(double f, double bright, double cos_l) {
    return elementary::pow(above_dark(f, bright, cos_l), 1.0 / 6);
}

constexpr ObjectiveTraits k_traits[] = {
    {.objective = Objective::raw,
     .name = "raw",
     .summary = "squared error of f",
     .measure = &Measures::squared_error_ratio,
     .max_theta = 80,
     .weight = [](double, double, double, double) { return 1.0; }},
    {.objective = Objective::cosine,
     .name = "cosine",
     .summary = "squared error of f cos(theta_l), weighted by cos(theta_v)",
     .measure = &Measures::squared_error_ratio_cosine,
     .max_theta = 89,
     .weight = cosine_weight<double>,
     .further = {{{diffuse_weight, k_diffuse_base}}}},
    {.objective = Objective::log,
     .name = "log",
     .summary = "squared error of log(1 + f cos(theta_l)), weighted by cos(theta_v)",
     .measure = &Measures::log_rms_cosine,
     .max_theta = 89,
     .weight = [](double f, double, double cos_l,
                  double cos_v) { return elementary::square(cos_l / (1 + f * cos_l)) * cos_v; }},
    {.objective = Objective::cube_root,
     .name = "cube-root",
     .summary = "squared error of the cube root of f",
     .measure = &Measures::cube_root_error_ratio,
     .max_theta = 80,
     .weight = cube_root_weight,
     .response = [](double f, double, double) { return elementary::cbrt(f); },
     .response_slope = cube_root_slope},
    {.objective = Objective::relative,
     .name = "relative",
     .summary = "squared error of the logarithm of f",
     .measure = &Measures::log10_rms,
     .max_theta = 80,
     .weight = [](double f, double, double, double) { return f > 0 ? elementary::square(1 / f) : 0; },
     .response = [](double f, double mean, double) { return elementary::log(std::max(f, k_darkest * mean)); },
     .response_slope = [](double f, double, double) { return f > 0 ? 1 / f : 0; },
     .is_for_scatter = true},
    {.objective = Objective::appearance,
     .name = "appearance",
     .summary = "visible error of pictures, about the sixth root of f cos(theta_l)",
     .measure = &Measures::sixth_root_error_ratio,
     .max_theta = 89,
     .weight = display_weight<double>,
     .further = {{{highlight_weight<double>, k_highlights}, {cosine_weight<double>, k_peaks}}},
     .response = displayed,
     .response_slope = displayed_slope<double>,
     .uses_pictures = true},
};
constexpr auto k_objectives = [] {
    std::array<Objective, std::size(k_traits)> objectives{};
    std::ranges::transform(k_traits, objectives.begin(), &ObjectiveTraits::objective);
    return objectives;
}();

/// The factor that turns the weighted square into the actual error, Σ_c (g(f_c) − g(f̂_c))² / Σ_c (f_c−f̂_c)² over the
/// square of g's slope, in [1/max, max]; 1 for an objective whose weights hold for errors of any size.
double large_error_weight(Objective objective, const Rgb& f, const Rgb& fitted, double typical, double cos_l,
                          double max) {
    const ObjectiveTraits& row = traits(objective);
    if (!row.response) return 1;
    double squares_of_response = 0;
    for (int c = 0; c < 3; ++c)
        squares_of_response += elementary::square(row.response(double(f[c]), typical, cos_l) -
                                                  row.response(double(fitted[c]), typical, cos_l));
    const double squares = squared_distance(f, fitted);
    const double small = elementary::square(row.response_slope(mean_of(f), typical, cos_l));
    return squares > 0 ? std::clamp(squares_of_response / squares / small, 1 / max, max) : 1;
}

}  // namespace

const ObjectiveTraits& traits(Objective objective) {
    return *std::ranges::find(k_traits, objective, &ObjectiveTraits::objective);
}

std::span<const Objective> objectives() { return k_objectives; }
std::string_view name(Objective objective) { return traits(objective).name; }
std::string_view summary(Objective objective) { return traits(objective).summary; }
double Measures::*measure_of(Objective objective) { return traits(objective).measure; }
double error_of(const Measures& measures, Objective objective) { return measures.*measure_of(objective); }
double default_max_theta(Objective objective) { return traits(objective).max_theta * k_degree; }

std::optional<Objective> objective_named(std::string_view text) {
    const auto row = std::ranges::find(k_traits, text, &ObjectiveTraits::name);
    return row == std::end(k_traits) ? std::nullopt : std::optional(row->objective);
}

double typical_value(Objective objective, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<const Rgb> f,
                     std::span<const double> weight) {
    double sum = 0, total = 0;
    if (!traits(objective).uses_pictures) {
        for (std::size_t i = 0; i < f.size(); ++i) {
            sum += weight[i] * mean_of(f[i]);
            total += weight[i];
        }
        return total > 0 ? sum / total : 0;
    }
    std::vector<std::pair<double, double>> brightness;  // f cosθl and its weight
    for (std::size_t i = 0; i < f.size(); ++i)
        if (mean_of(f[i]) > 0) brightness.emplace_back(mean_of(f[i]) * double(wl[i].z), weight[i] * double(wv[i].z));
    return weighted_quantile(std::move(brightness), k_bright_quantile);
}

void weigh(Objective objective, double typical, std::span<const Vec3f> wl, std::span<const Vec3f> wv,
           std::span<const Rgb> f, std::span<double> weight, int threads) {
    constexpr std::size_t k_chunk_pairs = 4096;
    const ObjectiveTraits& row = traits(objective);
    const std::vector<double> solid_angle(weight.begin(), weight.end());
    const auto fill = [&](auto& weights, const auto& weight_of) {
        parallel_for_chunks(f.size(), k_chunk_pairs, threads, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                weights[i] = solid_angle[i] * weight_of(mean_of(f[i]), typical, double(wl[i].z), double(wv[i].z));
        });
        return energy_of(f, weights);
    };
    const double total = fill(weight, row.weight);
    std::vector<double> further(f.size());
    for (const ObjectiveTraits::FurtherWeight& term : row.further) {
        const double energy = term.weight ? fill(further, term.weight) : 0;
        for (std::size_t i = 0; energy > 0 && i < f.size(); ++i)
            weight[i] += term.importance * total / energy * further[i];
    }
}

void weigh_large_errors(Observations& observations, const Evaluate& fitted, double max, float min_cos) {
    if (!traits(observations.objective).response) return;
    std::vector<Rgb> f(observations.fitted_count());
    fitted(std::span(observations.wl).first(f.size()), std::span(observations.wv).first(f.size()), f);
    for (std::size_t i = 0; i < f.size(); ++i)
        if (std::min(observations.wl[i].z, observations.wv[i].z) >= min_cos)
            observations.weight[i] *= large_error_weight(observations.objective, observations.f[i], f[i],
                                                         observations.typical, double(observations.wl[i].z), max);
}

}  // namespace
