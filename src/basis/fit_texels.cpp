#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>

#include "basis/material_coefficients.h"
#include "basis/shared_lobes.h"
#include "errors.h"
#include "fit/data/pairs.h"
#include "fit/objective/bound.h"
#include "fit/objective/pair_weights.h"
#include "fit/solve/rounding.h"
#include "floating_point.h"
#include "least_squares.h"
#include "parallel.h"
#include "reporter.h"
#include "samples/observe_samples.h"
#include "srbf/basis.h"
#include "srbf/fit_samples.h"

namespace srbf {
namespace {

/// Values of a completed texel, as many as `fit_batch` completes.
constexpr std::size_t k_completed_pairs_of_texel = 4096;
/// Searches for lobes, of which the best is kept: one alone ended far from the others for a map of GGX lobes
/// (docs/basis.md).
constexpr std::size_t k_searches = 3;

/// Lobe j at pairs of directions, its coefficient being 1.
std::vector<Rgb> lobe_values(const Library& basis, std::size_t j, std::span<const Vec3f> wl,
                             std::span<const Vec3f> wv) {
    Library one;
    one.basis = basis.basis, one.stored = 1, one.index = {std::uint16_t(j)}, one.coefficient = {{1, 1, 1}};
    one.error = {0};
    std::vector<Rgb> values(wl.size());
    evaluate(material(one, 0), wl, wv, values);
    return values;
}

/// The largest coefficient of each lobe for samples whose f cosθl cosθv is at most 1. A lobe that has a larger peak where
/// light or viewer is beyond all samples than where both are within may reach `k_most_excess` there; others have no limit.
Eigen::ArrayXd largest_coefficients(const Library& basis, const SharedPairs& pairs) {
    float least = 1;  // cosine of a sample
    for (std::size_t i = 0; i < pairs.wl.size(); ++i)
        if (const float cosine = std::min(pairs.wl[i].z, pairs.wv[i].z); cosine > 0) least = std::min(least, cosine);
    std::vector<Vec3f> wl, wv;
    for (const auto& grid : {horizon_grid(), brink_grid()})
        for (const DirectionPair& pair : grid) wl.push_back(pair.wl), wv.push_back(pair.wv);
    Eigen::ArrayXd limit(basis.basis.lobes);
    for (Eigen::Index j = 0; j < limit.size(); ++j) {
        const std::vector<Rgb> values = lobe_values(basis, std::size_t(j), wl, wv);
        double within = 0, beyond = 0;
        for (std::size_t i = 0; i < wl.size(); ++i) {
            double& peak = std::min(wl[i].z, wv[i].z) < least ? beyond : within;
            peak = std::max(peak, double(values[i].r) * bound_cosines(wl[i], wv[i]));
        }
        limit[j] = beyond > k_most_excess * within ? k_most_excess / beyond : std::numeric_limits<double>::infinity();
    }
    return limit;
}

/// The library of one search, with the coefficients of the observed texels; empty if it was cancelled.
Library searched(const std::vector<std::shared_ptr<const Observations>>& observed, const BasisOptions& options,
                 Reporter& reporter) {
    std::vector<SharedRows> rows;
    for (const auto& of : observed) rows.push_back(rows_for_search(*of));
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
    for (const LogCoefficients& of : coefficients) add_material(library, of);
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
        observing.threads = 1, observing.only_completed = k_completed_pairs_of_texel;
        if (auto seen = observe(samples, observing))
            observed[t] = std::make_shared<const Observations>(std::move(seen->completed));
        reporter.advance("observing", 1);
    });
    std::erase_if(observed, [](const auto& of) { return !of; });
    if (reporter.cancelled()) return cancelled_error("fit_texel_basis");
    if (observed.empty()) return no_data_error("fit_texel_basis", "texels with values above 0");
    Library best;
    double least = 0;
    for (std::uint64_t search = 0; search < k_searches; ++search) {
        BasisOptions dense = options;
        dense.active = 0, dense.seed = k_searches * options.seed + search;
        Library found = searched(observed, dense, reporter);
        if (reporter.cancelled()) return cancelled_error("fit_texel_basis");
        const std::vector<float> errors = fit_texels_to_basis(found, pairs, f, options.threads).error;
        const double error = std::accumulate(errors.begin(), errors.end(), 0.0);
        if (search == 0 || error < least) least = error, best = std::move(found);
    }
    return best;
}

TexelCoefficients fit_texels_to_basis(const Library& basis, const SharedPairs& pairs, std::span<const Rgb> f,
                                      int threads) {
    const StandardArithmetic mode;
    const std::size_t M = pairs.wl.size(), T = f.size() / M, J = std::size_t(basis.basis.lobes);
    Eigen::MatrixXd E{Eigen::Index(M), Eigen::Index(J)};
    for (std::size_t j = 0; j < J; ++j) {
        const std::vector<Rgb> values = lobe_values(basis, j, pairs.wl, pairs.wv);
        for (std::size_t i = 0; i < M; ++i) E(Eigen::Index(i), Eigen::Index(j)) = double(values[i].r);
    }
    const Eigen::ArrayXd largest = largest_coefficients(basis, pairs);
    TexelCoefficients all{std::vector<Rgb>(T * J), std::vector<float>(T)};
    parallel_for_parts(T, 64, threads, [&](std::size_t begin, std::size_t end) {
        std::vector<double> weight(M);
        std::vector<Rgb> value(M);
        for (std::size_t t = begin; t < end; ++t) {
            double measured = 0;
            for (std::size_t i = 0; i < M; ++i) {
                const Rgb& of = f[t * M + i];
                const bool known = is_finite(of) && pairs.wl[i].z > 0 && pairs.wv[i].z > 0;
                weight[i] = known ? 1 : 0;
                value[i] = known ? Rgb{std::max(of.r, 0.f), std::max(of.g, 0.f), std::max(of.b, 0.f)} : Rgb{};
                measured = std::max(measured, largest_of(value[i]) * cosines(pairs.wl[i], pairs.wv[i]));
            }
            const double typical = typical_value(Objective::appearance, pairs.wl, pairs.wv, value, weight);
            if (!(typical > 0)) continue;
            weigh(Objective::appearance, typical, pairs.wl, pairs.wv, value, weight, 1);
            const Eigen::Map<const Eigen::VectorXd> w(weight.data(), Eigen::Index(M));
            const Eigen::MatrixXd weighted = w.asDiagonal() * E, G = E.transpose() * weighted;
            const Eigen::VectorXd limit = measured * largest;
            double energy = 0, rest = 0;
            for (int c = 0; c < 3; ++c) {
                Eigen::VectorXd y{Eigen::Index(M)};
                for (std::size_t i = 0; i < M; ++i) y[Eigen::Index(i)] = double(value[i][c]);
                const Eigen::VectorXd beta = bounded_least_squares(G, weighted.transpose() * y, limit);
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
