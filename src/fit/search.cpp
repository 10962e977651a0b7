#include "fit/search.h"

#include <algorithm>
#include <cmath>

#include "least_squares.h"
#include "srbf/directions.h"

namespace srbf {
namespace {

// The search looks at the first 4096 rows, the polish at 16384.
constexpr std::size_t k_search_blocks = 4096 / k_block, k_polish_blocks = 16384 / k_block;
constexpr int k_candidates = 256;

/// The parameterizations to start from: half-way vector, light, view (Tsai 2009), the half-way vector once more, since a peak
/// sharper than a half's largest bandwidth takes two, further ones at random.
Lobes without_lobes(PmForm form, int variates, std::mt19937_64& random) {
    Lobes lobes{form, variates, {k_pi / 4, 0, k_pi / 2, k_pi / 4}, {}};
    lobes.angle.resize(std::size_t(variates));
    for (std::size_t n = 4; n < lobes.angle.size(); ++n) lobes.angle[n] = k_pi * uniform(random);
    return lobes;
}

/// A lobe drawn at random: weights of either sign, even in the logarithm, some of them 0; or one of `lobes`
/// disturbed.
std::vector<double> random_lobe(std::mt19937_64& random, const Lobes& lobes) {
    std::vector<double> weight(std::size_t(lobes.width()), 0.0);
    const auto clamped = [&](double w, std::size_t n) {
        const Interval range = weight_range(int(n), lobes.variates);
        return std::clamp(w, range.least, range.most);
    };
    if (lobes.count() > 0 && uniform(random) < 0.25) {
        const auto parent = lobes.of(int(uniform(random) * lobes.count()));
        for (std::size_t n = 0; n < weight.size(); ++n)
            weight[n] = clamped(parent[n] * std::exp(2 * uniform(random) - 1) + 4 * (uniform(random) - 0.5), n);
        return weight;
    }
    for (std::size_t n = 0; n < weight.size(); ++n) {
        const double chance = uniform(random), size = uniform(random), sign = uniform(random);
        const bool sharp =
            int(n) < lobes.variates || int(n) == lobes.variates + 3;  // bandwidths, and what sinθh is multiplied by
        if (sharp) {
            if (chance < 0.35) continue;
            weight[n] = 0.3 * std::pow(2e5, size);
            if (sign < 0.3) weight[n] = -std::min(weight[n], 100.0);
        } else if (chance < 0.5) {
            weight[n] = clamped(0.1 * std::pow(100, size) * (sign < 0.5 ? -1 : 1), n);
        }
    }
    return weight;
}

/// Adds the best of many random lobes to those of the problem's last call of `loss`.
void add_lobe(LobeProblem& problem, Lobes& lobes, std::mt19937_64& random) {
    std::vector<std::vector<double>> candidates;
    for (int i = 0; i < k_candidates; ++i) candidates.push_back(random_lobe(random, lobes));
    const std::vector<double> best = problem.best_addition(candidates);
    if (best.empty())
        lobes.weight.insert(lobes.weight.end(), std::size_t(lobes.width()), 0.0);
    else
        lobes.weight.insert(lobes.weight.end(), best.begin(), best.end());
}

std::mt19937_64 generator(std::uint64_t seed, int start, int stage) {
    std::seed_seq seeds{std::uint32_t(seed), std::uint32_t(seed >> 32), std::uint32_t(start), std::uint32_t(stage)};
    return std::mt19937_64(seeds);
}

double optimise(LobeProblem& problem, Lobes& lobes, int iterations) {
    LevenbergMarquardtOptions options;
    options.max_iterations = iterations;
    Eigen::VectorXd x = LobeProblem::pack(lobes);
    const auto summary = levenberg_marquardt(problem, x, options);
    lobes = problem.unpack(x);
    return summary.loss;
}

/// Drops the lobe that costs least and adds another, after the problem's call of `loss` for `best`; keeps what is better.
void replace_least(LobeProblem& problem, Candidate& best, std::mt19937_64& random) {
    const std::vector<double> cost = problem.cost_of_dropping();
    const auto least = std::min_element(cost.begin(), cost.end()) - cost.begin();
    Candidate next = best;
    const auto at = next.lobes.weight.begin() + least * best.lobes.width();
    next.lobes.weight.erase(at, at + best.lobes.width());
    problem.loss(LobeProblem::pack(next.lobes));
    add_lobe(problem, next.lobes, random);
    next.loss = optimise(problem, next.lobes, 12);
    if (next.loss < best.loss) best = std::move(next);
}

}  // namespace

Candidate grow(const Rows& rows, const FitOptions& options, double log_peak_limit, int start, Reporter& reporter) {
    std::mt19937_64 random = generator(options.seed, start, 0);
    LobeProblem problem(rows, k_search_blocks, options.form, options.variates, false, log_peak_limit);
    Candidate best{start, without_lobes(options.form, options.variates, random)};
    for (int j = 0; j < options.lobes; ++j) {
        problem.loss(LobeProblem::pack(best.lobes));
        add_lobe(problem, best.lobes, random);
        best.loss = optimise(problem, best.lobes, j + 1 < options.lobes ? 6 : 40);
        if (!reporter.advance("growing lobes", 1)) break;
    }
    return best;
}

void improve(const Rows& rows, const FitOptions& options, double log_peak_limit, Candidate& best, Reporter& reporter) {
    std::mt19937_64 random = generator(options.seed, best.start, 1);
    LobeProblem problem(rows, k_search_blocks, options.form, options.variates, false, log_peak_limit);
    for (int kick = 0; kick < options.kicks; ++kick) {
        problem.loss(LobeProblem::pack(best.lobes));
        replace_least(problem, best, random);
        if (!reporter.advance("replacing lobes", 1)) break;
    }
}

void polish(const Rows& rows, const FitOptions& options, double log_peak_limit, Candidate& candidate) {
    std::mt19937_64 random = generator(options.seed, candidate.start, 2);
    LobeProblem problem(rows, k_polish_blocks, options.form, options.variates, false, log_peak_limit);
    candidate.loss = optimise(problem, candidate.lobes, 25);
    // On more rows than it was found on, a lobe may turn out to be good for nothing.
    for (int attempt = 0; attempt < 3; ++attempt) {
        const std::vector<double> cost = problem.cost_of_dropping();
        if (*std::min_element(cost.begin(), cost.end()) > 1e-4 * candidate.loss) break;
        replace_least(problem, candidate, random);
        problem.loss(LobeProblem::pack(candidate.lobes));
    }
}

}  // namespace srbf
