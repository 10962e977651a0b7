// The lobes of a multivariate fit.
#pragma once
#include <Eigen/Dense>

#include "srbf/model.h"
#include "srbf/models/exponent_terms.h"

namespace SRBF_NAMESPACE {

/// Structure of the lobes of a fit.
struct LobeShape {
    PmForm form = PmForm::gaussian;
    int variates = 0;   ///< N
    bool axial = true;  ///< only centres at +z or −z
    double finest = 0;  ///< least width of any factor of a lobe [rad]; 0: the limit of 16-bit floats

    int components() const { return axial ? 1 : 3; }             ///< D: parameters per variate
    int directional() const { return variates * components(); }  ///< parameters of all variates of a lobe
    int width() const { return directional() + features(form); }
    /// Number of orders of the directions in which a lobe is evaluated: (ωl, ωv), and (ωv, ωl) if the form is
    /// reciprocal.
    int orders() const { return is_reciprocal(form) ? 2 : 1; }
};

/// The nonlinear parameters of J lobes of N variates. Lobe j is E_j = exp(Σ_n p_jn·(ψ_n − ẑ) + Σ_k κ_jk x_k − o_j).
/// Up to a factor this is a product of Gaussian SRBFs, with bandwidths |p_jn| and centres p_jn / |p_jn|, and of the
/// exponentials of the form's further features. o_j normalises its maximum over the rows to 1. An axial lobe has
/// only the third component of p_jn. A reciprocal lobe is the sum of two such lobes, at (ωl, ωv) and at (ωv, ωl).
struct Lobes {
    LobeShape shape;
    std::vector<double> angle;      ///< N: (a_n, b_n) = (cos, sin)
    std::vector<double> parameter;  ///< J × (N D + F): p_j1, …, p_jN, κ_j1, …
    int count() const { return shape.variates ? int(parameter.size()) / shape.width() : 0; }
    std::span<const double> parameters_of(int j) const {
        return {parameter.data() + std::size_t(j * shape.width()), std::size_t(shape.width())};
    }
};
/// Conversion between lobes and the variables of a fit, x = (angles, parameters).
Eigen::VectorXd pack(const Lobes& lobes);
Lobes unpack(const Eigen::VectorXd& x, const LobeShape& shape);

/// Lower and upper bound of a number.
struct Interval {
    double min, max;
};
/// The range of parameter n of a lobe.
Interval parameter_range(int n, const LobeShape& shape);

/// p_n from the parameters of a lobe.
Vec3d vector_of(std::span<const double> parameters, const LobeShape& shape, int n);
/// Log of the factor that converts β_j in a problem's units to the coefficient of a lobe with peak 1; `offset`:
/// o_j.
double log_peak_factor(std::span<const double> parameters, const LobeShape& shape, double offset);

}  // namespace
