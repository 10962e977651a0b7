#include "fit/search/search.h"

#include <algorithm>

#include "fit/cuda/device_solver.h"
#include "fit/solve/least_squares.h"
#include "srbf/directions.h"

namespace srbf {
namespace {

/// Steps after each lobe that is grown but the last, after the last, on other rows, after a perturbation, in a polish.
constexpr int k_growth_steps = 6, k_grown_steps = 12, k_first_steps = 6, k_perturbation_steps = 12, k_polish_steps = 25;
constexpr int k_polish_attempts = 3;
/// Number of lobe perturbations per variate perturbation.
constexpr int k_lobe_perturbations = 3;
/// A lobe whose absence would cost less than this share of the loss is useless.
constexpr double k_useless = 1e-4;

using Candidates = std::span<Candidate* const>;
using Generators = std::span<std::mt19937_64>;

Trial trial_of(const Candidate& candidate, int steps = 0) {
    Trial trial;
    trial.rows = candidate.rows, trial.lobes = candidate.lobes, trial.steps = steps;
    return trial;
}
void take(Candidate& candidate, Trial& trial) {
    candidate.lobes = std::move(trial.lobes), candidate.loss = trial.loss;
    candidate.beta = std::move(trial.beta), candidate.gram = std::move(trial.gram);
}

template <Solver S> Result<Done> optimise(S& solver, std::span<Candidate> candidates, int steps) {
    std::vector<Trial> trials;
    for (const Candidate& candidate : candidates) trials.push_back(trial_of(candidate, steps));
    if (const auto done = solver.optimise(trials); !done) return done;
    for (std::size_t i = 0; i < trials.size(); ++i) take(candidates[i], trials[i]);
    return Done{};
}

/// Adds the best of many random lobes to each.
template <Solver S> Result<Done> add_lobes(S& solver, std::span<Trial> trials, Generators random) {
    for (std::size_t i = 0; i < trials.size(); ++i) trials[i].additions = random_candidates(random[i], trials[i].lobes);
    if (const auto done = solver.best_additions(trials); !done) return done;
    for (Trial& trial : trials) {
        trial.lobes = with_lobe(std::move(trial.lobes), trial.addition);
        trial.additions.clear();
    }
    return Done{};
}

/// Optimises the trials and keeps those that are better than the candidates they came from.
template <Solver S> Result<Done> keep_better(S& solver, Candidates candidates, std::span<Trial> trials) {
    for (std::size_t i = 0; i < trials.size(); ++i)
        trials[i].steps = k_perturbation_steps, trials[i].target = candidates[i]->loss;
    if (const auto done = solver.optimise(trials); !done) return done;
    for (std::size_t i = 0; i < trials.size(); ++i)
        if (trials[i].loss < candidates[i]->loss) take(*candidates[i], trials[i]);
    return Done{};
}

/// Drops the least useful lobe of each and adds another.
template <Solver S> Result<Done> replace_lobes(S& solver, Candidates candidates, Generators random) {
    std::vector<Trial> trials;
    for (const Candidate* of : candidates) {
        const std::vector<double> cost = cost_of_dropping(of->gram, of->beta);
        trials.push_back(trial_of(*of));
        trials.back().lobes =
            without_lobe(std::move(trials.back().lobes), std::ranges::min_element(cost) - cost.begin());
    }
    if (const auto added = add_lobes(solver, trials, random); !added) return added;
    return keep_better(solver, candidates, trials);
}

/// The same for the least useful variate: its weights become 0, and its parameterization becomes a random one. Steps
/// alone rarely rotate a parameterization far, since no lobe fits in between.
template <Solver S> Result<Done> replace_variates(S& solver, Candidates candidates, Generators random) {
    std::vector<Trial> without, trials;
    for (const Candidate* of : candidates)
        for (int n = 0; n < of->lobes.shape.variates; ++n) {
            without.push_back(trial_of(*of));
            without.back().lobes = without_variate(std::move(without.back().lobes), n);
        }
    if (const auto done = solver.optimise(without); !done) return done;
    auto of_candidate = std::span(without);
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        const auto variates = of_candidate.first(std::size_t(candidates[i]->lobes.shape.variates));
        const auto least = std::size_t(std::ranges::min_element(variates, {}, &Trial::loss) - variates.begin());
        trials.push_back(trial_of(*candidates[i]));
        trials.back().lobes = std::move(variates[least].lobes);
        trials.back().lobes.angle[least] = k_pi * uniform(random[i]);
        of_candidate = of_candidate.subspan(variates.size());
    }
    return keep_better(solver, candidates, trials);
}

bool has_useless_lobe(const Candidate& candidate) {
    return std::ranges::min(cost_of_dropping(candidate.gram, candidate.beta)) <= k_useless * candidate.loss;
}

}  // namespace

