#include "fit/solve/rounding.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "fit/solve/least_squares.h"
#include "srbf/elementary.h"
#include "srbf/half.h"

namespace srbf {

Parameterization rounded_direction(double angle) {
    const double a = elementary::cos(angle), b = elementary::sin(angle);
    const bool swap = std::abs(b) > std::abs(a);
    const double ratio = swap ? a / b : b / a, sign = (swap ? b : a) < 0 ? -1 : 1;
    Parameterization best;
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 1024; ++i) {
        const double large = 1 + i / 1024.0, small = double(round_to_half(float(ratio * large)));
        const double error = std::abs(small / large - ratio);
        if (error >= least) continue;
        least = error;
        const auto p = float(sign * large), q = float(sign * small);
        best = swap ? Parameterization{q, p} : Parameterization{p, q};
    }
    return best;
}

namespace {
Parameterization swapped(Parameterization p) { return {p.b, p.a}; }

/// Their model, with coefficients 0.
PmModel without_coefficients(const Lobes& lobes) {
    PmModel model;
    const LobeShape& shape = lobes.shape;
    model.form = shape.form;
    model.axial = shape.axial;
    model.lobes = lobes.count();
    model.variates = (shape.reciprocal ? 2 : 1) * shape.variates;
    for (int n = 0; n < model.variates; ++n) {
        const double angle = lobes.angle[std::size_t(n % shape.variates)];
        const Parameterization p{float(elementary::cos(angle)), float(elementary::sin(angle))};
        model.parameterization.push_back(n < shape.variates ? p : swapped(p));
    }
    for (int j = 0; j < model.lobes; ++j) {
        for (const double kappa : lobes.of(j).subspan(std::size_t(shape.directional())))
            model.exponent.push_back(float(kappa));
        for (int n = 0; n < model.variates; ++n) {
            const Vec3d p = vector_of(lobes.of(j), shape, n % shape.variates);
            const double bandwidth = elementary::hypot(p.x, p.y, p.z);
            model.centre.push_back(bandwidth > 0 ? to_float((1 / bandwidth) * p) : Vec3f(0, 0, 1));
            model.bandwidth.push_back(float(bandwidth));
        }
    }
    model.coefficient.resize(std::size_t(model.lobes));
    model.log_scale.resize(std::size_t(model.lobes));
    return model;
}
}  // namespace

PmModel to_model(const LobeProblem& problem, const Lobes& lobes, bool log_scale,
                 const std::vector<float>& wavelengths) {
    PmModel model = without_coefficients(lobes);
    const LobeShape& shape = lobes.shape;
    std::vector<double> log_peak;                  // of the largest channel
    bool out_of_range = features(shape.form) > 0;  // those forms always have log scales
    for (int j = 0; j < model.lobes; ++j) {
        const double beta = problem.beta().row(j).maxCoeff();
        const double log_beta = elementary::log(beta) + elementary::log(problem.scale()) +
                                log_peak_factor(lobes.of(j), shape, problem.offset()[std::size_t(j)]);
        log_peak.push_back(log_beta);
        if (beta > 1e-30)
            out_of_range |=
                log_beta > elementary::log(double(k_half_max)) || log_beta < elementary::log(double(k_half_min)) + 3;
    }
    for (int j = 0; j < model.lobes; ++j) {
        const double largest = problem.beta().row(j).maxCoeff();
        const bool any = largest > 1e-30;
        const double scale =
            log_scale && out_of_range && any ? double(round_to_half(float(log_peak[std::size_t(j)]))) : 0.0;
        // β / largest × e^(log peak − scale): neither factor overflows.
        const double factor = any ? elementary::exp(std::min(log_peak[std::size_t(j)] - scale, 80.0)) / largest : 0.0;
        const auto coefficient = [&](Eigen::Index c) { return float(problem.beta()(j, c) * factor); };
        if (wavelengths.empty()) model.coefficient[std::size_t(j)] = {coefficient(0), coefficient(1), coefficient(2)};
        for (std::size_t c = 0; c < wavelengths.size(); ++c) model.spectrum.push_back(coefficient(Eigen::Index(c)));
        model.log_scale[std::size_t(j)] = float(scale);
    }
    if (!wavelengths.empty()) model.coefficient = colours(model.spectrum, wavelengths);
    model.wavelength = wavelengths;
    return model;
}

PmModel to_halves(PmModel model, const Lobes& lobes) {
    const std::size_t variates = lobes.angle.size();
    for (std::size_t n = 0; n < model.parameterization.size(); ++n) {
        const Parameterization p = rounded_direction(lobes.angle[n % variates]);
        model.parameterization[n] = n < variates ? p : swapped(p);
    }
    return rounded(model);
}

