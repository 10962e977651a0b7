#include "srbf/fit_map.h"

#include <cmath>
#include <numeric>

#include "base/errors.h"
#include "base/floating_point.h"
#include "base/half.h"
#include "base/levenberg_marquardt.h"
#include "base/parallel.h"
#include "base/reporter.h"
#include "errors/picture_errors.h"
#include "extras/maps/shared_problem.h"
#include "models/model_files.h"
#include "models/pm/search/search.h"
#include "models/pm/search/subsets.h"
#include "models/pm/solve/rounding.h"
#include "samples/observe_samples.h"
#include "srbf/convert.h"
#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {
namespace {

/// Number of groups in which lobes are added, of steps after each group, and of steps after the last.
constexpr int k_groups = 16, k_group_steps = 4, k_last_steps = 16;
/// Rounds in which rows are weighted for the current lobes, and the steps of the lobes in each round.
constexpr int k_refinements = 3, k_refinement_steps = 6;
/// Number of searches for the lobes of texels: for a map of GGX lobes, a single search could end far from the others
/// (docs/shared_lobes.md).
constexpr std::size_t k_searches = 3;
/// Number of values of a gap-filled texel.
constexpr std::size_t k_gap_filled_pairs_of_texel = 4096;
/// The largest coefficient of each lobe. Others may be 10⁶ times smaller and still be normal 16-bit floats; those of
/// later texels may be a thousand times larger.
constexpr double k_largest_coefficient = 64;
constexpr double k_none = -std::numeric_limits<double>::infinity();

using Observed = std::vector<std::shared_ptr<const Observations>>;

Result<Done> check_options(const MapOptions& options) {
    for (const auto& result : {require_range("fit_map", "number of lobes", options.lobes, 1, k_max_map_lobes),
                               require_range("fit_map", "number of variates", options.variates, 1, int(k_max_variates)),
                               require_range("fit_map", "number of threads", options.threads, 0, 1024)})
        if (!result) return result.error();
    if (is_reciprocal(options.form))
        return argument_error("fit_map", "form", "one that is not reciprocal", std::string(name(options.form)));
    return Done{};
}

/// The options of a fit to one material with the same kind of lobes.
PmFitOptions lobe_options(const MapOptions& options) {
    PmFitOptions pm_options;
    pm_options.form = options.form;
    pm_options.axial = options.axial;
    pm_options.lobes = options.lobes;
    pm_options.variates = options.variates;
    pm_options.seed = options.seed;
    pm_options.threads = options.threads;
    return pm_options;
}

void optimise(SharedProblem& problem, Eigen::VectorXd& x, int steps) {
    levenberg_marquardt(problem, x, {.max_iterations = steps, .adapts_to_bounds = true});
}

/// Finds the lobes that materials with these rows share.
Lobes search_for_lobes(std::span<const std::unique_ptr<PackedObservations>> rows, const MapOptions& options,
                       Reporter& reporter) {
    const LobeShape shape = shape_of(lobe_options(options));
    std::mt19937_64 random = generator(options.seed, 0, 0);
    Lobes lobes = initial_parameterizations(shape, 0, random);
    SharedProblem problem(rows, shape);
    const int group = std::max(1, options.lobes / k_groups);
    while (lobes.count() < options.lobes && !reporter.cancelled()) {
        const int end = std::min(lobes.count() + group, options.lobes), begin = lobes.count();
        while (lobes.count() < end) {
            problem.loss(pack(lobes));
            if (lobes.count() == begin) problem.weigh();
            const auto additions = random_candidates(random, lobes, k_additions);
            lobes = with_lobe(std::move(lobes), problem.best_addition(additions));
        }
        Eigen::VectorXd x = pack(lobes);
        optimise(problem, x, end < options.lobes ? k_group_steps : k_last_steps);
        lobes = unpack(x, shape);
        reporter.advance("searching for shared lobes", double(end - begin));
    }
    return lobes;
}

/// The rows of one material with all terms of its objective, weighted for these lobes.
std::unique_ptr<PackedObservations> pack_for_map(const Observations& observations, const Lobes& lobes) {
    Subsets subsets(observations);
    Candidate candidate;
    candidate.lobes = lobes;
    subsets.add_exceeded_pairs({candidate}, lobes.shape);
    const double importance = observations.views.empty() ? 0 : subsets.picture_importance(candidate);
    return std::make_unique<PackedObservations>(subsets.rows(RowSet::selection, {.pictures = importance}));
}

/// Lets lobes follow all terms of the materials' objectives.
Lobes refine(Lobes lobes, const Observed& observed, Reporter& reporter) {
    for (int round = 0; round < k_refinements && !reporter.cancelled(); ++round) {
        std::vector<std::unique_ptr<PackedObservations>> rows(observed.size());
        parallel_for(rows.size(), [&](std::size_t t) { rows[t] = pack_for_map(*observed[t], lobes); });
        SharedProblem problem(rows, lobes.shape);
        Eigen::VectorXd x = pack(lobes);
        problem.loss(x);
        problem.weigh();
        optimise(problem, x, k_refinement_steps);
        lobes = unpack(x, lobes.shape);
        reporter.advance("refining the shared lobes", double(observed.size()) / k_refinements);
    }
    return lobes;
}

/// The lobes with their stored precision, as a model with coefficients and scales 1.
PmModel basis_model(const Lobes& lobes) {
    PmModel model = to_halves(without_coefficients(lobes), lobes);
    model.coefficient.assign(std::size_t(model.lobes), {1, 1, 1});
    return model;
}

/// The logarithms of a material's coefficients for lobes with peak 1, lobes × 3; −∞ for a coefficient of 0.
Eigen::MatrixXd log_coefficients(const Observations& observations, const Lobes& lobes) {
    const auto rows = pack_for_map(observations, lobes);
    LobeProblem problem(*rows, lobes.shape, false);
    problem.loss(pack(lobes));
    Eigen::MatrixXd log_beta = Eigen::MatrixXd::Constant(lobes.count(), 3, k_none);
    for (int j = 0; j < lobes.count(); ++j) {
        const double factor = problem.log_unit(lobes, j);
        for (int c = 0; c < 3; ++c)
            if (const double beta = problem.beta()(j, c); beta > 1e-30) log_beta(j, c) = elementary::log(beta) + factor;
    }
    return log_beta;
}

/// The map of these materials in a row, without errors; empty if cancelled.
TexelMap map_of(const Observed& observed, const MapOptions& options, Reporter& reporter) {
    TexelMap map;
    on_threads(options.threads, [&] {
        std::vector<std::unique_ptr<PackedObservations>> rows;
        for (const auto& observations : observed)
            rows.push_back(std::make_unique<PackedObservations>(Subsets(*observations).rows(RowSet::search, {})));
        Lobes lobes = search_for_lobes(rows, options, reporter);
        lobes = refine(std::move(lobes), observed, reporter);
        map.basis = basis_model(lobes);
    });
    if (reporter.cancelled()) return {};
    const Lobes lobes = to_lobes(map.basis, shape_of(lobe_options(options)));
    std::vector<Eigen::MatrixXd> log_beta(observed.size());
    parallel_for(observed.size(), options.threads, [&](std::size_t t) {
        log_beta[t] = log_coefficients(*observed[t], lobes);
        reporter.advance("solving for coefficients", 0.5);
    });
    for (int j = 0; j < map.basis.lobes; ++j) {
        double largest = k_none;
        for (const auto& logarithms : log_beta) largest = std::max(largest, logarithms.row(j).maxCoeff());
        if (std::isfinite(largest))
            map.basis.log_scale[std::size_t(j)] =
                round_to_half(float(largest - elementary::log(k_largest_coefficient)));
    }
    for (const auto& logarithms : log_beta)
        for (int j = 0; j < map.basis.lobes; ++j) {
            Rgb& beta = map.coefficient.emplace_back();
            for (int c = 0; c < 3; ++c)
                beta[c] = float(
                    elementary::exp(std::min(logarithms(j, c) - double(map.basis.log_scale[std::size_t(j)]), 11.0)));
        }
    map.width = observed.size();
    map.error.assign(observed.size(), 0.f);
    return rounded(std::move(map));
}

}  // namespace

