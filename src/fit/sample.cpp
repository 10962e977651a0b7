#include "fit/sample.h"

#include <algorithm>
#include <set>

#include "fit/excess.h"
#include "fit/rounding.h"
#include "parallel.h"

namespace srbf {
namespace {

/// Pairs that the search looks at, and the polish.
constexpr std::size_t k_few = 4096, k_more = 16384;
/// Of each candidate no more than so many places are taken in where it exceeds the measurement.
constexpr std::size_t k_most_places = 16;

/// Every albedo off by 10 % costs as much as the fit's loss without regard to albedo, but no more than 0.004: a fit that cannot
/// follow the data gains nothing from an albedo that is right by chance.
constexpr double k_albedo_error = 0.1, k_most_albedo_loss = 0.004;

Observations colours_of(const Observations& observations, std::size_t count) {
    Observations some = beginning(observations, count);
    some.wavelengths.clear(), some.spectrum.clear();
    some.albedo = observations.albedo;
    return some;
}

/// At most so many of them, evenly.
std::vector<std::size_t> some_of(const std::vector<std::size_t>& all, std::size_t most) {
    if (all.size() <= most) return all;
    std::vector<std::size_t> some;
    for (std::size_t k = 0; k < most; ++k) some.push_back(all[k * all.size() / most]);
    return some;
}

}  // namespace

Sample::Sample(const Observations& observations)
    : all_(observations),
      few_(colours_of(observations, k_few)),
      more_(colours_of(observations, k_more)),
      largest_(largest_measured(observations)) {
    begin_few_ = few_.f.size(), begin_more_ = more_.f.size();
}

void Sample::look_about(const std::vector<Candidate>& candidates, const FitOptions& options, double log_peak_limit) {
    const Rows few(few_), more(more_);
    std::vector<std::vector<std::size_t>> places(candidates.size());
    std::vector<double> loss(candidates.size());
    parallel_for(candidates.size(), [&](std::size_t i) {
        const Lobes& lobes = candidates[i].lobes;
        LobeProblem seen(few, shape_of(options), false, log_peak_limit),
            unseen(more, shape_of(options), false, log_peak_limit);
        seen.loss(LobeProblem::pack(lobes));
        places[i] =
            some_of(exceeded(all_, begin_few_, to_model(seen, lobes, options.log_scale, {}), largest_), k_most_places);
        loss[i] = unseen.loss(LobeProblem::pack(lobes));
    });
    loss_ = *std::min_element(loss.begin(), loss.end());

    std::set<std::size_t> taken;
    for (const auto& of_candidate : places) taken.insert(of_candidate.begin(), of_candidate.end());
    const std::size_t checks = all_.f.size() - all_.checks;
    for (const std::size_t i : taken) {
        const auto append = [&](Observations& to) {
            to.wl.push_back(all_.wl[i]), to.wv.push_back(all_.wv[i]), to.f.push_back(all_.f[i]);
            to.weight.push_back(i < checks ? all_.weight[i] : check_weight(all_, i, loss_, largest_));
        };
        append(few_);
        if (i >= begin_more_) append(more_);
    }
}

double Sample::albedo_importance() const {
    return std::min(loss_, k_most_albedo_loss) / (3 * k_albedo_error * k_albedo_error);
}

}  // namespace srbf
