// A material as a sum of lobes that it shares with others.
#pragma once
#include <Eigen/Dense>
#include <span>
#include <vector>

#include "extras/maps/shared_problem.h"
#include "models/pm/search/options.h"
#include "observe/observations.h"
#include "srbf/basis.h"

namespace srbf {

/// Errors: options out of range.
Result<Done> check_basis_options(const BasisOptions& of);
/// The options of a fit to one material by the same kind of lobes.
FitOptions lobe_options(const BasisOptions& of);

/// The rows of a material by all terms of its objective, and those of the lobes, `of.active` at most, of which it is the
/// sum.
SharedRows material_of(const Observations& observations, const Lobes& all, const BasisOptions& of);

/// The lobes of a material, and the logarithms of its coefficients of lobes of peak 1.
struct LogCoefficients {
    std::vector<std::size_t> lobe;
    Eigen::MatrixXd log_beta;  ///< lobes × 3; −∞ of 0
};
/// The coefficients of one material, by all terms of its objective.
LogCoefficients coefficients_of(const Observations& observations, const Lobes& all, const BasisOptions& of);

/// Sets the log scales for which the largest coefficient of each lobe is 64: others may be 10⁶ times smaller and are
/// normal 16-bit floats, those of materials that come later a thousand times larger.
void set_scales(PmModel& basis, std::span<const LogCoefficients> materials);
/// Adds the coefficients of a material, with the scales of the library's lobes.
void add_material(Library& library, const LogCoefficients& of);

}  // namespace srbf
