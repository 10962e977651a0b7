#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "fit/objective.h"
#include "fit/sampled_views.h"
#include "fit/search.h"
#include "fit/view_in_pictures.h"
#include "fit/vmf_clusters.h"
#include "least_squares.h"
#include "parallel.h"
#include "srbf/half.h"
#include "srbf/kernel.h"

namespace srbf {
namespace {

constexpr std::size_t k_chain =
    32;  ///< number of consecutive views that are fitted one from the other; the first of them starts from clusterings
constexpr int k_first_steps = 40, k_steps = 15, k_perturbation_steps = 12;
constexpr int k_view_perturbations = 8;
/// Steps with the pixels of a view, of all variables and of rounded lobes' coefficients; and what the pixels cost at
/// first, relative to the rest of the loss.
constexpr int k_picture_steps = 4, k_coefficient_steps = 3;
constexpr double k_picture_importance = 8;
/// A view adopts the lobes of a neighbour whose loss is below this fraction of its own; it starts from clusterings if
/// its loss exceeds the neighbour's by far.
constexpr double k_better = 0.97, k_much_worse = 4;
/// Passes of trying neighbours' lobes, down and up in turn: with pictures, in which rings would show, and without. And
/// their work beside fitting all views once: later passes have little to try.
constexpr std::size_t k_picture_passes = 8, k_passes = 2;
constexpr double k_work_of_passes = 0.3;

/// State of the fit of a view.
struct ViewFit {
    std::vector<ViewLobe> lobes;
    double loss = std::numeric_limits<double>::infinity();
    Stop stop = Stop::decrease;
    std::size_t news_until = 2;  ///< neighbours try these lobes in passes before this one: once down and once up
    bool is_empty() const { return lobes.empty(); }
};

ViewFit optimised(ViewProblem& problem, const ViewRows& rows, const std::vector<ViewLobe>& start, int steps) {
    LevenbergMarquardtOptions options;
    options.max_iterations = steps;
    options.decrease_tolerance = 1e-4;
    Eigen::VectorXd x = problem.start(rows, start);
    const auto summary = levenberg_marquardt(problem, x, options);
    return {problem.lobes(x), summary.loss, summary.stop};
}

/// Makes the lobes x, of which `problem` has just computed the loss, match the view's pixels as well, or only their
/// coefficients. Returns the lobes; `problem` has the coefficients.
std::vector<ViewLobe> matched(ViewProblem& problem, const Eigen::VectorXd& start, double loss, bool keep_lobes) {
    LevenbergMarquardtOptions options;
    options.max_iterations = keep_lobes ? k_coefficient_steps : k_picture_steps;
    options.decrease_tolerance = 1e-4;
    ViewInPictures seen(problem);
    Eigen::VectorXd x = seen.start(start, loss, k_picture_importance, keep_lobes);
    levenberg_marquardt(seen, x, options);
    return problem.lobes(x.head(start.size()));
}

/// Lobes of the sampled direction `from` as those of `to`, for a BRDF that is invariant under rotation of both
/// directions.
std::vector<ViewLobe> rotated(std::vector<ViewLobe> lobes, Vec3f from, Vec3f to) {
    const double angle = std::atan2(double(to.y), double(to.x)) - std::atan2(double(from.y), double(from.x));
    for (ViewLobe& lobe : lobes) lobe.centre = Kernel<double>::turned(lobe.centre, std::cos(angle), std::sin(angle));
    return lobes;
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
            lobes.push_back({points.brightest, std::min(0.5 * std::pow(factor, double(j)), 5e4)});
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

/// The best of the fits from clusterings of the view's values, improved by repeatedly dropping the least useful lobe
/// and adding a random one.
ViewFit from_nothing(ViewProblem& problem, const ViewRows& rows, std::size_t J, std::mt19937_64& random) {
    const Weighted points = weighted(rows);
    ViewFit best;
    for (const auto& start : beginnings(points, J))
        for (const int rounds : {0, 8}) {
            ViewFit fit =
                optimised(problem, rows, vmf_clusters(points.direction, points.weight, start, rounds), k_first_steps);
            if (fit.loss < best.loss) best = std::move(fit);
        }
    for (int perturbation = 0; perturbation < k_view_perturbations; ++perturbation) {
        problem.loss(problem.start(rows, best.lobes));
        const std::vector<double> cost = problem.cost_of_dropping();
        std::vector<ViewLobe> next = best.lobes;
        ViewLobe& least = next[std::size_t(std::min_element(cost.begin(), cost.end()) - cost.begin())];
        const double pick = uniform(random), size = uniform(random);
        least = {to_double(points.direction[std::size_t(pick * double(points.direction.size()))]),
                 0.3 * std::pow(1e5, size)};
        ViewFit fit = optimised(problem, rows, next, k_perturbation_steps);
        if (fit.loss < best.loss) best = std::move(fit);
    }
    return best;
}

Result<Done> validate(const RawMatrix& matrix, const SuFitOptions& options, double theta_max) {
    const auto in_range = [](const char* what, double x, double least, double most) -> Result<Done> {
        if (x >= least && x <= most) return Done{};
        return Error{"fit", {}, what, fmt::format("{} to {}", least, most), fmt::format("{}", x), ErrorCode::argument};
    };
    const std::size_t n = matrix.direction.size();
    for (const auto& result : {in_range("number of lobes", options.lobes, 1, k_most_view_lobes),
                               in_range("number of neighbours", options.neighbours, 1, k_most_neighbours),
                               in_range("number of threads", options.threads, 0, 1024),
                               in_range("max_theta", theta_max / k_degree, 1 - 1e-9, 89.9 + 1e-9),
                               in_range("number of directions", double(n), k_least_views, k_most_views)})
        if (!result) return result.error();
    if (matrix.f.size() != n * n || matrix.between.size() % n != 0)
        return Error{"fit", {}, "matrix", "values of all pairs of directions", "another number"};
    return Done{};
}

}  // namespace

Result<SuFit> fit_su(const RawMatrix& matrix, const SuFitOptions& options, const ProgressToken& progress) {
    const FlushSubnormals mode;
    const double theta_max = options.max_theta == 0 ? default_max_theta(options.objective) : options.max_theta;
    if (const auto valid = validate(matrix, options, theta_max); !valid) return valid.error();
    const std::size_t n = matrix.direction.size(), J = std::size_t(options.lobes), chains = (n + k_chain - 1) / k_chain;
    Reporter reporter(progress, (3 + k_work_of_passes) * double(n));
    SuFit result;
    result.unrounded.discretise = matrix.discretise;
    result.unrounded.interpolation = options.interpolation;
    result.unrounded.neighbours = options.neighbours;
    result.unrounded.lobes = options.lobes;
    result.unrounded.direction = matrix.direction;
    result.unrounded.coefficient.assign(n * J, {});
    result.unrounded.centre.assign(n * J, {0, 0, 1});
    result.unrounded.bandwidth.assign(n * J, 0.f);
    const bool of_pictures = traits(options.objective).of_pictures;
    const bool shaped = options.shaped.value_or(of_pictures);
    if (shaped) result.unrounded.shape.assign(n * J, 0.f);
    std::optional<Error> error;

    on_threads(options.threads, [&] {
        const SampledViews views(matrix, options.objective, theta_max);
        for (std::size_t i = 0; i < n && !error; ++i)
            if (const std::size_t valid = views.valid(i); valid > 0 && valid < J)
                error = {"fit",
                         {},
                         fmt::format("directions with data in sampled {} {}", name(matrix.discretise), i),
                         fmt::format("none or at least {}, the number of lobes", J),
                         fmt::format("{}", valid)};
        if (error) return;

        std::vector<ViewFit> fits(n);
        const auto for_chains = [&](std::string_view stage, const auto& body, double work_of_view = 1) {
            parallel_for(chains, [&](std::size_t chain) {
                if (reporter.cancelled()) return;
                ViewProblem problem(options.lobes, shaped);
                const std::size_t begin = chain * k_chain, end = std::min(begin + k_chain, n);
                body(problem, begin, end);
                reporter.advance(stage, work_of_view * double(end - begin));
            });
        };
        for_chains("fitting views", [&](ViewProblem& problem, std::size_t begin, std::size_t end) {
            std::seed_seq seeds{std::uint32_t(options.seed), std::uint32_t(options.seed >> 32), std::uint32_t(begin)};
            std::mt19937_64 random(seeds);
            std::size_t last = n;  // the view to start from
            for (std::size_t i = begin; i < end; ++i) {
                const ViewRows rows = views.rows(i);
                if (!(rows.scale > 0)) continue;
                if (last < n)
                    fits[i] = optimised(problem, rows,
                                        rotated(fits[last].lobes, views.direction(last), views.direction(i)), k_steps);
                if (last == n || fits[i].loss > k_much_worse * fits[last].loss + 1e-9) {
                    ViewFit fit = from_nothing(problem, rows, J, random);
                    if (fit.loss < fits[i].loss) fits[i] = std::move(fit);
                }
                last = i;
            }
        });
        // Neighbouring views try each other's lobes, downwards and upwards in turn. Lobes pass from one chain to the
        // next once in a pass; from the third on only those are tried that have changed since.
        const std::size_t passes = of_pictures ? k_picture_passes : k_passes;
        for (std::size_t pass = 0; pass < passes; ++pass) {
            const bool down = pass % 2 == 0;
            const std::vector<ViewFit> before = fits;
            const auto try_neighbours = [&](ViewProblem& problem, std::size_t begin, std::size_t end) {
                for (std::size_t k = begin; k < end; ++k) {
                    const std::size_t i = down ? end - 1 - (k - begin) : k, from = down ? i + 1 : i - 1;
                    if (from >= n) continue;  // beyond the first or last view
                    const ViewFit& neighbour = from >= begin && from < end ? fits[from] : before[from];
                    if (pass >= neighbour.news_until) continue;
                    if (fits[i].is_empty() || neighbour.is_empty() || neighbour.loss > k_better * fits[i].loss)
                        continue;
                    const ViewRows rows = views.rows(i);
                    ViewFit fit = optimised(
                        problem, rows, rotated(neighbour.lobes, views.direction(from), views.direction(i)), k_steps);
                    // Tried at once, in the next pass the other way, and in the one after beyond the chain.
                    fit.news_until = pass + 3;
                    if (fit.loss < fits[i].loss) fits[i] = std::move(fit);
                }
            };
            for_chains("comparing views", try_neighbours, k_work_of_passes / double(passes));
        }

        // The coefficients for lobes; what the view's pixels see may change these too.
        const auto solve = [&](ViewProblem& problem, SuModel& model, std::size_t i, std::vector<ViewLobe> lobes,
                               bool keep_lobes) {
            const ViewRows rows = views.rows(i, of_pictures);
            const Eigen::VectorXd x = problem.start(rows, lobes);
            const double loss = problem.loss(x);
            if (rows.seen.pixels.count() > 0) lobes = matched(problem, x, loss, keep_lobes);
            for (std::size_t j = 0; j < J; ++j) {
                const std::size_t k = i * J + j;
                for (int c = 0; c < 3; ++c) model.coefficient[k][c] = float(problem.coefficient(int(j), c));
                if (keep_lobes) continue;
                model.centre[k] = to_float(lobes[j].centre);
                model.bandwidth[k] = float(lobes[j].bandwidth);
                if (shaped) model.shape[k] = float(lobes[j].shape);
            }
        };
        for_chains("finishing", [&](ViewProblem& problem, std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                if (!fits[i].is_empty()) solve(problem, result.unrounded, i, fits[i].lobes, false);
        });
        for (const ViewFit& fit : fits) {
            result.empty += fit.is_empty();
            if (fit.stop == Stop::iterations) result.stop = StopReason::iterations;
        }
        // The nonlinear parameters are rounded, then the coefficients are solved again.
        result.model = rounded(result.unrounded);
        for_chains("rounding", [&](ViewProblem& problem, std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                if (fits[i].is_empty()) continue;
                std::vector<ViewLobe> lobes;
                for (std::size_t k = i * J; k < (i + 1) * J; ++k)
                    lobes.push_back({to_double(result.model.centre[k]), double(result.model.bandwidth[k]),
                                     shaped ? double(result.model.shape[k]) : 0});
                solve(problem, result.model, i, std::move(lobes), true);
            }
        });
        result.model = rounded(result.model);
    });
    if (error) return *error;
    if (reporter.cancelled()) result.stop = StopReason::cancelled;
    return result;
}

}  // namespace srbf
