#include "models/pm/solve/rounding.h"

#include <algorithm>
#include <cmath>
#include <ranges>

#include "base/half.h"
#include "base/levenberg_marquardt.h"
#include "models/pm/pm_functions.h"
#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {

Parameterization rounded_direction(double angle) {
    const double a = elementary::cos(angle), b = elementary::sin(angle);
    const bool swap = std::abs(b) > std::abs(a);
    const double ratio = swap ? a / b : b / a, sign = (swap ? b : a) < 0 ? -1 : 1;
    Parameterization best;
    double min = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 1024; ++i) {
        const double large = 1 + i / 1024.0, small = double(round_to_half(float(ratio * large)));
        const double error = std::abs(small / large - ratio);
        if (error >= min) continue;
        min = error;
        const auto p = float(sign * large), q = float(sign * small);
        best = swap ? Parameterization{q, p} : Parameterization{p, q};
    }
    return best;
}

PmModel without_coefficients(const Lobes& lobes) {
    PmModel model;
    const LobeShape& shape = lobes.shape;
    model.form = shape.form;
    model.axial = shape.axial;
    model.lobes = lobes.count();
    model.variates = shape.variates;
    for (const double angle : lobes.angle)
        model.parameterization.push_back({float(elementary::cos(angle)), float(elementary::sin(angle))});
    for (int j = 0; j < model.lobes; ++j) {
        for (const double kappa : lobes.parameters_of(j).subspan(std::size_t(shape.directional())))
            model.exponent.push_back(float(kappa));
        for (int n = 0; n < model.variates; ++n) {
            const Vec3d p = vector_of(lobes.parameters_of(j), shape, n);
            const double bandwidth = elementary::hypot(p.x, p.y, p.z);
            model.centre.push_back(bandwidth > 0 ? to_float((1 / bandwidth) * p) : Vec3f(0, 0, 1));
            model.bandwidth.push_back(float(bandwidth));
        }
    }
    model.coefficient.resize(std::size_t(model.lobes));
    model.log_scale.resize(std::size_t(model.lobes));
    return model;
}

namespace {

/// If rounding raises the loss by more than this factor, lobes are rounded one after the other.
constexpr double k_cost_of_rounding = 1.003;
/// Relative additions to the diagonal of the Hessian: with less damping the remaining variables follow further. The
/// best value differs between fits; variables follow no further than needed.
constexpr double k_dampings[] = {1e-3, 1e-5, 1e-8};

Lobes round_to_halves(const Eigen::VectorXd& x, const LobeShape& shape) {
    const Lobes lobes = unpack(x, shape);
    return to_lobes(to_halves(without_coefficients(lobes), lobes), shape);
}

/// The variables before rounding, and a loss around them to second order.
struct SecondOrder {
    const LobeShape& shape;
    Eigen::VectorXd x, lower, upper;
    Eigen::MatrixXd H;

    Lobes round_in_turn(double damping) const {
        Eigen::VectorXd current = x;
        Eigen::MatrixXd damped = H;
        damped.diagonal() += damping * H.diagonal().cwiseMax(1e-8 * H.diagonal().maxCoeff());
        // The change of the variables that may still move, per change of one of them.
        Eigen::MatrixXd inverse = damped.ldlt().solve(Eigen::MatrixXd::Identity(x.size(), x.size()));
        const auto round = [&](Eigen::Index first, Eigen::Index count) {
            const Eigen::VectorXd error = (pack(round_to_halves(current, shape)) - current).segment(first, count);
            const Eigen::MatrixXd follow =
                inverse.middleCols(first, count) * inverse.block(first, first, count, count).inverse();
            current = (current + follow * error).cwiseMax(lower).cwiseMin(upper);
            inverse -= follow * inverse.middleRows(first, count).eval();
        };
        for (int n = 0; n < shape.variates; ++n) round(n, 1);
        for (Eigen::Index lobe = shape.variates; lobe < x.size(); lobe += shape.width()) {
            for (int n = 0; n < shape.directional(); n += shape.components()) round(lobe + n, shape.components());
            for (int n = shape.directional(); n < shape.width(); ++n) round(lobe + n, 1);
        }
        return round_to_halves(current, shape);
    }
};

}  // namespace

