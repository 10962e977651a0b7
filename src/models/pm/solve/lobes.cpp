#include "models/pm/solve/lobes.h"

#include <algorithm>
#include <cmath>

#include "base/half.h"
#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {

Eigen::VectorXd pack(const Lobes& lobes) {
    Eigen::VectorXd x(Eigen::Index(lobes.angle.size() + lobes.parameter.size()));
    std::copy(lobes.angle.begin(), lobes.angle.end(), x.begin());
    std::copy(lobes.parameter.begin(), lobes.parameter.end(), x.begin() + Eigen::Index(lobes.angle.size()));
    return x;
}

Lobes unpack(const Eigen::VectorXd& x, const LobeShape& shape) {
    const auto parameters = x.begin() + shape.variates;
    return {shape, {x.begin(), parameters}, {parameters, x.end()}};
}

Interval parameter_range(int n, const LobeShape& shape) {
    const auto at_most = [&](double spacing_limit) {
        return shape.finest > 0 ? std::min(double(k_half_max), spacing_limit) : double(k_half_max);
    };
    if (const int k = n - shape.directional(); k >= 0) {
        const ExponentTerm& term = k_terms[std::size_t(k)];
        const double slope = term.is_slope ? at_most(1 / shape.finest) : double(k_half_max);
        const double min = is_reciprocal(shape.form) ? term.min_if_reciprocal : term.min;
        return {std::max(min, -slope), std::min(term.max, slope)};
    }
    const double bandwidth = at_most(elementary::pow(shape.finest, -2));  // |p|, representable in 16 bits
    const double component = shape.axial ? bandwidth : bandwidth / std::sqrt(3.0);
    return {-component, component};
}

double log_peak_factor(std::span<const double> parameters, const LobeShape& shape, double offset) {
    double log_factor = elementary::log(double(shape.orders())) - offset;
    for (int n = 0; n < shape.variates; ++n) {
        const Vec3d p = vector_of(parameters, shape, n);
        log_factor += elementary::hypot(p.x, p.y, p.z) - p.z;
    }
    return log_factor;
}

Vec3d vector_of(std::span<const double> parameters, const LobeShape& shape, int n) {
    if (shape.axial) return {0, 0, parameters[std::size_t(n)]};
    const double* p = &parameters[std::size_t(3 * n)];
    return {p[0], p[1], p[2]};
}

}  // namespace
