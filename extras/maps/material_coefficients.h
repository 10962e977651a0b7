// A material as a sum of lobes that it shares with others.
#pragma once
#include <Eigen/Dense>
#include <span>
#include <vector>

#include "extras/maps/shared_problem.h"
#include "models/pm/search/fit_pm.h"
#include "observe/observations.h"
#include "srbf/basis.h"

namespace SRBF_NAMESPACE {

/// Errors: options out of range.
Result<Done> check_basis_options(const BasisOptions& options);
/// The options of a fit to one material with the same kind of lobes.
PmFitOptions lobe_options(const BasisOptions& options);

/// The rows of a material with all terms of its objective, and the lobes, at most `options.active`, of which it is
/// the sum.
SharedRows material_of(const Observations& observations, const Lobes& lobes, const BasisOptions& options);

/// The lobes of a material, and the logarithms of its coefficients for lobes with peak 1.
struct LogCoefficients {
    std::vector<std::size_t> lobe;
    Eigen::MatrixXd log_beta;  ///< lobes × 3; −∞ for a coefficient of 0
};
/// The coefficients of one material, with all terms of its objective.
LogCoefficients coefficients_of(const Observations& observations, const Lobes& lobes, const BasisOptions& options);

/// Sets the log scales such that the largest coefficient of each lobe is 64. Other coefficients may be 10⁶ times
/// smaller and still be normal 16-bit floats; those of later materials may be a thousand times larger.
void set_scales(PmModel& basis, std::span<const LogCoefficients> materials);
/// Adds the coefficients of a material, with the scales of the library's lobes.
void add_material(Library& library, const LogCoefficients& coefficients);

}  // namespace srbf
