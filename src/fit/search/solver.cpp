#include "fit/search/solver.h"

#include "fit/solve/least_squares.h"

namespace srbf {

Result<Done> ProcessorSolver::optimise(std::span<Trial> trials) {
    for (Trial& trial : trials) {
        LevenbergMarquardtOptions options;
        options.max_iterations = trial.steps;
        options.target = trial.target;
        Eigen::VectorXd x = pack(trial.lobes);
        const double loss = levenberg_marquardt(problem_, x, options).loss;
        trial.lobes = unpack(x, trial.lobes.shape);
        take_loss(trial, loss);
    }
    return Done{};
}

Result<Done> ProcessorSolver::best_additions(std::span<Trial> trials) {
    for (Trial& trial : trials) {
        take_loss(trial, problem_.loss(pack(trial.lobes)));
        trial.addition = problem_.best_addition(trial.additions);
    }
    return Done{};
}

}  // namespace srbf
