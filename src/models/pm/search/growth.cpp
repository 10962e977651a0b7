#include "models/pm/search/search.h"

#include <algorithm>

#include "base/least_squares.h"
#include "base/levenberg_marquardt.h"
#include "brdf/directions.h"

namespace SRBF_NAMESPACE {
namespace {

/// Numbers of steps: after each grown lobe except the last; after the last one; on new rows; after a perturbation.
constexpr int k_growth_steps = 6, k_grown_steps = 12, k_first_steps = 6, k_perturbation_steps = 12;
constexpr int k_polish_attempts = 3;
/// Number of lobe perturbations per variate perturbation.
constexpr int k_lobe_perturbations = 3;
/// A lobe is useless if its removal would raise the loss by less than this fraction.
constexpr double k_useless = 1e-4;

/// Optimises these lobes in at most `steps` steps, and assigns them to the candidate. Stops early where the loss is
/// unlikely to fall below `target`.
void optimise(LobeProblem& problem, Candidate& candidate, const Lobes& lobes, int steps,
              double target = LevenbergMarquardtOptions{}.target) {
    Eigen::VectorXd x = pack(lobes);
    candidate.loss = levenberg_marquardt(problem, x, {.max_iterations = steps, .target = target}).loss;
    candidate.lobes = unpack(x, lobes.shape);
    candidate.beta = problem.beta(), candidate.gram = problem.gram();
}
/// Optimises these lobes, and assigns them to the candidate if they are better.
void keep_if_better(LobeProblem& problem, Candidate& candidate, const Lobes& lobes) {
    Candidate other = candidate;
    optimise(problem, other, lobes, k_perturbation_steps, candidate.loss);
    if (other.loss < candidate.loss) candidate = std::move(other);
}

/// Adds the best of many random lobes.
Lobes with_best_lobe(LobeProblem& problem, Lobes lobes, const PmFitOptions& options, std::mt19937_64& random) {
    const auto additions = random_candidates(random, lobes, has_short_search(options) ? k_additions / 2 : k_additions);
    problem.loss(pack(lobes));
    return with_lobe(std::move(lobes), problem.best_addition(additions));
}

/// Replaces the least useful lobe, if that lowers the loss.
void replace_lobe(LobeProblem& problem, const PmFitOptions& options, Candidate& candidate, std::mt19937_64& random) {
    const std::vector<double> cost = cost_of_dropping(candidate.gram, candidate.beta);
    Lobes lobes = without_lobe(candidate.lobes, std::ranges::min_element(cost) - cost.begin());
    keep_if_better(problem, candidate, with_best_lobe(problem, std::move(lobes), options, random));
}

/// Replaces the least useful variate: its parameters become 0, its parameterization random. Steps alone rarely rotate
/// a parameterization far, because no lobe fits in between.
void replace_variate(LobeProblem& problem, Candidate& candidate, std::mt19937_64& random) {
    std::vector<Lobes> reduced;
    std::vector<double> loss;
    for (int n = 0; n < candidate.lobes.shape.variates; ++n) {
        reduced.push_back(with_variate_zeroed(candidate.lobes, n));
        loss.push_back(problem.loss(pack(reduced.back())));
    }
    const auto least = std::size_t(std::ranges::min_element(loss) - loss.begin());
    reduced[least].angle[least] = k_pi * uniform(random);
    keep_if_better(problem, candidate, reduced[least]);
}

bool has_useless_lobe(const Candidate& candidate) {
    return std::ranges::min(cost_of_dropping(candidate.gram, candidate.beta)) <= k_useless * candidate.loss;
}

}  // namespace

void grow(LobeProblem& problem, const PmFitOptions& options, Candidate& candidate, Reporter& reporter) {
    std::mt19937_64 random = generator(options.seed, candidate.start, 0);
    if (candidate.lobes.shape.variates == 0)
        candidate.lobes = initial_parameterizations(shape_of(options), candidate.start, random);
    for (int j = candidate.lobes.count(); j < options.lobes; ++j) {
        const Lobes lobes = with_best_lobe(problem, std::move(candidate.lobes), options, random);
        optimise(problem, candidate, lobes, j + 1 < options.lobes ? k_growth_steps : k_grown_steps);
        if (!reporter.advance("growing lobes", 1)) break;
    }
}

void perturb(LobeProblem& problem, const PmFitOptions& options, int until, Candidate& candidate, Reporter& reporter) {
    if (candidate.perturbations >= until || reporter.cancelled()) return;
    optimise(problem, candidate, candidate.lobes, k_first_steps);
    while (candidate.perturbations < until) {
        std::mt19937_64 random = generator(options.seed, candidate.start, 2 + candidate.perturbations++);
        if (candidate.perturbations % (k_lobe_perturbations + 1) == 0)
            replace_variate(problem, candidate, random);
        else
            replace_lobe(problem, options, candidate, random);
        if (!reporter.advance("replacing lobes", 1)) break;
    }
}

void polish(LobeProblem& problem, const PmFitOptions& options, int steps, Candidate& candidate) {
    optimise(problem, candidate, candidate.lobes, steps);
    std::mt19937_64 random = generator(options.seed, candidate.start, 1);
    // A lobe that was found on fewer rows may be useless on these.
    for (int attempt = 0; attempt < k_polish_attempts && has_useless_lobe(candidate); ++attempt)
        replace_lobe(problem, options, candidate, random);
}

}  // namespace
