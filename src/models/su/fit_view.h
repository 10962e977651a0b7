// The fit of the lobes of one view.
#pragma once
#include <array>
#include <random>
#include <vector>

#include "base/levenberg_marquardt.h"
#include "models/su/view_problem.h"

namespace SRBF_NAMESPACE {

struct ViewFit {
    std::vector<ViewLobe> lobes;
    double loss = std::numeric_limits<double>::infinity();
    Stop stop = Stop::decrease;
    std::vector<std::array<double, 3>> coefficient = {};  ///< the coefficient β of each lobe [1/sr]
    bool is_empty() const { return lobes.empty(); }
};

/// Fits a view from initial lobes that are nearly optimal, such as a neighbour's.
ViewFit fit_view(ViewProblem& problem, const ViewRows& rows, const std::vector<ViewLobe>& start);

/// Fits a view from lobes of all sizes around the brightest direction, and from lobes far apart. Improves the best of
/// these fits by repeatedly replacing the least useful lobe by a random one.
ViewFit fit_view_from_scratch(ViewProblem& problem, const ViewRows& rows, std::size_t lobes, std::mt19937_64& random);

/// Rotates the lobes of a view about the normal to the azimuth of another view.
std::vector<ViewLobe> rotate_lobes(std::vector<ViewLobe> lobes, Vec3f view, Vec3f other);

ViewFit fit_coefficients(ViewProblem& problem, const ViewRows& rows, const std::vector<ViewLobe>& lobes);

}  // namespace
