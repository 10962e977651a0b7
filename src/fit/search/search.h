// The search for lobes: candidates grow lobe by lobe and are perturbed.
#pragma once
#include <limits>

#include "fit/options.h"
#include "fit/search/random_lobes.h"
#include "fit/search/solver.h"
#include "reporter.h"

namespace srbf {

/// A candidate of the search.
struct Candidate {
    int start = 0;         ///< index of its start, which determines its random numbers together with the seed
    std::size_t rows = 0;  ///< index of its observations, of those that the solver has
    Lobes lobes = {};
    double loss = std::numeric_limits<double>::infinity();  ///< most recent value
    Eigen::MatrixXd beta = {}, gram = {};                   ///< with that loss: J × C; E·E
    int perturbations = 0;                                  ///< number of perturbations so far
};

// Each of these takes all candidates forward together, step by step; candidates are independent of each other. Errors:
// those of the solver. Cancelled, they return early.

/// Grows J lobes one by one.
template <Solver S>
Result<Done> grow(S& solver, const FitOptions& options, std::span<Candidate> candidates, Reporter& reporter);

/// Optimises the candidates, possibly on other rows than before. Then perturbs them until they have had `until`
/// perturbations: each drops the least useful lobe and adds another, and is kept if the loss falls. Every fourth one
/// replaces a variate instead.
template <Solver S>
Result<Done> perturb(S& solver, const FitOptions& options, int until, std::span<Candidate> candidates,
                     Reporter& reporter);

/// Optimises on more rows; lobes that become useless there are replaced.
template <Solver S> Result<Done> polish(S& solver, const FitOptions& options, std::span<Candidate> candidates);

}  // namespace srbf
