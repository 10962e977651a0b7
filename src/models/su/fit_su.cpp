#include "models/su/fit_su.h"
#include "base/errors.h"
#include "base/parallel.h"
#include "base/reporter.h"
#include "models/su/fit_view.h"
#include "models/su/sampled_views.h"
#include "models/su/su_functions.h"
#include "observe/pair_weights.h"

namespace SRBF_NAMESPACE {
namespace {

/// Number of consecutive views in a chain: each view is fitted from the previous one, the first from scratch.
constexpr std::size_t k_chain = 32;
/// A view is also fitted from scratch if its loss exceeds k_much_worse times its predecessor's plus k_exact_loss.
constexpr double k_much_worse = 4, k_exact_loss = 1e-9;

Result<Done> validate(const RawMatrix& matrix, const SuFitOptions& options, double theta_max) {
    const auto in_range = require_range<double>;
    const std::size_t n = matrix.direction.size();
    for (const auto& result : {in_range("fit", "number of lobes", options.lobes, 1, k_max_view_lobes),
                               in_range("fit", "number of neighbours", options.neighbours, 1, k_max_neighbours),
                               in_range("fit", "number of threads", options.threads, 0, 1024),
                               in_range("fit", "max_theta", theta_max / k_degree, 1 - 1e-9, 89.9 + 1e-9),
                               in_range("fit", "number of directions", double(n), k_min_views, k_max_views)})
        if (!result) return result.error();
    if (matrix.f.size() != n * n || matrix.between.size() % n != 0)
        return Error{"fit", {}, "matrix", "values of all pairs of directions", "another number"};
    return Done{};
}

/// Consecutive views, without `end`.
struct ViewChain {
    std::size_t begin, end;
};

/// The stages of the fit of all views, on the threads of the caller's `on_threads`.
struct ViewByViewFit {
    const SampledViews& views;
    const SuFitOptions& options;
    Reporter& reporter;
    std::size_t lobes = std::size_t(options.lobes);
    std::vector<ViewFit> fits = std::vector<ViewFit>(views.count());

    /// Calls body(problem, chain) for each chain of views.
    template <typename Body> void for_each_chain(std::string_view stage, const Body& body) {
        parallel_for_chunks(views.count(), k_chain, [&](std::size_t begin, std::size_t end) {
            if (reporter.cancelled()) return;
            ViewProblem problem(options.lobes);
            body(problem, ViewChain{begin, end});
            reporter.advance(stage, double(end - begin));
        });
    }

    /// Fits each view from the previous one of its chain, or from scratch if there is none or the result is poor.
    void fit_views() {
        for_each_chain("fitting views", [&](ViewProblem& problem, ViewChain chain) {
            std::seed_seq seeds{std::uint32_t(options.seed), std::uint32_t(options.seed >> 32),
                                std::uint32_t(chain.begin)};
            std::mt19937_64 random(seeds);
            std::optional<std::size_t> last;  // the previous view with data
            for (std::size_t i = chain.begin; i < chain.end; ++i) {
                const ViewRows& rows = views.rows(i);
                if (!(rows.scale > 0)) continue;
                if (last)
                    fits[i] = fit_view(problem, rows,
                                       rotate_lobes(fits[*last].lobes, views.direction(*last), views.direction(i)));
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
        for (std::size_t j = 0; j < fit.coefficient.size(); ++j) {  // there are none if the fit was cancelled
            const std::size_t k = i * lobes + j;
            store_coefficient(model, k, fit.coefficient[j]);
            model.centre[k] = to_float(fit.lobes[j].centre);
            model.bandwidth[k] = float(fit.lobes[j].bandwidth);
        }
    }
    static void store_coefficient(SuModel& model, std::size_t k, const std::array<double, 3>& beta) {
        for (int c = 0; c < 3; ++c) model.coefficient[k][c] = float(beta[std::size_t(c)]);
    }
    /// Solves for the coefficients again, with the model's rounded lobes.
    void refit_coefficients(SuModel& model) {
        for_each_chain("rounding", [&](ViewProblem& problem, ViewChain chain) {
            for (std::size_t i = chain.begin; i < chain.end; ++i) {
                if (fits[i].is_empty()) continue;
                std::vector<ViewLobe> stored;
                for (std::size_t k = i * lobes; k < (i + 1) * lobes; ++k)
                    stored.push_back({to_double(model.centre[k]), double(model.bandwidth[k])});
                const auto beta = fit_coefficients(problem, views.rows(i), stored).coefficient;
                for (std::size_t j = 0; j < lobes; ++j) store_coefficient(model, i * lobes + j, beta[j]);
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

/// Returns an error unless each view has no data or enough for the lobes.
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
        ViewByViewFit fit{views, options, reporter};
        result->unrounded = black_views(matrix, options);
        fit.fit_views();
        fit.store(result->unrounded);
        result->model = rounded(result->unrounded);
        fit.refit_coefficients(result->model);
        result->model = rounded(result->model);
        for (const ViewFit& view : fit.fits) {
            result->empty += view.is_empty();
            if (view.stop == Stop::iterations) result->stop = StopReason::iterations;
        }
    });
    if (result && reporter.cancelled()) result->stop = StopReason::cancelled;
    return result;
}

}  // namespace
