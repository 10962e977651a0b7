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

namespace SRBF_NAMESPACE {
namespace {

constexpr double k_largest_coefficient = 64;
constexpr double k_none = -std::numeric_limits<double>::infinity();

Lobes select_lobes(const Lobes& lobes, std::span<const std::size_t> which) {
    Lobes selected{lobes.shape, lobes.angle, {}};
    for (const std::size_t j : which)
        selected.weight.insert(selected.weight.end(), lobes.weights_of(int(j)).begin(), lobes.weights_of(int(j)).end());
    return selected;
}

LogCoefficients coefficients_in(const LobeProblem& problem, const Lobes& lobes, std::vector<std::size_t> which) {
    LogCoefficients result{std::move(which), Eigen::MatrixXd::Constant(lobes.count(), 3, k_none)};
    for (int j = 0; j < lobes.count(); ++j) {
        const double factor = elementary::log(problem.scale()) +
                              log_peak_factor(lobes.weights_of(j), lobes.shape, problem.offset()[std::size_t(j)]);
        for (int c = 0; c < 3; ++c)
            if (const double beta = problem.beta()(j, c); beta > 1e-30)
                result.log_beta(j, c) = elementary::log(beta) + factor;
    }
    return result;
}

/// The rows of one material with all terms of its objective, weighted for these lobes.
std::unique_ptr<Rows> rows_of(const Observations& observations, const Lobes& lobes) {
    Subsets subsets(observations);
    Candidate candidate;
    candidate.lobes = lobes;
    subsets.add_exceeded_pairs({candidate}, lobes.shape);
    const double importance = observations.views.empty() ? 0 : subsets.picture_importance(candidate);
    return std::make_unique<Rows>(subsets.rows(Pairs::selection, {.pictures = importance}));
}

}  // namespace

Result<Done> check_basis_options(const BasisOptions& options) {
    for (const auto& result :
         {require_range("fit_library", "number of lobes", options.lobes, 1, k_most_basis_lobes),
          require_range("fit_library", "number of variates", options.variates, 1, int(k_most_variates)),
          require_range("fit_library", "number of active lobes", options.active, 0, options.lobes),
          require_range("fit_library", "number of threads", options.threads, 0, 1024)})
        if (!result) return result.error();
    if (is_reciprocal(options.form))
        return argument_error("fit_library", "form", "one that is not reciprocal", std::string(name(options.form)));
    return Done{};
}

PmFitOptions lobe_options(const BasisOptions& options) {
    PmFitOptions pm_options;
    pm_options.form = options.form, pm_options.axial = options.axial, pm_options.lobes = options.lobes,
    pm_options.variates = options.variates;
    pm_options.seed = options.seed, pm_options.threads = options.threads;
    return pm_options;
}

SharedRows material_of(const Observations& observations, const Lobes& lobes, const BasisOptions& options) {
    SharedRows material{rows_of(observations, lobes)};
    LobeProblem problem(*material.rows, lobes.shape, false);
    problem.loss(pack(lobes));
    material.lobes = active_lobes(problem, std::size_t(options.active > 0 ? options.active : lobes.count()));
    if (material.lobes.size() < std::size_t(lobes.count()))
        material.rows = rows_of(observations, select_lobes(lobes, material.lobes));
    return material;
}

LogCoefficients coefficients_of(const Observations& observations, const Lobes& lobes, const BasisOptions& options) {
    SharedRows material = material_of(observations, lobes, options);
    const Lobes selected = select_lobes(lobes, material.lobes);
    LobeProblem problem(*material.rows, lobes.shape, false);
    problem.loss(pack(selected));
    return coefficients_in(problem, selected, std::move(material.lobes));
}

void set_scales(PmModel& basis, std::span<const LogCoefficients> materials) {
    std::vector<double> largest(std::size_t(basis.lobes), k_none);
    for (const LogCoefficients& material : materials)
        for (std::size_t i = 0; i < material.lobe.size(); ++i)
            largest[material.lobe[i]] =
                std::max(largest[material.lobe[i]], material.log_beta.row(Eigen::Index(i)).maxCoeff());
    for (std::size_t j = 0; j < largest.size(); ++j)
        basis.log_scale[j] =
            std::isfinite(largest[j]) ? round_to_half(float(largest[j] - elementary::log(k_largest_coefficient))) : 0.f;
}

void add_material(Library& library, const LogCoefficients& coefficients) {
    const auto K = std::size_t(library.stored);
    for (std::size_t i = 0; i < K; ++i) {
        const bool is_used = i < coefficients.lobe.size();
        const std::size_t j = is_used ? coefficients.lobe[i] : 0;
        Rgb beta{};
        for (int c = 0; c < 3 && is_used; ++c)
            beta[c] = float(elementary::exp(
                std::min(coefficients.log_beta(Eigen::Index(i), c) - double(library.basis.log_scale[j]), 11.0)));
        library.coefficient.push_back(beta);
        if (K < std::size_t(library.basis.lobes)) library.index.push_back(std::uint16_t(j));
    }
}

}  // namespace srbf
