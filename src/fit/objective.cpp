#include "fit/objective.h"

#include <vector>

namespace srbf {

void weigh(Objective objective, double mean, std::span<const Vec3f> wl, std::span<const Vec3f> wv,
           std::span<const Rgb> f, std::span<double> weight) {
    std::vector<double> of_body(f.size(), 0.0);
    double energy = 0, body_energy = 0;
    for (std::size_t i = 0; i < f.size(); ++i) {
        const double cos_l = double(wl[i].z), cos_v = double(wv[i].z), squares = square_of(f[i]);
        if (objective == Objective::cosine)
            of_body[i] =
                weight[i] * cos_l * cos_v * objective_weight(Objective::cube_root, mean_of(f[i]), mean, cos_l, cos_v);
        weight[i] *= objective_weight(objective, mean_of(f[i]), mean, cos_l, cos_v);
        energy += weight[i] * squares, body_energy += of_body[i] * squares;
    }
    if (!(body_energy > 0)) return;
    for (std::size_t i = 0; i < f.size(); ++i) weight[i] += k_body_importance * energy / body_energy * of_body[i];
}

}  // namespace srbf