Lobes to_lobes(const PmModel& model, const LobeShape& shape) {
    Lobes lobes{shape, {}, {}};
    for (int n = 0; n < shape.variates; ++n) {
        const Parameterization p = model.parameterization[std::size_t(n)];
        lobes.angle.push_back(elementary::atan2(double(p.b), double(p.a)));
    }
    const auto N = std::size_t(model.variates), of_shape = std::size_t(shape.variates),
               F = std::size_t(features(model.form));
    for (std::size_t j = 0; j < std::size_t(model.lobes); ++j) {
        for (std::size_t i = j * N; i < j * N + of_shape; ++i) {
            const Vec3f xi = model.centre[i];
            const double bandwidth = double(model.bandwidth[i]);
            if (!model.axial)
                lobes.weight.insert(lobes.weight.end(), {bandwidth * double(xi.x), bandwidth * double(xi.y)});
            lobes.weight.push_back(bandwidth * double(xi.z));
        }
        for (std::size_t i = j * F; i < (j + 1) * F; ++i) lobes.weight.push_back(double(model.exponent[i]));
    }
    return lobes;
}

namespace {

/// A problem in which only some of the variables may change.
struct PartlyHeld {
    LobeProblem& problem;
    const std::vector<bool>& held;

    double loss(const Eigen::VectorXd& x) { return problem.loss(x); }
    void linearise(const Eigen::VectorXd& x, Eigen::MatrixXd& H, Eigen::VectorXd& g) { problem.linearise(x, H, g); }
    Eigen::VectorXd lower(const Eigen::VectorXd& x) const { return with_held(problem.lower(x), x); }
    Eigen::VectorXd upper(const Eigen::VectorXd& x) const { return with_held(problem.upper(x), x); }
    Eigen::VectorXd longest_step(const Eigen::VectorXd& x) const { return problem.longest_step(x); }

  private:
    Eigen::VectorXd with_held(Eigen::VectorXd bound, const Eigen::VectorXd& x) const {
        for (Eigen::Index i = 0; i < x.size(); ++i)
            if (held[std::size_t(i)]) bound[i] = x[i];
        return bound;
    }
};

/// Estimated cost of rounding each variable alone, up to a factor: rounding errors are relative. Angles come first; the
/// components of a centre are stored together.
std::vector<double> cost_of_rounding(const Eigen::VectorXd& x, const Eigen::MatrixXd& H, const LobeShape& shape) {
    const Eigen::Index N = shape.variates, W = shape.width(), C = shape.components();
    const Eigen::VectorXd of_each = x.cwiseAbs2().cwiseProduct(H.diagonal());
    std::vector<double> cost(std::size_t(x.size()), std::numeric_limits<double>::infinity());
    for (Eigen::Index i = N; i < x.size(); ++i) {
        const Eigen::Index weight = (i - N) % W;
        const bool of_centre = weight < shape.directional();
        cost[std::size_t(i)] = of_centre ? of_each.segment(i - weight % C, C).sum() : of_each[i];
    }
    return cost;
}

}  // namespace

Lobes rounded_in_turn(LobeProblem& problem, const Lobes& lobes, const Turns& turns) {
    Eigen::VectorXd x = pack(lobes), g;
    Eigen::MatrixXd H;
    problem.loss(x);
    problem.linearise(x, H, g);
    const std::vector<double> cost = cost_of_rounding(x, H, lobes.shape);
    std::vector<std::size_t> order(cost.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return cost[a] > cost[b]; });

    std::vector<bool> held(cost.size(), false);
    PartlyHeld rest{problem, held};
    LevenbergMarquardtOptions steps;
    steps.max_iterations = turns.steps;
    std::size_t first = 0;
    for (int turn = 0; first < order.size(); ++turn) {
        std::size_t end = order.size();  // end of the previous pass
        if (turn == 0)
            end = lobes.angle.size();
        else if (turn + 1 < turns.count)
            end = first + std::max<std::size_t>((order.size() - first) / turns.part, 1);
        // components of one centre stay together
        while (end > first && end < order.size() && cost[order[end]] == cost[order[end - 1]]) ++end;
        const Lobes now = unpack(x, lobes.shape);
        const Eigen::VectorXd halves = pack(to_lobes(to_halves(without_coefficients(now), now), lobes.shape));
        for (; first < end; ++first) {
            x[Eigen::Index(order[first])] = halves[Eigen::Index(order[first])];
            held[order[first]] = true;
        }
        if (first < order.size()) levenberg_marquardt(rest, x, steps);
    }
    return unpack(x, lobes.shape);
}

}  // namespace srbf