Result<TexelMap> fit_map(std::span<const Measured> materials, const MapOptions& options,
                         const ProgressToken& progress) {
    const StandardArithmetic mode;
    if (const auto valid = check_options(options); !valid) return valid.error();
    if (materials.empty()) return argument_error("fit_map", "materials", "at least 1", "0");
    for (const Measured& given : materials)
        if (std::holds_alternative<ScatteredSamples>(given.table) || std::holds_alternative<BsdfTable>(given.table))
            return Error{
                given.source,         {}, "input", "a table of one side", "samples, or reflection and transmission",
                ErrorCode::wrong_kind};
    Reporter reporter(progress, double(options.lobes) + 3 * double(materials.size()));
    Observed observed(materials.size());
    std::vector<std::optional<Error>> errors(materials.size());
    parallel_for(materials.size(), options.threads, [&](std::size_t t) {
        if (reporter.cancelled()) return;
        auto observations = observe(signed_evaluator(materials[t]),
                                    {.max_theta = options.max_theta, .seed = options.seed, .threads = 1});
        if (!observations) return void(errors[t] = observations.error());
        observed[t] = std::make_shared<const Observations>(*std::move(observations));
        reporter.advance("observing", 1);
    });
    for (const auto& error : errors)
        if (error) return *error;
    if (reporter.cancelled()) return cancelled_error("fit_map");
    TexelMap map = map_of(observed, options, reporter);
    if (reporter.cancelled()) return cancelled_error("fit_map");
    parallel_for(materials.size(), options.threads, [&](std::size_t t) {
        const Model model = texel(map, t);
        const Evaluate fitted = evaluator(model);
        const auto picture_errors =
            compare_pictures(evaluator(materials[t]), {&fitted, 1},
                             {.threads = 1, .is_isotropic = is_isotropic(materials[t]) && is_isotropic(model)});
        map.error[t] = round_to_half(float(std::min(picture_errors[0].mean.delta_e, double(k_half_max))));
        reporter.advance("measuring errors", 0.5);
    });
    return map;
}

