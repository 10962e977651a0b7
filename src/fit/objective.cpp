#include "fit/objective.h"

#include <algorithm>
#include <array>
#include <vector>

namespace srbf {
namespace {

constexpr ObjectiveTraits k_traits[] = {
    {Objective::raw, "raw", &Measures::squared_error_ratio, 80, [](double, double, double, double) { return 1.0; },
     false},
    {Objective::cosine, "cosine", &Measures::squared_error_ratio_cosine, 89,
     [](double, double, double cos_l, double cos_v) { return cos_l * cos_l * cos_v; }, false},
    {Objective::log, "log", &Measures::log_rms_cosine, 89,
     [](double f, double, double cos_l, double cos_v) { return std::pow(cos_l / (1 + f * cos_l), 2) * cos_v; }, false},
    {Objective::cube_root, "cube-root", &Measures::cube_root_error_ratio, 80,
     [](double f, double mean, double, double) { return std::pow(std::max(f, 0.01 * mean) / mean, -4.0 / 3); }, true},
};
constexpr auto k_objectives = [] {
    std::array<Objective, std::size(k_traits)> all{};
    std::ranges::transform(k_traits, all.begin(), &ObjectiveTraits::objective);
    return all;
}();

}  // namespace

const ObjectiveTraits& traits(Objective objective) {
    return *std::ranges::find(k_traits, objective, &ObjectiveTraits::objective);
}

std::span<const Objective> objectives() { return k_objectives; }
std::string_view name(Objective objective) { return traits(objective).name; }
double Measures::*measure_of(Objective objective) { return traits(objective).measure; }
double default_max_theta(Objective objective) { return traits(objective).max_theta * k_degree; }

std::optional<Objective> objective_named(std::string_view text) {
    const auto found = std::ranges::find(k_traits, text, &ObjectiveTraits::name);
    return found == std::end(k_traits) ? std::nullopt : std::optional(found->objective);
}

bool is_root(Objective objective) {
    return !std::ranges::find(k_measures, measure_of(objective), &MeasureName::member)->is_ratio;
}

void weigh(Objective objective, double mean, std::span<const Vec3f> wl, std::span<const Vec3f> wv,
           std::span<const Rgb> f, std::span<double> weight) {
    const auto asks_for = [&](Objective of, std::size_t i) {
        return traits(of).weight(mean_of(f[i]), mean, double(wl[i].z), double(wv[i].z));
    };
    std::vector<double> of_body;
    if (objective == Objective::cosine)
        for (std::size_t i = 0; i < f.size(); ++i)
            of_body.push_back(weight[i] * double(wl[i].z) * double(wv[i].z) * asks_for(Objective::cube_root, i));
    for (std::size_t i = 0; i < f.size(); ++i) weight[i] *= asks_for(objective, i);
    if (of_body.empty()) return;
    const double body_energy = energy_of(f, of_body);
    if (!(body_energy > 0)) return;
    const double factor = k_body_importance * energy_of(f, weight) / body_energy;
    for (std::size_t i = 0; i < f.size(); ++i) weight[i] += factor * of_body[i];
}

}  // namespace srbf
