#include "models/pm/search/subsets.h"

#include <algorithm>
#include <set>

#include "base/parallel.h"
#include "models/pm/solve/rounding.h"
#include "observe/bound.h"
#include "observe/costs.h"
#include "observe/directional_lights.h"
#include "observe/observations.h"
#include "observe/pair_weights.h"
#include "observe/pairs.h"

namespace srbf {
namespace {

/// Maximum number of exceeded bound pairs that are added for each candidate.
constexpr std::size_t k_most_added = 16;

/// At most this many of them, uniformly spaced.
std::vector<std::size_t> some_of(const std::vector<std::size_t>& all, std::size_t most) {
    if (all.size() <= most) return all;
    std::vector<std::size_t> some;
    for (std::size_t k = 0; k < most; ++k) some.push_back(all[k * all.size() / most]);
    return some;
}

}  // namespace

Subsets::Subsets(const Observations& observations)
    : all_(observations),
      few_(beginning_of_all(observations.f.size() < std::size_t(Pairs::more) ? Pairs::some : Pairs::few)),
      some_(beginning_of_all(Pairs::some)),
      more_(beginning_of_all(Pairs::more)),
      largest_(largest_measured(observations)) {
    some_.observations.views = observations.views;
}

Subsets::Part Subsets::beginning_of_all(Pairs pairs) const {
    Observations some = beginning(all_, std::size_t(pairs));
    some.wavelengths.clear(), some.spectrum.clear();
    some.integrals = all_.integrals;
    const std::size_t begin = some.f.size();
    return {std::move(some), begin};
}

void Subsets::add_exceeded(const std::vector<Candidate>& candidates, const FitOptions& options, double log_peak_limit) {
    const Rows some(some_.observations), more(more_.observations);
    std::vector<std::vector<std::size_t>> added(candidates.size());
    std::vector<double> loss(candidates.size());
    parallel_for(candidates.size(), [&](std::size_t i) {
        const Lobes& lobes = candidates[i].lobes;
        LobeProblem known(some, shape_of(options), false, log_peak_limit),
            further(more, shape_of(options), false, log_peak_limit);
        known.loss(pack(lobes));
        std::vector<std::size_t> where =
            exceeded_pairs(all_, few_.begin, to_model(known, lobes, options.log_scale, {}), largest_);
        // Bounds beyond the grid are for the final model: candidates exceed them often, in place of those that matter more.
        std::erase_if(where, [&](std::size_t k) { return std::min(all_.wl[k].z, all_.wv[k].z) < k_brink_cosine; });
        added[i] = some_of(std::move(where), k_most_added);
        loss[i] = further.loss(pack(lobes));
    });
    loss_ = *std::min_element(loss.begin(), loss.end());

    std::set<std::size_t> taken;
    for (const auto& of_candidate : added) taken.insert(of_candidate.begin(), of_candidate.end());
    const std::size_t fitted = all_.fitted_count();
    for (const std::size_t i : taken) {
        const double weight = i < fitted ? all_.weight[i] : bound_weight(all_, i, loss_, largest_);
        for (Part* part : {&few_, &some_, &more_})
            if (i >= part->begin) part->observations.add(all_.wl[i], all_.wv[i], all_.f[i], weight);
    }
}

void Subsets::add_directional_lights(const Evaluate& fitted) {
    has_directional_lights_ = !some_.observations.directional_light_weight.empty();
    if (has_directional_lights_) srbf::add_directional_lights(some_.observations, fitted);
}

double Subsets::integral_importance(bool beside_directional_lights) const {
    return (beside_directional_lights ? k_albedos_beside_directional_lights : 1) * std::min(loss_, k_most_albedo_loss) /
           (3 * all_.integral_error * all_.integral_error);
}

double Subsets::picture_importance(const Candidate& candidate, const Stage& stage, const FitOptions& options,
                                   double log_peak_limit) const {
    constexpr double k_negligible = 1e-9, k_least_delta_e = 1e-3;
    const Rows seen = rows(stage, k_negligible);
    LobeProblem problem(seen, shape_of(options), true, log_peak_limit);
    problem.loss(pack(candidate.lobes));
    return (has_directional_lights_ ? k_pixels : k_pixels_alone) * loss_ / std::max(problem.delta_e(), k_least_delta_e);
}

Rows Subsets::rows(const Stage& stage, double picture_importance) const {
    const Part& part = stage.pairs == Pairs::few ? few_ : stage.pairs == Pairs::some ? some_ : more_;
    if (!stage.albedos) return Rows(part.observations);
    return Rows(part.observations,
                {.integral_importance = integral_importance(stage.pictures && has_directional_lights_),
                 .subsampled_integrals = stage.pairs != Pairs::more,
                 .picture_importance = stage.pictures ? picture_importance : 0});
}

}  // namespace srbf
