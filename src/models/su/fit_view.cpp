#include "models/su/fit_view.h"

#include "brdf/directions.h"
#include "srbf/elementary.h"
#include "srbf/kernel.h"

namespace SRBF_NAMESPACE {
namespace {

/// Bounds on the steps of Levenberg-Marquardt: from a neighbour's lobes, from scratch, and after a lobe was replaced.
constexpr int k_steps = 15, k_steps_from_scratch = 40, k_steps_after_perturbation = 12;
/// A fit ends when a step is predicted to lower the loss by no more than this fraction; other seeds change it by more.
constexpr double k_decrease_tolerance = 1e-4;
/// The number of times that a fit from scratch replaces its least useful lobe.
constexpr int k_view_perturbations = 8;
/// The bandwidth of a random lobe is log-uniform from 0.3 to 3e4.
constexpr double k_min_random_bandwidth = 0.3, k_random_bandwidths = 1e5;
/// Bandwidths of initial lobes at the brightest direction: 0.5, 0.5 k, 0.5 k², …, up to 5e4, for each factor k. The
/// narrowest of five lobes have widths of 19°, 3.6° and 0.3°.
constexpr double k_bandwidth_factors[] = {3, 6, 30}, k_widest = 0.5, k_narrowest = 5e4;
/// Bandwidth of initial lobes that are far apart: a width of 13°.
constexpr double k_bandwidth_apart = 20;

ViewFit optimise(ViewProblem& problem, const ViewRows& rows, const std::vector<ViewLobe>& start, int steps) {
    Eigen::VectorXd x = problem.start(rows, start);
    const auto summary =
        levenberg_marquardt(problem, x, {.max_iterations = steps, .decrease_tolerance = k_decrease_tolerance});
    return {problem.lobes(x), summary.loss, summary.stop, problem.coefficients()};
}

/// The rows of a view with positive weight.
struct WeightedDirections {
    std::vector<Vec3f> direction;
    std::vector<double> weight;  ///< w f, summed over the channels
    Vec3d brightest;
};
WeightedDirections weighted_directions(const ViewRows& rows) {
    WeightedDirections points;
    double max = -1;
    for (std::size_t i = 0; i < rows.root_weight.size(); ++i) {
        const double root = double(rows.root_weight[i]);
        if (!(root > 0)) continue;
        double value = 0;
        for (const auto& y : rows.y) value += double(y[i]) / root;
        points.direction.push_back({rows.directions.w[0][i], rows.directions.w[1][i], rows.directions.w[2][i]});
        points.weight.push_back(root * root * value);
        if (value > max) max = value, points.brightest = to_double(points.direction.back());
    }
    return points;
}

/// Sets of J initial lobes: of all sizes at the brightest direction, and at bright directions that are far apart.
std::vector<std::vector<ViewLobe>> initial_lobes(const WeightedDirections& points, std::size_t J) {
    std::vector<std::vector<ViewLobe>> starts;
    for (const double factor : k_bandwidth_factors) {
        std::vector<ViewLobe> lobes;
        for (std::size_t j = 0; j < J; ++j)
            lobes.push_back({points.brightest, std::min(k_widest * elementary::pow(factor, double(j)), k_narrowest)});
        starts.push_back(std::move(lobes));
    }
    std::vector<ViewLobe> apart{{points.brightest, k_bandwidth_apart}};
    std::vector<double> squared_distance(points.weight.size(), 4.0);
    while (apart.size() < J) {
        std::size_t next = 0;
        double max = -1;
        for (std::size_t i = 0; i < points.weight.size(); ++i) {
            const Vec3d d = to_double(points.direction[i]) - apart.back().centre;
            squared_distance[i] = std::min(squared_distance[i], dot(d, d));
            if (points.weight[i] * squared_distance[i] > max) max = points.weight[i] * squared_distance[i], next = i;
        }
        apart.push_back({to_double(points.direction[next]), k_bandwidth_apart});
    }
    starts.push_back(std::move(apart));
    return starts;
}

}  // namespace

ViewFit fit_view(ViewProblem& problem, const ViewRows& rows, const std::vector<ViewLobe>& start) {
    return optimise(problem, rows, start, k_steps);
}

ViewFit fit_view_from_scratch(ViewProblem& problem, const ViewRows& rows, std::size_t lobes, std::mt19937_64& random) {
    const WeightedDirections points = weighted_directions(rows);
    ViewFit best;
    for (const auto& start : initial_lobes(points, lobes)) {
        ViewFit fit = optimise(problem, rows, start, k_steps_from_scratch);
        if (fit.loss < best.loss) best = std::move(fit);
    }
    for (int perturbation = 0; perturbation < k_view_perturbations; ++perturbation) {
        problem.loss(problem.start(rows, best.lobes));
        const std::vector<double> cost = problem.cost_of_dropping();
        std::vector<ViewLobe> next = best.lobes;
        ViewLobe& cheapest = next[std::size_t(std::min_element(cost.begin(), cost.end()) - cost.begin())];
        const double u1 = uniform(random), u2 = uniform(random);
        cheapest = {to_double(points.direction[std::size_t(u1 * double(points.direction.size()))]),
                    k_min_random_bandwidth * elementary::pow(k_random_bandwidths, u2)};
        ViewFit fit = optimise(problem, rows, next, k_steps_after_perturbation);
        if (fit.loss < best.loss) best = std::move(fit);
    }
    return best;
}

std::vector<ViewLobe> rotate_lobes(std::vector<ViewLobe> lobes, Vec3f view, Vec3f other) {
    const double angle =
        elementary::atan2(double(other.y), double(other.x)) - elementary::atan2(double(view.y), double(view.x));
    const double cosine = elementary::cos(angle), sine = elementary::sin(angle);
    for (ViewLobe& lobe : lobes) lobe.centre = Kernel<double>::turned(lobe.centre, cosine, sine);
    return lobes;
}

ViewFit fit_coefficients(ViewProblem& problem, const ViewRows& rows, const std::vector<ViewLobe>& lobes) {
    const double loss = problem.loss(problem.start(rows, lobes));
    return {lobes, loss, Stop::decrease, problem.coefficients()};
}

}  // namespace
