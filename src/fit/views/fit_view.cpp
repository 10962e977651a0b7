#include "fit/views/fit_view.h"

#include <algorithm>
#include <cmath>

#include "fit/views/view_in_pictures.h"
#include "fit/views/vmf_clusters.h"
#include "srbf/directions.h"
#include "srbf/elementary.h"
#include "srbf/kernel.h"

namespace srbf {
namespace {

constexpr int k_steps = 15, k_steps_from_scratch = 40, k_steps_after_perturbation = 12;
constexpr int k_view_perturbations = 8;
/// Steps with the pixels of a view, of all variables and of rounded lobes' coefficients; and what the pixels cost
/// relative to the rest of the loss, for the lobes that are best for that.
constexpr int k_picture_steps = 4, k_coefficient_steps = 3;
constexpr double k_picture_importance = 4;

/// A neighbour's lobe may be narrowed more than one of this view.
Eigen::VectorXd within_bounds(const ViewProblem& problem, const Eigen::VectorXd& x) {
    return x.cwiseMax(problem.lower(x));
}

ViewFit optimised(ViewProblem& problem, const ViewRows& rows, const std::vector<ViewLobe>& start, int steps) {
    LevenbergMarquardtOptions options;
    options.max_iterations = steps;
    options.decrease_tolerance = 1e-4;
    Eigen::VectorXd x = within_bounds(problem, problem.start(rows, start));
    const auto summary = levenberg_marquardt(problem, x, options);
    return {problem.lobes(x), summary.loss, summary.stop};
}

/// The rows of a view with positive weight, as input of clusterings.
struct Weighted {
    std::vector<Vec3f> direction;
    std::vector<double> weight;  ///< w f, summed over the channels
    Vec3d brightest;
};
Weighted weighted(const ViewRows& rows) {
    Weighted points;
    double most = -1;
    for (std::size_t i = 0; i < rows.root_weight.size(); ++i) {
        const double root = double(rows.root_weight[i]);
        if (!(root > 0)) continue;
        double value = 0;
        for (const auto& y : rows.y) value += double(y[i]) / root;
        points.direction.push_back({rows.directions.w[0][i], rows.directions.w[1][i], rows.directions.w[2][i]});
        points.weight.push_back(root * root * value);
        if (value > most) most = value, points.brightest = to_double(points.direction.back());
    }
    return points;
}

/// Initial positions of J lobes: of all sizes about the brightest direction, and at bright directions far apart from
/// each other.
std::vector<std::vector<ViewLobe>> beginnings(const Weighted& points, std::size_t J) {
    std::vector<std::vector<ViewLobe>> starts;
    for (const double factor : {3.0, 6.0, 30.0}) {
        std::vector<ViewLobe> lobes;
        for (std::size_t j = 0; j < J; ++j)
            lobes.push_back({points.brightest, std::min(0.5 * elementary::pow(factor, double(j)), 5e4)});
        starts.push_back(std::move(lobes));
    }
    std::vector<ViewLobe> apart{{points.brightest, 20}};
    std::vector<double> squared_distance(points.weight.size(), 4.0);
    while (apart.size() < J) {
        std::size_t next = 0;
        double most = -1;
        for (std::size_t i = 0; i < points.weight.size(); ++i) {
            const Vec3d d = to_double(points.direction[i]) - apart.back().centre;
            squared_distance[i] = std::min(squared_distance[i], dot(d, d));
            if (points.weight[i] * squared_distance[i] > most) most = points.weight[i] * squared_distance[i], next = i;
        }
        apart.push_back({to_double(points.direction[next]), 20});
    }
    starts.push_back(std::move(apart));
    return starts;
}

std::vector<std::array<double, 3>> coefficients(const ViewProblem& problem) {
    std::vector<std::array<double, 3>> of(std::size_t(problem.count()));
    for (std::size_t j = 0; j < of.size(); ++j)
        for (int c = 0; c < 3; ++c) of[j][std::size_t(c)] = problem.coefficient(int(j), c);
    return of;
}
/// From the lobes x, of which `problem` has just computed the loss. Has lobes unless these remain.
SeenFit seen_fit(ViewProblem& problem, const Eigen::VectorXd& x, double share, bool only_coefficients) {
    LevenbergMarquardtOptions options;
    options.max_iterations = only_coefficients ? k_coefficient_steps : k_picture_steps;
    options.decrease_tolerance = 1e-4;
    options.adapts_to_bounds = true;
    ViewInPictures seen(problem);
    Eigen::VectorXd all = seen.start(x, share, only_coefficients);
    const auto summary = levenberg_marquardt(seen, all, options);
    SeenFit fit{{{}, summary.loss, summary.stop}, coefficients(problem)};
    if (!only_coefficients) fit.lobes = problem.lobes(all.head(x.size()));
    return fit;
}

}  // namespace

ViewFit fit_view(ViewProblem& problem, const ViewRows& rows, const std::vector<ViewLobe>& start) {
    return optimised(problem, rows, start, k_steps);
}

ViewFit fit_view_from_scratch(ViewProblem& problem, const ViewRows& rows, std::size_t lobes, std::mt19937_64& random) {
    const Weighted points = weighted(rows);
    ViewFit best;
    for (const auto& start : beginnings(points, lobes))
        for (const int rounds : {0, 8}) {
            ViewFit fit = optimised(problem, rows, vmf_clusters(points.direction, points.weight, start, rounds),
                                    k_steps_from_scratch);
            if (fit.loss < best.loss) best = std::move(fit);
        }
    for (int perturbation = 0; perturbation < k_view_perturbations; ++perturbation) {
        problem.loss(problem.start(rows, best.lobes));
        const std::vector<double> cost = problem.cost_of_dropping();
        std::vector<ViewLobe> next = best.lobes;
        ViewLobe& least = next[std::size_t(std::min_element(cost.begin(), cost.end()) - cost.begin())];
        const double pick = uniform(random), size = uniform(random);
        least = {to_double(points.direction[std::size_t(pick * double(points.direction.size()))]),
                 0.3 * elementary::pow(1e5, size)};
        ViewFit fit = optimised(problem, rows, next, k_steps_after_perturbation);
        if (fit.loss < best.loss) best = std::move(fit);
    }
    return best;
}

std::vector<ViewLobe> rotated(std::vector<ViewLobe> lobes, Vec3f from, Vec3f to) {
    const double angle =
        elementary::atan2(double(to.y), double(to.x)) - elementary::atan2(double(from.y), double(from.x));
    for (ViewLobe& lobe : lobes)
        lobe.centre = Kernel<double>::turned(lobe.centre, elementary::cos(angle), elementary::sin(angle));
    return lobes;
}

std::vector<ViewLobe> moved(std::vector<ViewLobe> lobes, Vec3f from, Vec3f to) {
    lobes = rotated(std::move(lobes), from, to);
    const Vec3d tangent = Kernel<double>::tangent_across(to_double(to));
    const auto theta = [](Vec3f w) {
        return elementary::atan2(elementary::hypot(double(w.x), double(w.y)), double(w.z));
    };
    const double cosine = elementary::cos(theta(from) - theta(to)), sine = elementary::sin(theta(from) - theta(to));
    for (ViewLobe& lobe : lobes)
        lobe.centre = normalize(cosine * lobe.centre + sine * cross(tangent, lobe.centre) +
                                (1 - cosine) * dot(tangent, lobe.centre) * tangent);
    return lobes;
}

double pixel_share(ViewProblem& problem, const ViewRows& rows, const ViewFit& fit) {
    if (rows.seen.pixels.count() == 0) return 0;
    const Eigen::VectorXd x = problem.start(rows, fit.lobes);
    const double loss = problem.loss(x);
    return ViewInPictures(problem).share(x, loss, k_picture_importance);
}

SeenFit fit_seen(ViewProblem& problem, const ViewRows& rows, const std::vector<ViewLobe>& start, double share) {
    if (!(share > 0)) return fit_seen_coefficients(problem, rows, fit_view(problem, rows, start).lobes, 0);
    const Eigen::VectorXd x = within_bounds(problem, problem.start(rows, start));
    problem.loss(x);
    return seen_fit(problem, x, share, false);
}

SeenFit fit_seen_coefficients(ViewProblem& problem, const ViewRows& rows, const std::vector<ViewLobe>& lobes,
                              double share) {
    const Eigen::VectorXd x = problem.start(rows, lobes);
    const double loss = problem.loss(x);
    SeenFit fit = share > 0 ? seen_fit(problem, x, share, true) : SeenFit{{{}, loss}, coefficients(problem)};
    fit.lobes = lobes;
    return fit;
}

}  // namespace srbf
