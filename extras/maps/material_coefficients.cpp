#include "extras/maps/material_coefficients.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/errors.h"
#include "base/half.h"
#include "extras/maps/active_lobes.h"
#include "models/pm/search/subsets.h"
#include "models/pm/solve/rounding.h"
#include "srbf/elementary.h"

namespace srbf {
namespace {

constexpr double k_largest_coefficient = 64;
constexpr double k_none = -std::numeric_limits<double>::infinity();

constexpr Stage k_active_stage{.name = "active", .pairs = Pairs::some, .albedos = true};
constexpr Stage k_picture_stage{.name = "pictures", .pairs = Pairs::some, .albedos = true, .pictures = true};

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
    subsets.add_point_lights(evaluator(fitted));
    const double importance = subsets.picture_importance(candidate, k_picture_stage, options, k_log_peak_limit);
    return std::make_unique<Rows>(subsets.rows(k_picture_stage, importance));
}

}  // namespace

Result<Done> check_basis_options(const BasisOptions& of) {
    for (const auto& result : {require_range("fit_library", "number of lobes", of.lobes, 1, k_most_basis_lobes),
                               require_range("fit_library", "number of variates", of.variates, 1, int(k_most_variates)),
                               require_range("fit_library", "number of active lobes", of.active, 0, of.lobes),
                               require_range("fit_library", "number of threads", of.threads, 0, 1024)})
        if (!result) return result.error();
    return Done{};
}

FitOptions lobe_options(const BasisOptions& of) {
    FitOptions options;
    options.form = of.form, options.axial = of.axial, options.lobes = of.lobes, options.variates = of.variates;
    options.seed = of.seed, options.threads = of.threads;
    return options;
}

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

LogCoefficients coefficients_of(const Observations& observations, const Lobes& all, const BasisOptions& of) {
    SharedRows material = material_of(observations, all, of);
    const Lobes lobes = chosen_lobes(all, material.lobes);
    LobeProblem problem(*material.rows, all.shape, false, k_log_peak_limit);
    problem.loss(pack(lobes));
    return coefficients_in(problem, lobes, std::move(material.lobes));
}

void set_scales(PmModel& basis, std::span<const LogCoefficients> materials) {
    std::vector<double> largest(std::size_t(basis.lobes), k_none);
    for (const LogCoefficients& of : materials)
        for (std::size_t i = 0; i < of.lobe.size(); ++i)
            largest[of.lobe[i]] = std::max(largest[of.lobe[i]], of.log_beta.row(Eigen::Index(i)).maxCoeff());
    for (std::size_t j = 0; j < largest.size(); ++j)
        basis.log_scale[j] =
            std::isfinite(largest[j]) ? round_to_half(float(largest[j] - elementary::log(k_largest_coefficient))) : 0.f;
}

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

}  // namespace srbf
