// The fit of one sampled view: from lobes that are nearly right, from scratch, and to its pixels.
#pragma once
#include <limits>
#include <random>
#include <vector>

#include "fit/view_problem.h"
#include "least_squares.h"

namespace srbf {

struct ViewFit {
    std::vector<ViewLobe> lobes;
    double loss = std::numeric_limits<double>::infinity();
    Stop stop = Stop::decrease;
    bool is_empty() const { return lobes.empty(); }
};

/// From these lobes, such as a neighbour's.
ViewFit fit_view(ViewProblem& problem, const ViewRows& rows, const std::vector<ViewLobe>& start);

/// The best of the fits from clusterings of the view's values, improved by repeatedly dropping the least useful lobe
/// and adding a random one.
ViewFit fit_view_from_scratch(ViewProblem& problem, const ViewRows& rows, std::size_t lobes, std::mt19937_64& random);

/// Makes the lobes x, of which `problem` has just computed the loss, match the view's pixels as well, or only their
/// coefficients. Returns the lobes; `problem` has the coefficients.
std::vector<ViewLobe> match_pixels(ViewProblem& problem, const Eigen::VectorXd& x, double loss, bool keep_lobes);

}  // namespace srbf
