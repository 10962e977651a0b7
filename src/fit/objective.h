// What an observation weighs.
#pragma once
#include <algorithm>
#include <cmath>

#include "srbf/fit.h"

namespace srbf {

/// What (f−f̂)² weighs in the objective where the channels of f have mean `f`, per solid angle of both directions; `mean` is
/// that of all f, which only the cube root asks for.
inline double objective_weight(Objective objective, double f, double mean, double cos_l, double cos_v) {
    switch (objective) {
        case Objective::raw:
            return 1;
        case Objective::cosine:
            return cos_l * cos_l * cos_v;
        case Objective::log:
            return std::pow(cos_l / (1 + f * cos_l), 2) * cos_v;
        case Objective::cube_root:
            return std::pow(std::max(f, 0.01 * mean) / mean, -4.0 / 3);
    }
    return 0;
}

inline double square_of(const Rgb& f) { return double(f.r) * f.r + double(f.g) * f.g + double(f.b) * f.b; }
inline double mean_of(const Rgb& f) { return (double(f.r) + double(f.g) + double(f.b)) / 3; }

/// Σ over the guards, the observations beyond θmax, relative to Σ w |f|², if the fit were off by the largest measured
/// f cosθl cosθv at each of them.
inline constexpr double k_guard_importance = 1e-2;

}  // namespace srbf
