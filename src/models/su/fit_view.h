// The fit of one sampled view: from lobes that are nearly right, and from scratch.
#pragma once
#include <array>
#include <limits>
#include <random>
#include <vector>

#include "base/levenberg_marquardt.h"
#include "models/su/view_problem.h"

namespace srbf {

struct ViewFit {
    std::vector<ViewLobe> lobes;
    double loss = std::numeric_limits<double>::infinity();
    Stop stop = Stop::decrease;
    std::vector<std::array<double, 3>> coefficient = {};  ///< β of each lobe [1/sr]
    bool is_empty() const { return lobes.empty(); }
};

/// From these lobes, such as a neighbour's.
ViewFit fit_view(ViewProblem& problem, const ViewRows& rows, const std::vector<ViewLobe>& start);

/// The best of the fits from lobes of all sizes about the brightest direction or far apart from each other, improved by
/// repeatedly dropping the least useful lobe and adding a random one.
ViewFit fit_view_from_scratch(ViewProblem& problem, const ViewRows& rows, std::size_t lobes, std::mt19937_64& random);

/// The lobes of the view `from` for the view `to` of a BRDF that is invariant under rotation of both directions.
std::vector<ViewLobe> rotated(std::vector<ViewLobe> lobes, Vec3f from, Vec3f to);

/// The coefficients alone, for these lobes.
ViewFit fit_coefficients(ViewProblem& problem, const ViewRows& rows, const std::vector<ViewLobe>& lobes);

}  // namespace srbf
