// The search for lobes: a candidate grows lobe by lobe and is perturbed.
#pragma once
#include <Eigen/Dense>
#include <limits>

#include "base/reporter.h"
#include "models/pm/search/options.h"
#include "models/pm/search/random_lobes.h"
#include "models/pm/solve/lobe_problem.h"

namespace srbf {

/// A candidate of the search.
struct Candidate {
    int start = 0;  ///< index of its start, which determines its random numbers together with the seed
    Lobes lobes = {};
    double loss = std::numeric_limits<double>::infinity();  ///< most recent value
    Eigen::MatrixXd beta = {}, gram = {};                   ///< with that loss: J × C; E·E
    int perturbations = 0;                                  ///< number of perturbations so far
};

// Each of these takes a candidate forward on the rows of a problem. Cancelled, they return early.

/// Grows J lobes one by one.
void grow(LobeProblem& problem, const FitOptions& options, Candidate& candidate, Reporter& reporter);

/// Optimises the candidate, possibly on other rows than before. Then perturbs it until it has had `until`
/// perturbations: each drops the least useful lobe and adds another, and is kept if the loss falls. Every fourth one
/// replaces a variate instead.
void perturb(LobeProblem& problem, const FitOptions& options, int until, Candidate& candidate, Reporter& reporter);

/// Optimises on more rows, by so many steps; lobes that become useless there are replaced.
void polish(LobeProblem& problem, const FitOptions& options, int steps, Candidate& candidate);

}  // namespace srbf
