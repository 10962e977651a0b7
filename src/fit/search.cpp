#include "fit/search.h"

#include <algorithm>
#include <cmath>

#include "least_squares.h"
#include "srbf/directions.h"
#include "srbf/elementary.h"

namespace srbf {

Lobes without_lobes(const LobeShape& shape, int start, std::mt19937_64& random) {
    Lobes lobes{shape, {k_pi / 4, 0, k_pi / 2, k_pi / 4}, {}};
    lobes.angle.resize(std::size_t(shape.variates));
    for (std::size_t n = 4; n < lobes.angle.size(); ++n) lobes.angle[n] = k_pi * uniform(random);
    if (start % 2 == 1) {
        if (shape.variates == 3) lobes.angle[2] = k_pi / 4;
        const std::size_t turned = shape.variates == 3 ? 2 : 3;
        for (std::size_t n = 1; n < std::min(lobes.angle.size(), turned); ++n)
            lobes.angle[n] += 2 * uniform(random) - 1;
    }
    return lobes;
}

std::vector<double> random_lobe(std::mt19937_64& random, const Lobes& lobes) {
    const LobeShape& shape = lobes.shape;
    const auto clamped = [&](double w, int i) {
        const Interval range = weight_range(i, shape);
        return std::clamp(w, range.least, range.most);
    };
    if (lobes.count() > 0 && uniform(random) < 0.25) {
        const auto parent = lobes.of(int(uniform(random) * lobes.count()));
        std::vector<double> weight(parent.begin(), parent.end());
        for (int i = 0; i < shape.width(); ++i) {
            double& w = weight[std::size_t(i)];
            const double scale = uniform(random), shift = uniform(random);  // drawn in this order by every compiler
            w = clamped(w * elementary::exp(2 * scale - 1) + 4 * (shift - 0.5), i);
        }
        return weight;
    }
    std::vector<double> weight;
    const auto sharp = [&] {
        const double chance = uniform(random), size = 0.3 * elementary::pow(2e5, uniform(random)),
                     sign = uniform(random);
        return chance < 0.35 ? 0.0 : sign < 0.3 ? -std::min(size, 100.0) : size;
    };
    const auto broad = [&] {
        const double chance = uniform(random), size = 0.1 * elementary::pow(100, uniform(random)),
                     sign = uniform(random);
        return chance < 0.5 ? 0.0 : sign < 0.5 ? -size : size;
    };
    for (int n = 0; n < shape.variates; ++n) {
        const double p = sharp();
        if (shape.axial) {
            weight.push_back(clamped(p, int(weight.size())));
            continue;
        }
        const double chance = uniform(random), z = 2 * uniform(random) - 1, phi = 2 * k_pi * uniform(random);
        const Vec3d centre = chance < 0.5 ? Vec3d(0, 0, 1) : spherical(elementary::acos(z), phi);
        for (const double component : {centre.x, centre.y, centre.z})
            weight.push_back(clamped(p * component, int(weight.size())));
    }
    for (int k = 0; k < features(shape.form); ++k) {
        const double drawn = broad();
        weight.push_back(clamped(k_terms[std::size_t(k)].is_sharp ? sharp() : drawn, int(weight.size())));
    }
    return weight;
}

std::mt19937_64 generator(std::uint64_t seed, int start, int stage) {
    std::seed_seq seeds{std::uint32_t(seed), std::uint32_t(seed >> 32), std::uint32_t(start), std::uint32_t(stage)};
    return std::mt19937_64(seeds);
}

std::vector<std::vector<double>> random_candidates(std::mt19937_64& random, const Lobes& lobes) {
    std::vector<std::vector<double>> candidates;
    for (int i = 0; i < k_candidates; ++i) candidates.push_back(random_lobe(random, lobes));
    return candidates;
}

Lobes with_lobe(Lobes lobes, const std::vector<double>& lobe) {
    lobes.weight.insert(lobes.weight.end(), lobe.begin(), lobe.end());
    if (lobe.empty()) lobes.weight.insert(lobes.weight.end(), std::size_t(lobes.shape.width()), 0.0);
    return lobes;
}

Lobes without_lobe(Lobes lobes, std::ptrdiff_t j) {
    const auto at = lobes.weight.begin() + j * lobes.shape.width();
    lobes.weight.erase(at, at + lobes.shape.width());
    return lobes;
}

Lobes without_variate(Lobes lobes, int n) {
    const int C = lobes.shape.components();
    for (int j = 0; j < lobes.count(); ++j) std::fill_n(lobes.weight.begin() + j * lobes.shape.width() + n * C, C, 0.0);
    return lobes;
}

namespace {

/// Adds the best of many random lobes to those of the problem's last call of `loss`.
void add_lobe(LobeProblem& problem, Lobes& lobes, std::mt19937_64& random) {
    const std::vector<double> best = problem.best_addition(random_candidates(random, lobes));
    lobes = with_lobe(std::move(lobes), best);
}

double optimise(LobeProblem& problem, Lobes& lobes, int iterations,
                double target = std::numeric_limits<double>::infinity()) {
    LevenbergMarquardtOptions options;
    options.max_iterations = iterations;
    options.target = target;
    Eigen::VectorXd x = LobeProblem::pack(lobes);
    const auto summary = levenberg_marquardt(problem, x, options);
    lobes = problem.unpack(x);
    return summary.loss;
}

void keep_better(Candidate& best, Candidate next) {
    if (next.loss < best.loss) best = std::move(next);
}

/// Drops the least useful lobe and adds another, after the problem's call of `loss` for `best`; keeps the result if it
/// is better.
void replace_lobe(LobeProblem& problem, Candidate& best, std::mt19937_64& random) {
    const std::vector<double> cost = problem.cost_of_dropping();
    const auto least = std::min_element(cost.begin(), cost.end()) - cost.begin();
    Candidate next = best;
    next.lobes = without_lobe(std::move(next.lobes), least);
    problem.loss(LobeProblem::pack(next.lobes));
    add_lobe(problem, next.lobes, random);
    next.loss = optimise(problem, next.lobes, k_perturbation_steps, best.loss);
    keep_better(best, std::move(next));
}

/// The same for the least useful variate: its weights become 0, and its parameterization becomes a random one. Steps
/// alone rarely rotate a parameterization far, since no lobe fits in between.
void replace_variate(LobeProblem& problem, Candidate& best, std::mt19937_64& random) {
    Candidate next = best;
    int least = 0;
    next.loss = std::numeric_limits<double>::infinity();
    for (int n = 0; n < best.lobes.shape.variates; ++n) {
        Lobes without = without_variate(best.lobes, n);
        const double loss = problem.loss(LobeProblem::pack(without));
        if (loss < next.loss) next.lobes = std::move(without), next.loss = loss, least = n;
    }
    next.lobes.angle[std::size_t(least)] = k_pi * uniform(random);
    next.loss = optimise(problem, next.lobes, k_perturbation_steps, best.loss);
    keep_better(best, std::move(next));
}

}  // namespace

Candidate grow(const Rows& rows, const FitOptions& options, double log_peak_limit, int start, Reporter& reporter) {
    std::mt19937_64 random = generator(options.seed, start, 0);
    LobeProblem problem(rows, shape_of(options), false, log_peak_limit);
    Candidate best{start, without_lobes(shape_of(options), start, random)};
    for (int j = 0; j < options.lobes; ++j) {
        problem.loss(LobeProblem::pack(best.lobes));
        add_lobe(problem, best.lobes, random);
        best.loss = optimise(problem, best.lobes, j + 1 < options.lobes ? k_growth_steps : k_grown_steps);
        if (!reporter.advance("growing lobes", 1)) break;
    }
    return best;
}

void improve(const Rows& rows, const FitOptions& options, double log_peak_limit, int until, Candidate& best,
             Reporter& reporter) {
    LobeProblem problem(rows, shape_of(options), false, log_peak_limit);
    if (best.perturbations < until) best.loss = optimise(problem, best.lobes, k_first_steps);
    while (best.perturbations < until) {
        std::mt19937_64 random = generator(options.seed, best.start, 2 + best.perturbations++);
        if (best.perturbations % (k_lobe_perturbations + 1) == 0) {
            replace_variate(problem, best, random);
        } else {
            problem.loss(LobeProblem::pack(best.lobes));
            replace_lobe(problem, best, random);
        }
        if (!reporter.advance("replacing lobes", 1)) break;
    }
}

void polish(const Rows& rows, const FitOptions& options, double log_peak_limit, Candidate& candidate) {
    std::mt19937_64 random = generator(options.seed, candidate.start, 1);
    LobeProblem problem(rows, shape_of(options), false, log_peak_limit);
    candidate.loss = optimise(problem, candidate.lobes, k_polish_steps);
    // On more rows than it was found on, a lobe may become useless.
    for (int attempt = 0; attempt < k_polish_attempts; ++attempt) {
        const std::vector<double> cost = problem.cost_of_dropping();
        if (*std::min_element(cost.begin(), cost.end()) > k_useless * candidate.loss) break;
        replace_lobe(problem, candidate, random);
        problem.loss(LobeProblem::pack(candidate.lobes));
    }
}

void see(const Rows& rows, const FitOptions& options, double log_peak_limit, int steps, Candidate& candidate) {
    LobeProblem problem(rows, shape_of(options), false, log_peak_limit);
    optimise(problem, candidate.lobes, steps);
    candidate.loss = problem.delta_e();
}

}  // namespace srbf
