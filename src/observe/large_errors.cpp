#include "observe/large_errors.h"

#include <algorithm>

#include "observe/pair_weights.h"
#include "srbf/elementary.h"

namespace srbf {
namespace {

/// For an objective whose weights hold for small errors, and a fitted value `fitted`: the factor that makes the
/// weighted square the actual error, Σ_c (g(f_c) − g(f̂_c))² / Σ_c (f_c−f̂_c)² over the square of g's slope; clamped to
/// a factor of `most`. 1 for the other objectives.
double large_error_weight(Objective objective, const Rgb& f, const Rgb& fitted, double typical, double cos_l,
                          double most) {
    const ObjectiveTraits& of = traits(objective);
    if (!of.seen) return 1;
    double seen = 0;
    for (int c = 0; c < 3; ++c)
        seen += elementary::square(of.seen(double(f[c]), typical, cos_l) - of.seen(double(fitted[c]), typical, cos_l));
    const double squares = squared_distance(f, fitted);
    const double small = elementary::square(of.slope(mean_of(f), typical, cos_l));
    return squares > 0 ? std::clamp(seen / squares / small, 1 / most, most) : 1;
}

}  // namespace

void weigh_large_errors(Observations& observations, const Evaluate& fitted, double most, float least_cos) {
    if (!traits(observations.objective).seen) return;
    std::vector<Rgb> f(observations.fitted());
    fitted(std::span(observations.wl).first(f.size()), std::span(observations.wv).first(f.size()), f);
    for (std::size_t i = 0; i < f.size(); ++i)
        if (std::min(observations.wl[i].z, observations.wv[i].z) >= least_cos)
            observations.weight[i] *= large_error_weight(observations.objective, observations.f[i], f[i],
                                                         observations.typical, double(observations.wl[i].z), most);
}

}  // namespace srbf
