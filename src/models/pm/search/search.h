// The search for lobes: a candidate grows lobe by lobe and is perturbed.
#pragma once
#include <limits>

#include "base/reporter.h"
#include "models/pm/search/options.h"
#include "models/pm/search/random_lobes.h"
#include "models/pm/solve/lobe_problem.h"

namespace SRBF_NAMESPACE {

/// A candidate of the search.
struct Candidate {
    int start = 0;  ///< index of its start, which determines its random numbers together with the seed
    Lobes lobes = {};
    double loss = std::numeric_limits<double>::infinity();  ///< most recent value
    Eigen::MatrixXd beta = {}, gram = {};                   ///< for that loss: J × C; E·E
    int perturbations = 0;                                  ///< number of perturbations so far
};

// Each of these functions advances a candidate on the rows of a problem, and returns early if cancelled.

/// Grows J lobes one by one.
void grow(LobeProblem& problem, const PmFitOptions& options, Candidate& candidate, Reporter& reporter);

/// Optimises the candidate, possibly on other rows than before. Then perturbs it until it has had `until`
/// perturbations. Each replaces the least useful lobe, or every fourth time a variate, and is kept if the loss
/// falls.
void perturb(LobeProblem& problem, const PmFitOptions& options, int until, Candidate& candidate, Reporter& reporter);

/// Optimises on more rows by `steps` steps, and replaces lobes that become useless there.
void polish(LobeProblem& problem, const PmFitOptions& options, int steps, Candidate& candidate);

}  // namespace srbf
