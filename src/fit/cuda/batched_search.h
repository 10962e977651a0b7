// The search of fit/search.h for many candidates, of one or more materials, that take each step together.
#pragma once
#include "fit/cuda/batches.h"

namespace srbf {

/// A candidate and the index of its observations in the batches.
struct BatchedCandidate {
    Candidate candidate;
    std::size_t rows = 0;
    Eigen::MatrixXd beta = {}, gram = {};  ///< of its lobes
};

// As the functions of the same names in search.h. Errors: those of the device.
Result<Done> grow(Batches& batches, const FitOptions& options, double log_peak_limit,
                  std::span<BatchedCandidate> candidates, Reporter& reporter);
Result<Done> improve(Batches& batches, const FitOptions& options, double log_peak_limit, int until,
                     std::span<BatchedCandidate> candidates, Reporter& reporter);
Result<Done> polish(Batches& batches, const FitOptions& options, double log_peak_limit,
                    std::span<BatchedCandidate> candidates);

}  // namespace srbf
