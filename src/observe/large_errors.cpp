#include "observe/large_errors.h"

#include <algorithm>

#include "observe/pair_weights.h"
#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {
namespace {

/// For an objective whose weights hold for small errors: the factor that turns the weighted square into the actual
/// error, Σ_c (g(f_c) − g(f̂_c))² / Σ_c (f_c−f̂_c)² over the square of g's slope. It is clamped to [1 / most,
/// most]. 1 for the other objectives.
double large_error_weight(Objective objective, const Rgb& f, const Rgb& fitted, double typical, double cos_l,
                          double most) {
    const ObjectiveTraits& row = traits(objective);
    if (!row.response) return 1;
    double squares_of_response = 0;
    for (int c = 0; c < 3; ++c)
        squares_of_response += elementary::square(row.response(double(f[c]), typical, cos_l) -
                                                  row.response(double(fitted[c]), typical, cos_l));
    const double squares = squared_distance(f, fitted);
    const double small = elementary::square(row.response_slope(mean_of(f), typical, cos_l));
    return squares > 0 ? std::clamp(squares_of_response / squares / small, 1 / most, most) : 1;
}

}  // namespace

void weigh_large_errors(Observations& observations, const Evaluate& fitted, double most, float least_cos) {
    if (!traits(observations.objective).response) return;
    std::vector<Rgb> f(observations.fitted_count());
    fitted(std::span(observations.wl).first(f.size()), std::span(observations.wv).first(f.size()), f);
    for (std::size_t i = 0; i < f.size(); ++i)
        if (std::min(observations.wl[i].z, observations.wv[i].z) >= least_cos)
            observations.weight[i] *= large_error_weight(observations.objective, observations.f[i], f[i],
                                                         observations.typical, double(observations.wl[i].z), most);
}

}  // namespace srbf
