#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

#include "base/errors.h"
#include "base/parallel.h"
#include "base/reporter.h"
#include "models/su/fit_su.h"
#include "models/su/fit_view.h"
#include "models/su/sampled_views.h"
#include "models/su/su_functions.h"
#include "observe/pair_weights.h"

namespace srbf {
namespace {

/// Number of consecutive views that are fitted one from the other; the first of them starts from nothing.
constexpr std::size_t k_chain = 32;
/// A view starts from nothing if its loss exceeds its predecessor's by far, and what exact fits have, too.
constexpr double k_much_worse = 4, k_exact_loss = 1e-9;

Result<Done> validate(const RawMatrix& matrix, const SuFitOptions& options, double theta_max) {
    const auto in_range = require_range<double>;
    const std::size_t n = matrix.direction.size();
    for (const auto& result : {in_range("fit", "number of lobes", options.lobes, 1, k_most_view_lobes),
                               in_range("fit", "number of neighbours", options.neighbours, 1, k_most_neighbours),
                               in_range("fit", "number of threads", options.threads, 0, 1024),
                               in_range("fit", "max_theta", theta_max / k_degree, 1 - 1e-9, 89.9 + 1e-9),
                               in_range("fit", "number of directions", double(n), k_least_views, k_most_views)})
        if (!result) return result.error();
    if (matrix.f.size() != n * n || matrix.between.size() % n != 0)
        return Error{"fit", {}, "matrix", "values of all pairs of directions", "another number"};
    return Done{};
}

/// Consecutive views, from `begin` to before `end`.
struct Chain {
    std::size_t begin, end;
};

/// The fit of all views, on the threads of the caller's `on_threads`: its stages, in the order in which they follow.
struct ViewByView {
    const SampledViews& views;
    const SuFitOptions& options;
    Reporter& reporter;
    std::size_t lobes = std::size_t(options.lobes);
    std::vector<ViewFit> fits = std::vector<ViewFit>(views.count());

    /// Calls body(problem, chain) for each chain of views, with working memory.
    template <typename Body> void each_chain(std::string_view stage, const Body& body) {
        parallel_for_parts(views.count(), k_chain, [&](std::size_t begin, std::size_t end) {
            if (reporter.cancelled()) return;
            ViewProblem problem(options.lobes);
            body(problem, Chain{begin, end});
            reporter.advance(stage, double(end - begin));
        });
    }

    /// The fit of view i from the lobes of another view.
    ViewFit from_view(ViewProblem& problem, std::size_t i, std::size_t from,
                      const std::vector<ViewLobe>& its_lobes) const {
        return fit_view(problem, views.rows(i), rotated(its_lobes, views.direction(from), views.direction(i)));
    }

    /// Each view from the previous one of its chain, and from scratch where there is none or that leads nowhere.
    void fit_views() {
        each_chain("fitting views", [&](ViewProblem& problem, Chain chain) {
            std::seed_seq seeds{std::uint32_t(options.seed), std::uint32_t(options.seed >> 32),
                                std::uint32_t(chain.begin)};
            std::mt19937_64 random(seeds);
            std::optional<std::size_t> last;  // view with data
            for (std::size_t i = chain.begin; i < chain.end; ++i) {
                const ViewRows& rows = views.rows(i);
                if (!(rows.scale > 0)) continue;
                if (last) fits[i] = from_view(problem, i, *last, fits[*last].lobes);
                if (!last || fits[i].loss > k_much_worse * fits[*last].loss + k_exact_loss) {
                    ViewFit fit = fit_view_from_scratch(problem, rows, lobes, random);
                    if (fit.loss < fits[i].loss) fits[i] = std::move(fit);
                }
                last = i;
            }
        });
    }