PmModel to_model(const LobeProblem& problem, const Lobes& lobes, const std::vector<float>& wavelengths) {
    constexpr double k_unused = 1e-30;
    PmModel model = without_coefficients(lobes);
    std::vector<double> largest, log_peak;  // maxima over channels; −∞: the lobe is not used
    for (int j = 0; j < model.lobes; ++j) {
        largest.push_back(problem.beta().row(j).maxCoeff());
        log_peak.push_back(elementary::log(largest.back()) + problem.log_unit(lobes, j));
    }
    const auto is_beyond_halves = [&](std::size_t j) {
        return largest[j] > k_unused && (log_peak[j] > elementary::log(double(k_half_max)) ||
                                         log_peak[j] < elementary::log(double(k_half_min)) + 3);
    };
    const bool has_log_scale = features(lobes.shape.form) > 0 ||
                               std::ranges::any_of(std::views::iota(std::size_t(0), largest.size()), is_beyond_halves);
    for (std::size_t j = 0; j < largest.size(); ++j) {
        const bool is_used = largest[j] > k_unused;
        const double scale = has_log_scale && is_used ? double(round_to_half(float(log_peak[j]))) : 0;
        // β / largest × e^(log peak − scale): neither factor overflows.
        const double factor = is_used ? elementary::exp(std::min(log_peak[j] - scale, 80.0)) / largest[j] : 0;
        const auto coefficient = [&](Eigen::Index c) { return float(problem.beta()(Eigen::Index(j), c) * factor); };
        if (wavelengths.empty()) model.coefficient[j] = {coefficient(0), coefficient(1), coefficient(2)};
        for (std::size_t c = 0; c < wavelengths.size(); ++c) model.spectrum.push_back(coefficient(Eigen::Index(c)));
        model.log_scale[j] = float(scale);
    }
    if (!wavelengths.empty()) model.coefficient = colours(model.spectrum, wavelengths);
    model.wavelength = wavelengths;
    return model;
}

PmModel to_halves(PmModel model, const Lobes& lobes) {
    for (std::size_t n = 0; n < model.parameterization.size(); ++n)
        model.parameterization[n] = rounded_direction(lobes.angle[n]);
    return rounded(model);
}

Lobes to_lobes(const PmModel& model, const LobeShape& shape) {
    Lobes lobes{shape, {}, {}};
    for (int n = 0; n < shape.variates; ++n) {
        const Parameterization p = model.parameterization[std::size_t(n)];
        lobes.angle.push_back(elementary::atan2(double(p.b), double(p.a)));
    }
    const auto N = std::size_t(model.variates), F = std::size_t(features(model.form));
    for (std::size_t j = 0; j < std::size_t(model.lobes); ++j) {
        for (std::size_t i = j * N; i < (j + 1) * N; ++i) {
            const Vec3f xi = model.centre[i];
            const double bandwidth = double(model.bandwidth[i]);
            if (!model.axial)
                lobes.parameter.insert(lobes.parameter.end(), {bandwidth * double(xi.x), bandwidth * double(xi.y)});
            lobes.parameter.push_back(bandwidth * double(xi.z));
        }
        for (std::size_t i = j * F; i < (j + 1) * F; ++i) lobes.parameter.push_back(double(model.exponent[i]));
    }
    return lobes;
}

Lobes round_lobes(LobeProblem& problem, const Lobes& lobes, double unrounded) {
    const Eigen::VectorXd x = pack(lobes);
    Lobes best = round_to_halves(x, lobes.shape);
    double min = problem.loss(pack(best));
    if (min <= k_cost_of_rounding * unrounded) return best;
    SecondOrder loss{lobes.shape, x, problem.lower(x), problem.upper(x), {}};
    Eigen::VectorXd g;
    problem.loss(x);
    problem.linearise(x, loss.H, g);
    fix_at_bounds(x, loss.lower, loss.upper, loss.H, g);
    const Eigen::MatrixXd beta = problem.beta();
    for (const double damping : k_dampings) {
        problem.continue_from(beta);  // avoids coefficients of lobes that followed too far
        Lobes halves = loss.round_in_turn(damping);
        if (const double rounded_loss = problem.loss(pack(halves)); rounded_loss < min)
            min = rounded_loss, best = std::move(halves);
        if (min <= k_cost_of_rounding * unrounded) break;
    }
    problem.continue_from(beta);
    return best;
}

}  // namespace