Result<TexelMap> fit_map(const SharedPairs& pairs, std::span<const Rgb> f, const MapOptions& options,
                         const ProgressToken& progress) {
    const StandardArithmetic mode;
    if (const auto valid = check_options(options); !valid) return valid.error();
    const std::size_t M = pairs.wl.size(), T = M > 0 ? f.size() / M : 0;
    Reporter reporter(progress, k_searches * (double(options.lobes) + 1.5 * double(T)) + double(T));
    Observed observed(T);
    parallel_for(T, options.threads, [&](std::size_t t) {
        if (reporter.cancelled()) return;
        ScatteredSamples samples = valid_samples(pairs.wl, pairs.wv, f.subspan(t * M, M), pairs.isotropic);
        if (samples.wl.empty()) return;
        make_index(samples);
        ObserveSamplesOptions observing{
            Objective::appearance, options.max_theta > 0 ? options.max_theta : default_max_theta(Objective::appearance),
            options.seed};
        observing.threads = 1, observing.only_gap_filled = k_gap_filled_pairs_of_texel;
        if (auto observations = observe(samples, observing))
            observed[t] = std::make_shared<const Observations>(std::move(observations->gap_filled_table));
        reporter.advance("observing", 1);
    });
    std::erase_if(observed, [](const auto& observations) { return !observations; });
    if (reporter.cancelled()) return cancelled_error("fit_map");
    if (observed.empty()) return no_data_error("fit_map", "texels with values above 0");
    TexelMap best;
    double min = 0;
    for (std::uint64_t search = 0; search < k_searches; ++search) {
        MapOptions search_options = options;
        search_options.seed = k_searches * options.seed + search;
        TexelMap map = map_of(observed, search_options, reporter);
        if (reporter.cancelled()) return cancelled_error("fit_map");
        const std::vector<float> errors = coefficients_of_texels(map, pairs, f, options.threads).error;
        const double error = std::accumulate(errors.begin(), errors.end(), 0.0);
        if (search == 0 || error < min) {
            min = error;
            best = std::move(map);
        }
    }
    return best;
}

}  // namespace