    void store(SuModel& model) const {
        for (std::size_t i = 0; i < fits.size(); ++i) store(model, i, fits[i]);
    }
    void store(SuModel& model, std::size_t i, const ViewFit& fit) const {
        for (std::size_t j = 0; j < fit.coefficient.size(); ++j) {  // none if cancelled
            const std::size_t k = i * lobes + j;
            store_coefficient(model, k, fit.coefficient[j]);
            model.centre[k] = to_float(fit.lobes[j].centre);
            model.bandwidth[k] = float(fit.lobes[j].bandwidth);
        }
    }
    static void store_coefficient(SuModel& model, std::size_t k, const std::array<double, 3>& beta) {
        for (int c = 0; c < 3; ++c) model.coefficient[k][c] = float(beta[std::size_t(c)]);
    }
    /// The coefficients again, for the lobes of the model, which were rounded.
    void solve_again(SuModel& model) {
        each_chain("rounding", [&](ViewProblem& problem, Chain chain) {
            for (std::size_t i = chain.begin; i < chain.end; ++i) {
                if (fits[i].is_empty()) continue;
                std::vector<ViewLobe> stored;
                for (std::size_t k = i * lobes; k < (i + 1) * lobes; ++k)
                    stored.push_back({to_double(model.centre[k]), double(model.bandwidth[k])});
                const auto again = fit_coefficients(problem, views.rows(i), stored).coefficient;
                for (std::size_t j = 0; j < lobes; ++j) store_coefficient(model, i * lobes + j, again[j]);
            }
        });
    }
};

/// A model of the sampled directions with coefficients of 0.
SuModel black_views(const RawMatrix& matrix, const SuFitOptions& options) {
    const std::size_t n = matrix.direction.size() * std::size_t(options.lobes);
    SuModel model;
    model.discretise = matrix.discretise;
    model.interpolation = options.interpolation;
    model.neighbours = options.neighbours;
    model.lobes = options.lobes;
    model.direction = matrix.direction;
    model.coefficient.assign(n, {});
    model.centre.assign(n, {0, 0, 1});
    model.bandwidth.assign(n, 0.f);
    return model;
}

/// True if each view has no data, or enough for the lobes.
Result<Done> check_data(const SampledViews& views, Discretise discretise, int lobes) {
    for (std::size_t i = 0; i < views.count(); ++i)
        if (const std::size_t valid = views.valid(i); valid > 0 && valid < std::size_t(lobes))
            return Error{"fit",
                         {},
                         fmt::format("directions with data in sampled {} {}", name(discretise), i),
                         fmt::format("none or at least {}, the number of lobes", lobes),
                         fmt::format("{}", valid)};
    return Done{};
}

}  // namespace

Result<SuFit> fit_su(const RawMatrix& matrix, const SuFitOptions& options, const ProgressToken& progress) {
    const StandardArithmetic mode;
    const double theta_max = options.max_theta == 0 ? default_max_theta(options.objective) : options.max_theta;
    if (const auto valid = validate(matrix, options, theta_max); !valid) return valid.error();
    Reporter reporter(progress, 2 * double(matrix.direction.size()));  // each view is fitted and rounded
    Result<SuFit> result = SuFit{};
    on_threads(options.threads, [&] {
        const SampledViews views(matrix, options.objective, theta_max);
        if (const auto enough = check_data(views, matrix.discretise, options.lobes); !enough) {
            result = enough.error();
            return;
        }
        ViewByView all{views, options, reporter};
        result->unrounded = black_views(matrix, options);
        all.fit_views();
        all.store(result->unrounded);
        // The nonlinear parameters are rounded, then the coefficients are solved again.
        result->model = rounded(result->unrounded);
        all.solve_again(result->model);
        result->model = rounded(result->model);
        for (const ViewFit& fit : all.fits) {
            result->empty += fit.is_empty();
            if (fit.stop == Stop::iterations) result->stop = StopReason::iterations;
        }
    });
    if (result && reporter.cancelled()) result->stop = StopReason::cancelled;
    return result;
}

}  // namespace srbf