template <Solver S>
Result<Done> grow(S& solver, const FitOptions& options, std::span<Candidate> candidates, Reporter& reporter) {
    std::vector<std::mt19937_64> random;
    for (Candidate& candidate : candidates) {
        random.push_back(generator(options.seed, candidate.start, 0));
        candidate.lobes = without_lobes(shape_of(options), candidate.start, random.back());
    }
    for (int j = 0; j < options.lobes; ++j) {
        std::vector<Trial> trials;
        for (const Candidate& candidate : candidates)
            trials.push_back(trial_of(candidate, j + 1 < options.lobes ? k_growth_steps : k_grown_steps));
        if (const auto added = add_lobes(solver, trials, random); !added) return added;
        if (const auto done = solver.optimise(trials); !done) return done;
        for (std::size_t i = 0; i < trials.size(); ++i) take(candidates[i], trials[i]);
        if (!reporter.advance("growing lobes", double(candidates.size()))) break;
    }
    return Done{};
}

template <Solver S>
Result<Done> perturb(S& solver, const FitOptions& options, int until, std::span<Candidate> candidates,
                     Reporter& reporter) {
    if (candidates.empty() || candidates[0].perturbations >= until || reporter.cancelled()) return Done{};
    if (const auto done = optimise(solver, candidates, k_first_steps); !done) return done;
    std::vector<Candidate*> all;
    for (Candidate& candidate : candidates) all.push_back(&candidate);
    while (candidates[0].perturbations < until) {
        std::vector<std::mt19937_64> random;
        for (Candidate& candidate : candidates)
            random.push_back(generator(options.seed, candidate.start, 2 + candidate.perturbations++));
        const bool of_variates = candidates[0].perturbations % (k_lobe_perturbations + 1) == 0;
        const auto done =
            of_variates ? replace_variates(solver, all, random) : replace_lobes(solver, Candidates(all), random);
        if (!done) return done;
        if (!reporter.advance("replacing lobes", double(candidates.size()))) break;
    }
    return Done{};
}

template <Solver S> Result<Done> polish(S& solver, const FitOptions& options, std::span<Candidate> candidates) {
    if (const auto done = optimise(solver, candidates, k_polish_steps); !done) return done;
    std::vector<std::vector<std::mt19937_64>> random;
    for (const Candidate& candidate : candidates) random.push_back({generator(options.seed, candidate.start, 1)});
    // On more rows than it was found on, a lobe may become useless.
    for (std::size_t i = 0; i < candidates.size(); ++i)
        for (int attempt = 0; attempt < k_polish_attempts && has_useless_lobe(candidates[i]); ++attempt) {
            Candidate* const one = &candidates[i];
            if (const auto done = replace_lobes(solver, Candidates(&one, 1), random[i]); !done) return done;
        }
    return Done{};
}

#define SRBF_INSTANTIATE(S)                                                                     \
    template Result<Done> grow(S&, const FitOptions&, std::span<Candidate>, Reporter&);         \
    template Result<Done> perturb(S&, const FitOptions&, int, std::span<Candidate>, Reporter&); \
    template Result<Done> polish(S&, const FitOptions&, std::span<Candidate>);
SRBF_INSTANTIATE(ProcessorSolver)
SRBF_INSTANTIATE(DeviceSolver)
#undef SRBF_INSTANTIATE

}  // namespace srbf
