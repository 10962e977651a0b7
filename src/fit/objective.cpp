#include "fit/objective.h"

#include <vector>

namespace srbf {

void weigh(Objective objective, double mean, std::span<const Vec3f> wl, std::span<const Vec3f> wv,
           std::span<const Rgb> f, std::span<double> weight) {
    const auto asks_for = [&](Objective of, std::size_t i) {
        return objective_weight(of, mean_of(f[i]), mean, double(wl[i].z), double(wv[i].z));
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
