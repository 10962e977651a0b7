#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "basis/active_lobes.h"
#include "basis/shared_problem.h"
#include "fit/data/errors.h"
#include "fit/data/observe_samples.h"
#include "fit/objective/objective.h"
#include "fit/options.h"
#include "fit/search/random_lobes.h"
#include "fit/search/subsets.h"
#include "fit/solve/least_squares.h"
#include "fit/solve/rounding.h"
#include "floating_point.h"
#include "parallel.h"
#include "reporter.h"
#include "srbf/basis.h"
#include "srbf/elementary.h"
#include "srbf/fit_samples.h"
#include "srbf/half.h"
#include "srbf/pictures.h"

namespace srbf {
namespace {

/// Groups in which lobes are added, steps after each, and after the last.
constexpr int k_basis_groups = 16, k_group_steps = 4, k_last_basis_steps = 16;
/// Rounds in which active lobes are chosen and all lobes follow, and steps of each.
constexpr int k_refinements = 3, k_refinement_steps = 6;
/// The largest coefficient of a lobe: others may be 10⁶ times smaller and are normal 16-bit floats, those of materials
/// that come later a thousand times larger.
constexpr double k_largest_coefficient = 64;
constexpr double k_none = -std::numeric_limits<double>::infinity();
/// Values of a completed texel, as many as `fit_batch` completes.
constexpr std::size_t k_completed_pairs = 4096;

constexpr Stage k_basis_stage{.name = "basis", .pairs = k_few, .albedos = true};
constexpr Stage k_active_stage{.name = "active", .pairs = k_some, .albedos = true};
constexpr Stage k_picture_stage{.name = "pictures", .pairs = k_some, .albedos = true, .pictures = true};

FitOptions lobe_options(const BasisOptions& of) {
    FitOptions options;
    options.form = of.form, options.axial = of.axial, options.lobes = of.lobes, options.variates = of.variates;
    options.seed = of.seed, options.threads = of.threads;
    return options;
}

Error basis_error(const char* what, std::string expected, std::string found) {
    return argument_error("fit_library", what, std::move(expected), std::move(found));
}

Result<Done> check_options(const BasisOptions& of) {
    for (const auto& result : {require_range("fit_library", "number of lobes", of.lobes, 1, k_most_basis_lobes),
                               require_range("fit_library", "number of variates", of.variates, 1, int(k_most_variates)),
                               require_range("fit_library", "number of active lobes", of.active, 0, of.lobes),
                               require_range("fit_library", "number of threads", of.threads, 0, 1024)})
        if (!result) return result.error();
    return Done{};
}

Result<Observations> observed_table(const Measured& measured, const BasisOptions& of) {
    return observe(signed_evaluator(measured), {.max_theta = of.max_theta, .seed = of.seed, .threads = 1});
}

Result<Measured> table_of(const LibrarySource& source) {
    auto measured = source.read();
    if (!measured) return measured;
    if (std::holds_alternative<ScatteredSamples>(measured->table) || std::holds_alternative<BsdfTable>(measured->table))
        return Error{
            source.name,          {}, "input", "a table of one side", "samples, or reflection and transmission",
            ErrorCode::wrong_kind};
    return measured;
}

void optimise(SharedProblem& problem, Eigen::VectorXd& x, int steps) {
    levenberg_marquardt(problem, x, {.max_iterations = steps, .adapts_to_bounds = true});
}

/// The lobes that materials with these rows share.
Lobes shared_lobes(std::span<SharedRows> materials, const BasisOptions& of, Reporter& reporter) {
    const LobeShape shape = shape_of(lobe_options(of));
    std::mt19937_64 random = generator(of.seed, 0, 0);
    Lobes lobes = without_lobes(shape, 0, random);
    SharedProblem problem(materials, shape, k_log_peak_limit);
    const int group = std::max(1, of.lobes / k_basis_groups);
    while (lobes.count() < of.lobes && !reporter.cancelled()) {
        const int until = std::min(lobes.count() + group, of.lobes), before = lobes.count();
        while (lobes.count() < until) {
            problem.loss(pack(lobes));
            if (lobes.count() == before) problem.weigh();
            lobes = with_lobe(std::move(lobes), problem.best_addition(random_candidates(random, lobes)));
            if (of.active > 0) problem.offer(std::size_t(lobes.count()) - 1);
        }
        Eigen::VectorXd x = pack(lobes);
        if (of.active > 0 && lobes.count() > of.active) {
            problem.loss(x);
            problem.activate(std::size_t(of.active));
        }
        optimise(problem, x, until < of.lobes ? k_group_steps : k_last_basis_steps);
        lobes = unpack(x, shape);
        reporter.advance("searching for shared lobes", double(until - before));
    }
    return lobes;
}

/// The lobes as they are stored.
Lobes rounded(const Lobes& lobes, const Rows& of_any) {
    LobeProblem problem(of_any, lobes.shape, false, k_log_peak_limit);
    problem.loss(pack(lobes));
    return to_lobes(to_halves(to_model(problem, lobes, true), lobes), lobes.shape);
}

/// The lobes of a material, and the logarithms of its coefficients of lobes of peak 1.
struct LogCoefficients {
    std::vector<std::size_t> lobe;
    Eigen::MatrixXd log_beta;  ///< lobes × 3; −∞ of 0
};

Lobes chosen_lobes(const Lobes& all, std::span<const std::size_t> which) {
    Lobes some{all.shape, all.angle, {}};
    for (const std::size_t j : which)
        some.weight.insert(some.weight.end(), all.of(int(j)).begin(), all.of(int(j)).end());
    return some;
}

LogCoefficients coefficients_in(const LobeProblem& problem, const Lobes& lobes, std::vector<std::size_t> which) {
    LogCoefficients of{std::move(which), Eigen::MatrixXd::Constant(lobes.count(), 3, k_none)};
    for (int j = 0; j < lobes.count(); ++j) {
        const double factor = elementary::log(problem.scale()) +
                              log_peak_factor(lobes.of(j), lobes.shape, problem.offset()[std::size_t(j)]);
        for (int c = 0; c < 3; ++c)
            if (const double beta = problem.beta()(j, c); beta > 1e-30)
                of.log_beta(j, c) = elementary::log(beta) + factor;
    }
    return of;
}

/// The rows of one material by all terms of its objective, weighed for these lobes.
std::unique_ptr<Rows> rows_of(const Observations& observations, const Lobes& lobes, const FitOptions& options) {
    Subsets subsets(observations);
    Candidate candidate;
    candidate.lobes = lobes;
    subsets.add_exceeded({candidate}, options, k_log_peak_limit);
    auto rows = std::make_unique<Rows>(subsets.rows(k_active_stage, 0));
    if (observations.views.empty()) return rows;
    LobeProblem by_pairs(*rows, lobes.shape, false, k_log_peak_limit);
    by_pairs.loss(pack(lobes));
    const PmModel fitted = to_model(by_pairs, lobes, true);
    subsets.add_lights(evaluator(fitted));
    const double importance = subsets.picture_importance(candidate, k_picture_stage, options, k_log_peak_limit);
    return std::make_unique<Rows>(subsets.rows(k_picture_stage, importance));
}

/// A material as a sum of at most so many of the lobes.
SharedRows material_of(const Observations& observations, const Lobes& all, const BasisOptions& of) {
    const FitOptions options = lobe_options(of);
    SharedRows material{rows_of(observations, all, options)};
    LobeProblem problem(*material.rows, all.shape, false, k_log_peak_limit);
    problem.loss(pack(all));
    material.lobes = active_lobes(problem, std::size_t(of.active > 0 ? of.active : all.count()));
    if (material.lobes.size() < std::size_t(all.count()))
        material.rows = rows_of(observations, chosen_lobes(all, material.lobes), options);
    return material;
}

/// The coefficients of one material, by all terms of its objective.
LogCoefficients coefficients_of(const Observations& observations, const Lobes& all, const BasisOptions& of) {
    SharedRows material = material_of(observations, all, of);
    const Lobes lobes = chosen_lobes(all, material.lobes);
    LobeProblem problem(*material.rows, all.shape, false, k_log_peak_limit);
    problem.loss(pack(lobes));
    return coefficients_in(problem, lobes, std::move(material.lobes));
}

/// Lets lobes follow all terms of the objectives of materials, each of which is a sum of its active ones.
Lobes refined(Lobes lobes, std::span<const LibrarySource> sources, const BasisOptions& of, Reporter& reporter) {
    for (int round = 0; round < k_refinements && !reporter.cancelled(); ++round) {
        std::vector<SharedRows> materials(sources.size());
        parallel_for(sources.size(), [&](std::size_t t) {
            if (const auto measured = table_of(sources[t]))
                if (const auto observations = observed_table(*measured, of))
                    materials[t] = material_of(*observations, lobes, of);
        });
        std::erase_if(materials, [](const SharedRows& material) { return !material.rows; });
        if (materials.empty()) break;
        SharedProblem problem(materials, lobes.shape, k_log_peak_limit);
        Eigen::VectorXd x = pack(lobes);
        problem.loss(x);
        problem.weigh();
        optimise(problem, x, k_refinement_steps);
        lobes = unpack(x, lobes.shape);
        reporter.advance("refining the shared lobes", double(sources.size()) / k_refinements);
    }
    return lobes;
}

/// Log scales for which the largest coefficient of each lobe is k_largest_coefficient.
void set_scales(PmModel& basis, std::span<const LogCoefficients> materials) {
    std::vector<double> largest(std::size_t(basis.lobes), k_none);
    for (const LogCoefficients& of : materials)
        for (std::size_t i = 0; i < of.lobe.size(); ++i)
            largest[of.lobe[i]] = std::max(largest[of.lobe[i]], of.log_beta.row(Eigen::Index(i)).maxCoeff());
    for (std::size_t j = 0; j < largest.size(); ++j)
        basis.log_scale[j] =
            std::isfinite(largest[j]) ? round_to_half(float(largest[j] - elementary::log(k_largest_coefficient))) : 0.f;
}

/// The lobes as a model with coefficients and scales 1.
PmModel basis_model(const Lobes& lobes) {
    const auto N = std::size_t(lobes.shape.variates), J = std::size_t(lobes.count()),
               C = std::size_t(lobes.shape.components());
    PmModel model;
    model.form = lobes.shape.form, model.axial = lobes.shape.axial, model.lobes = int(J), model.variates = int(N);
    model.coefficient.assign(J, {1, 1, 1}), model.log_scale.assign(J, 0);
    for (std::size_t j = 0; j < J; ++j) {
        const auto of = lobes.of(int(j));
        for (std::size_t n = 0; n < N; ++n) {
            const Vec3d p = vector_of(of, lobes.shape, int(n));
            const double bandwidth = elementary::hypot(p.x, p.y, p.z);
            model.bandwidth.push_back(float(bandwidth));
            model.centre.push_back(bandwidth > 0
                                       ? Vec3f{float(p.x / bandwidth), float(p.y / bandwidth), float(p.z / bandwidth)}
                                       : Vec3f{0, 0, 1});
        }
        for (std::size_t k = N * C; k < of.size(); ++k) model.exponent.push_back(float(of[k]));
    }
    for (const double angle : lobes.angle) model.parameterization.push_back(rounded_direction(angle));
    return rounded(model);
}

/// Adds the coefficients of a material, with the scales of the library's lobes.
void add_material(Library& library, const LogCoefficients& of) {
    const auto K = std::size_t(library.stored);
    for (std::size_t i = 0; i < K; ++i) {
        const bool used = i < of.lobe.size();
        const std::size_t j = used ? of.lobe[i] : 0;
        Rgb beta{};
        for (int c = 0; c < 3 && used; ++c)
            beta[c] = float(
                elementary::exp(std::min(of.log_beta(Eigen::Index(i), c) - double(library.basis.log_scale[j]), 11.0)));
        library.coefficient.push_back(beta);
        if (K < std::size_t(library.basis.lobes)) library.index.push_back(std::uint16_t(j));
    }
}

/// The sources' coefficients for these lobes; their errors are measured. `scaled`: the log scales are those of `basis`.
Result<Library> library_of(PmModel basis, bool scaled, std::span<const LibrarySource> sources, const BasisOptions& of,
                           Reporter& reporter) {
    const LobeShape shape = shape_of(lobe_options(of));
    const Lobes lobes = to_lobes(basis, shape);
    std::vector<LogCoefficients> coefficients(sources.size());
    std::vector<std::optional<Error>> errors(sources.size());
    parallel_for(sources.size(), of.threads, [&](std::size_t t) {
        if (reporter.cancelled()) return;
        const auto measured = table_of(sources[t]);
        if (!measured) return void(errors[t] = measured.error());
        const auto observations = observed_table(*measured, of);
        if (!observations) return void(errors[t] = observations.error());
        coefficients[t] = coefficients_of(*observations, lobes, of);
        reporter.advance("solving for coefficients", 0.5);
    });
    for (const auto& error : errors)
        if (error) return *error;
    if (reporter.cancelled()) return cancelled_error("fit_library");
    Library library;
    library.basis = std::move(basis);
    if (!scaled) set_scales(library.basis, coefficients);
    library.stored = of.active > 0 ? of.active : library.basis.lobes;
    for (const LogCoefficients& each : coefficients) add_material(library, each);
    for (const LibrarySource& source : sources) library.names.push_back(source.name);
    library.error.assign(sources.size(), 0.f);
    library = rounded(std::move(library));
    parallel_for(sources.size(), of.threads, [&](std::size_t t) {
        const auto measured = table_of(sources[t]);
        if (!measured) return void(errors[t] = measured.error());
        const Model model = material(library, t);
        const Evaluate fitted = evaluator(model);
        const auto seen = compare_pictures(evaluator(*measured), {&fitted, 1}, 1);
        library.error[t] = round_to_half(float(std::min(seen[0].mean.delta_e, double(k_half_max))));
        reporter.advance("measuring errors", 0.5);
    });
    for (const auto& error : errors)
        if (error) return *error;
    return library;
}

Result<Done> check_names(std::span<const LibrarySource> sources) {
    std::set<std::string_view> names;
    if (sources.empty()) return basis_error("materials", "at least 1", "0");
    for (const LibrarySource& source : sources)
        if (!names.insert(source.name).second || source.name.empty() || source.name.find('\n') != std::string::npos)
            return basis_error("names of materials", "one for each, without line breaks", source.name);
    return Done{};
}

}  // namespace

Result<Library> fit_library(std::span<const LibrarySource> sources, const BasisOptions& options,
                            const ProgressToken& progress) {
    const StandardArithmetic mode;
    if (const auto valid = check_options(options); !valid) return valid.error();
    if (const auto valid = check_names(sources); !valid) return valid.error();
    Reporter reporter(progress, double(options.lobes) + 3 * double(sources.size()));
    std::vector<SharedRows> rows(sources.size());
    std::vector<std::optional<Error>> errors(sources.size());
    parallel_for(sources.size(), options.threads, [&](std::size_t t) {
        if (reporter.cancelled()) return;
        const auto measured = table_of(sources[t]);
        if (!measured) return void(errors[t] = measured.error());
        const auto observations = observed_table(*measured, options);
        if (!observations) return void(errors[t] = observations.error());
        rows[t].rows = std::make_unique<Rows>(Subsets(*observations).rows(k_basis_stage, 0));
        reporter.advance("observing", 1);
    });
    for (const auto& error : errors)
        if (error) return *error;
    if (reporter.cancelled()) return cancelled_error("fit_library");
    Lobes lobes;
    on_threads(options.threads, [&] {
        lobes = rounded(refined(shared_lobes(rows, options, reporter), sources, options, reporter), *rows[0].rows);
    });
    if (reporter.cancelled()) return cancelled_error("fit_library");
    rows.clear();
    return library_of(basis_model(lobes), false, sources, options, reporter);
}

Result<Library> fit_to_basis(const Library& basis, std::span<const LibrarySource> sources, const BasisOptions& options,
                             const ProgressToken& progress) {
    const StandardArithmetic mode;
    BasisOptions of = options;
    of.form = basis.basis.form, of.axial = basis.basis.axial, of.lobes = basis.basis.lobes;
    of.variates = basis.basis.variates;
    if (const auto valid = check_options(of); !valid) return valid.error();
    if (const auto valid = check_names(sources); !valid) return valid.error();
    Reporter reporter(progress, double(sources.size()));
    return library_of(basis.basis, true, sources, of, reporter);
}

Result<Library> fit_texel_basis(const SharedPairs& pairs, std::span<const Rgb> f, const BasisOptions& options,
                                const ProgressToken& progress) {
    const StandardArithmetic mode;
    if (const auto valid = check_options(options); !valid) return valid.error();
    const std::size_t M = pairs.wl.size(), T = M > 0 ? f.size() / M : 0;
    Reporter reporter(progress, double(options.lobes) + double(T));
    std::vector<SharedRows> rows(T);
    std::vector<std::optional<Observations>> observed(T);
    parallel_for(T, options.threads, [&](std::size_t t) {
        if (reporter.cancelled()) return;
        ScatteredSamples samples;
        samples.isotropic = pairs.isotropic;
        for (std::size_t i = 0; i < M; ++i)
            if (is_finite(f[t * M + i]) && pairs.wl[i].z > 0 && pairs.wv[i].z > 0) {
                samples.wl.push_back(pairs.wl[i]), samples.wv.push_back(pairs.wv[i]);
                samples.colour.push_back(f[t * M + i]);
            }
        if (samples.wl.empty()) return;
        make_index(samples);
        ObserveSamplesOptions observing{
            Objective::appearance, options.max_theta > 0 ? options.max_theta : default_max_theta(Objective::appearance),
            options.seed};
        observing.threads = 1, observing.only_completed = k_completed_pairs;
        if (auto seen = observe(samples, observing)) observed[t] = std::move(seen->completed);
        if (observed[t]) rows[t].rows = std::make_unique<Rows>(Subsets(*observed[t]).rows(k_basis_stage, 0));
        reporter.advance("observing", 1);
    });
    std::erase_if(rows, [](const SharedRows& of) { return !of.rows; });
    std::erase_if(observed, [](const auto& of) { return !of; });
    if (reporter.cancelled()) return cancelled_error("fit_texel_basis");
    if (rows.empty()) return no_data_error("fit_texel_basis", "texels with values above 0");
    Lobes lobes;
    on_threads(options.threads, [&] { lobes = rounded(shared_lobes(rows, options, reporter), *rows[0].rows); });
    if (reporter.cancelled()) return cancelled_error("fit_texel_basis");
    Library library;
    library.basis = basis_model(lobes);
    std::vector<LogCoefficients> coefficients(observed.size());
    BasisOptions dense = options;
    dense.active = 0;
    parallel_for(observed.size(), options.threads,
                 [&](std::size_t t) { coefficients[t] = coefficients_of(*observed[t], lobes, dense); });
    set_scales(library.basis, coefficients);
    library.stored = options.lobes;
    for (const LogCoefficients& of : coefficients) add_material(library, of);
    library.error.assign(coefficients.size(), 0.f);
    return rounded(std::move(library));
}

TexelCoefficients fit_texels_to_basis(const Library& basis, const SharedPairs& pairs, std::span<const Rgb> f,
                                      int threads) {
    const StandardArithmetic mode;
    const std::size_t M = pairs.wl.size(), T = f.size() / M, J = std::size_t(basis.basis.lobes);
    // A lobe at all pairs is a model of which the other coefficients are 0.
    Eigen::MatrixXd E = Eigen::MatrixXd::Zero(Eigen::Index(M), Eigen::Index(J));
    for (std::size_t j = 0; j < J; ++j) {
        PmModel one = basis.basis;
        one.coefficient.assign(J, {});
        one.coefficient[j] = {1, 1, 1};
        std::vector<Rgb> values(M);
        evaluate(one, pairs.wl, pairs.wv, values);
        for (std::size_t i = 0; i < M; ++i) E(Eigen::Index(i), Eigen::Index(j)) = double(values[i].r);
    }
    TexelCoefficients all{std::vector<Rgb>(T * J), std::vector<float>(T)};
    parallel_for_parts(T, 64, threads, [&](std::size_t begin, std::size_t end) {
        std::vector<double> weight(M);
        std::vector<Rgb> value(M);
        const Eigen::VectorXd no_limit =
            Eigen::VectorXd::Constant(Eigen::Index(J), std::numeric_limits<double>::infinity());
        for (std::size_t t = begin; t < end; ++t) {
            for (std::size_t i = 0; i < M; ++i) {
                const Rgb& of = f[t * M + i];
                const bool known = is_finite(of) && pairs.wl[i].z > 0 && pairs.wv[i].z > 0;
                weight[i] = known ? 1 : 0;
                value[i] = known ? Rgb{std::max(of.r, 0.f), std::max(of.g, 0.f), std::max(of.b, 0.f)} : Rgb{};
            }
            const double typical = typical_value(Objective::appearance, pairs.wl, pairs.wv, value, weight);
            if (!(typical > 0)) continue;
            weigh(Objective::appearance, typical, pairs.wl, pairs.wv, value, weight, 1);
            const Eigen::Map<const Eigen::VectorXd> w(weight.data(), Eigen::Index(M));
            const Eigen::MatrixXd weighted = w.asDiagonal() * E, G = E.transpose() * weighted;
            double energy = 0, rest = 0;
            for (int c = 0; c < 3; ++c) {
                Eigen::VectorXd y{Eigen::Index(M)};
                for (std::size_t i = 0; i < M; ++i) y[Eigen::Index(i)] = double(value[i][c]);
                const Eigen::VectorXd beta = bounded_least_squares(G, weighted.transpose() * y, no_limit);
                for (std::size_t j = 0; j < J; ++j) all.coefficient[t * J + j][c] = float(beta[Eigen::Index(j)]);
                energy += (w.array() * y.array().square()).sum();
                rest += (w.array() * (y - E * beta).array().square()).sum();
            }
            all.error[t] = energy > 0 ? float(std::sqrt(rest / energy)) : 0.f;
        }
    });
    return all;
}

}  // namespace srbf
