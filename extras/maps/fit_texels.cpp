#include <algorithm>
#include <memory>
#include <numeric>

#include "base/errors.h"
#include "base/floating_point.h"
#include "base/parallel.h"
#include "base/reporter.h"
#include "extras/maps/material_coefficients.h"
#include "extras/maps/shared_lobes.h"
#include "models/library_file.h"
#include "models/pm/solve/rounding.h"
#include "samples/fit_pm_to_samples.h"
#include "samples/gap_filled_samples.h"
#include "samples/observe_samples.h"
#include "srbf/basis.h"
#include "srbf/convert.h"

namespace SRBF_NAMESPACE {
namespace {

/// Number of values of a gap-filled texel, the same as in `fit_batch`.
constexpr std::size_t k_gap_filled_pairs_of_texel = 4096;
/// Number of searches for lobes, of which the best is kept: for a map of GGX lobes, a single search could end far
/// from the others (docs/basis.md).
constexpr std::size_t k_searches = 3;

/// The library found by one search, with the coefficients of the observed texels; empty if cancelled.
Library search_for_library(const std::vector<std::shared_ptr<const Observations>>& observed,
                           const BasisOptions& options, Reporter& reporter) {
    std::vector<SharedRows> rows;
    for (const auto& texel : observed) rows.push_back(rows_for_search(*texel));
    Library library;
    library.basis = find_shared_lobes(
        rows, [&](std::size_t t) { return observed[t]; }, options, reporter);
    if (reporter.cancelled()) return {};
    const Lobes lobes = to_lobes(library.basis, shape_of(lobe_options(options)));
    std::vector<LogCoefficients> coefficients(observed.size());
    parallel_for(observed.size(), options.threads,
                 [&](std::size_t t) { coefficients[t] = coefficients_of(*observed[t], lobes, options); });
    set_scales(library.basis, coefficients);
    library.stored = options.lobes;
    for (const LogCoefficients& material : coefficients) add_material(library, material);
    library.error.assign(coefficients.size(), 0.f);
    return rounded(std::move(library));
}

}  // namespace

Result<Library> fit_texel_basis(const SharedPairs& pairs, std::span<const Rgb> f, const BasisOptions& options,
                                const ProgressToken& progress) {
    const StandardArithmetic mode;
    if (const auto valid = check_basis_options(options); !valid) return valid.error();
    const std::size_t M = pairs.wl.size(), T = M > 0 ? f.size() / M : 0;
    Reporter reporter(progress, k_searches * (double(options.lobes) + double(T)) + double(T));
    std::vector<std::shared_ptr<const Observations>> observed(T);
    parallel_for(T, options.threads, [&](std::size_t t) {
        if (reporter.cancelled()) return;
        ScatteredSamples samples = valid_samples(pairs.wl, pairs.wv, f.subspan(t * M, M), pairs.isotropic);
        if (samples.wl.empty()) return;
        make_index(samples);
        ObserveSamplesOptions observe_options{
            Objective::appearance, options.max_theta > 0 ? options.max_theta : default_max_theta(Objective::appearance),
            options.seed};
        observe_options.threads = 1, observe_options.only_gap_filled = k_gap_filled_pairs_of_texel;
        if (auto observations = observe(samples, observe_options))
            observed[t] = std::make_shared<const Observations>(std::move(observations->gap_filled_table));
        reporter.advance("observing", 1);
    });
    std::erase_if(observed, [](const auto& observations) { return !observations; });
    if (reporter.cancelled()) return cancelled_error("fit_texel_basis");
    if (observed.empty()) return no_data_error("fit_texel_basis", "texels with values above 0");
    Library best;
    double least = 0;
    for (std::uint64_t search = 0; search < k_searches; ++search) {
        BasisOptions dense = options;
        dense.active = 0, dense.seed = k_searches * options.seed + search;
        Library library = search_for_library(observed, dense, reporter);
        if (reporter.cancelled()) return cancelled_error("fit_texel_basis");
        const std::vector<float> errors = fit_texels_to_basis(library, pairs, f, options.threads).error;
        const double error = std::accumulate(errors.begin(), errors.end(), 0.0);
        if (search == 0 || error < least) least = error, best = std::move(library);
    }
    return best;
}

}  // namespace srbf
