// What the search asks for: lobes that are optimised, and the best lobe to add. On this processor; on a device see
// fit/cuda/device_solver.h.
#pragma once
#include <Eigen/Dense>
#include <concepts>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "fit/solve/lobe_problem.h"
#include "srbf/result.h"

namespace srbf {

/// Lobes that are to be optimised, or extended by one, and what comes of it.
struct Trial {
    std::size_t rows = 0;  ///< index of its observations, of those that the solver has
    Lobes lobes;           ///< in and out
    int steps = 0;         ///< of `optimise`: at most so many; 0 for the loss alone
    double target = std::numeric_limits<double>::infinity();  ///< of `optimise`, see LevenbergMarquardtOptions
    std::vector<std::vector<double>> additions;               ///< of `best_additions`: what to choose from

    double loss = 0;               ///< out
    Eigen::MatrixXd beta, gram;    ///< out: J × C; E·E
    std::vector<double> addition;  ///< out of `best_additions`: the best one, or empty
};

/// Trials are independent of each other; how many of them run at once changes nothing.
template <typename S>
concept Solver = requires(S& solver, std::span<Trial> trials) {
    { solver.optimise(trials) } -> std::same_as<Result<Done>>;        // Levenberg-Marquardt
    { solver.best_additions(trials) } -> std::same_as<Result<Done>>;  // the loss, and the best of the additions
};

/// On the thread that calls it, for the observations of one material.
class ProcessorSolver {
  public:
    ProcessorSolver(const Rows& rows, const LobeShape& shape, double log_peak_limit)
        : problem_(rows, shape, false, log_peak_limit) {}
    Result<Done> optimise(std::span<Trial> trials);
    Result<Done> best_additions(std::span<Trial> trials);

  private:
    void take_loss(Trial& trial, double loss) const {
        trial.loss = loss, trial.beta = problem_.beta(), trial.gram = problem_.gram();
    }
    LobeProblem problem_;
};

}  // namespace srbf
