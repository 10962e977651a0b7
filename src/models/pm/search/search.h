// The search for lobes: a candidate grows lobe by lobe and is perturbed; and the last stage, on all observations.
#pragma once
#include <limits>
#include <random>

#include "base/reporter.h"
#include "models/pm/search/fit_pm.h"
#include "models/pm/solve/lobe_problem.h"
#include "models/pm/solve/lobes.h"

namespace SRBF_NAMESPACE {

/// A candidate of the search.
struct Candidate {
    int start = 0;  ///< index of its start, which determines its random numbers together with the seed
    Lobes lobes = {};
    double loss = std::numeric_limits<double>::infinity();  ///< most recent value
    Eigen::MatrixXd beta = {}, gram = {};  ///< coefficients of that loss, J × C; products of columns EᵀE
    int perturbations = 0;                 ///< number of perturbations so far
};

// Each of these functions advances a candidate on the rows of a problem, and returns early if cancelled.

/// Grows J lobes one by one.
void grow(LobeProblem& problem, const PmFitOptions& options, Candidate& candidate, Reporter& reporter);

/// Optimises the candidate, possibly on other rows than before. Then perturbs it until it has had `until`
/// perturbations. Each replaces the least useful lobe, or every fourth time a variate, and is kept if the loss falls.
void perturb(LobeProblem& problem, const PmFitOptions& options, int until, Candidate& candidate, Reporter& reporter);

/// Optimises on more rows by `steps` steps, and replaces lobes that become useless there.
void polish(LobeProblem& problem, const PmFitOptions& options, int steps, Candidate& candidate);

/// Optimises the lobes on all observations, with these terms, and rounds them. Bound pairs that the rounded model
/// exceeds become observations for the next round, until the model exceeds none. With spectral observations the lobes
/// then get spectra.
PmFit finish(Lobes lobes, Observations observations, const PackingOptions& terms, const PmFitOptions& options,
             const Reporter& reporter);

/// The random generator of one of the streams of a start: 0 for its growth, 1 for its polish, 2 + i for perturbation i.
std::mt19937_64 generator(std::uint64_t seed, int start, int stream);

/// Initial parameterizations: half vector, light, view (Tsai 2009), the half vector again, and random ones. A peak
/// narrower than the largest 16-bit bandwidth needs two half vectors. In every second start light and view are rotated
/// by up to a radian, because some optima are far from both, and with three variates the last is the half vector.
Lobes initial_parameterizations(const LobeShape& shape, int start, std::mt19937_64& random);

/// A random lobe. Its parameters are log-uniform with either sign, and some are 0; or it is a perturbed copy of one of
/// `lobes`. Half of the general centres are poles, the others are uniform on the sphere.
std::vector<double> random_lobe(std::mt19937_64& random, const Lobes& lobes);

/// Number of random lobes from which the best is added.
inline constexpr int k_additions = 256;

/// `count` random candidates for an additional lobe.
std::vector<std::vector<double>> random_candidates(std::mt19937_64& random, const Lobes& lobes, int count);
/// The lobes with `lobe` added, or with a lobe of parameters 0 if `lobe` is empty.
Lobes with_lobe(Lobes lobes, const std::vector<double>& lobe);
Lobes without_lobe(Lobes lobes, std::ptrdiff_t j);
/// The lobes with the parameters of variate n set to 0.
Lobes with_variate_zeroed(Lobes lobes, int n);

}  // namespace
