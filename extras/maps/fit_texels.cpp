#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>

#include "base/errors.h"
#include "base/floating_point.h"
#include "base/half.h"
#include "base/least_squares.h"
#include "base/parallel.h"
#include "base/reporter.h"
#include "extras/maps/material_coefficients.h"
#include "extras/maps/shared_lobes.h"
#include "models/library_file.h"
#include "models/pm/solve/rounding.h"
#include "observe/bound.h"
#include "observe/pair_weights.h"
#include "observe/pairs.h"
#include "samples/fit_pm_to_samples.h"
#include "samples/gap_filled_samples.h"
#include "samples/observe_samples.h"
#include "srbf/basis.h"
#include "srbf/elementary.h"

namespace srbf {
namespace {

/// Number of values of a gap-filled texel, the same as in `fit_batch`.
constexpr std::size_t k_gap_filled_pairs_of_texel = 4096;
/// Number of searches for lobes, of which the best is kept: for a map of GGX lobes, a single search could end far
/// from the others (docs/basis.md).
constexpr std::size_t k_searches = 3;
constexpr double k_unlimited = std::numeric_limits<double>::infinity();

/// The values of lobe j, with coefficient 1, at pairs of directions.
std::vector<Rgb> lobe_values(const Library& basis, std::size_t j, std::span<const Vec3f> wl,
                             std::span<const Vec3f> wv) {
    Library single;
    single.basis = basis.basis, single.stored = 1, single.index = {std::uint16_t(j)}, single.coefficient = {{1, 1, 1}};
    single.error = {0};
    std::vector<Rgb> values(wl.size());
    evaluate(material(single, 0), wl, wv, values);
    return values;
}

/// The largest coefficient of each lobe among the library's materials, relative to the material's largest f cosθl
/// cosθv at the samples.
Eigen::ArrayXd largest_shares(const Library& basis, const SharedPairs& pairs) {
    const auto J = std::size_t(basis.basis.lobes);
    Eigen::ArrayXd shares = Eigen::ArrayXd::Zero(Eigen::Index(J));
    std::vector<Rgb> f(pairs.wl.size());
    for (std::size_t t = 0; t < basis.count(); ++t) {
        evaluate(material(basis, t), pairs.wl, pairs.wv, f);
        double sampled = 0;
        for (std::size_t i = 0; i < f.size(); ++i)
            sampled = std::max(sampled, double(largest_of(f[i])) * cosines(pairs.wl[i], pairs.wv[i]));
        for (std::size_t j = 0; j < J && sampled > 0; ++j) {
            double& share = shares[Eigen::Index(j)];
            share = std::max(share, double(largest_of(basis.coefficient[t * J + j])) / sampled);
        }
    }
    return shares;
}

/// The lobes at the samples, and how far the samples constrain them.
struct SampledLobes {
    Eigen::MatrixXd values;  ///< M × J, for coefficient 1
    Eigen::ArrayXd largest;  ///< upper bounds on coefficients if f cosθl cosθv of the samples is at most 1
    /// lobes that do not rise by `k_most_excess` between or beyond the samples
    std::vector<Eigen::Index> constrained;
    std::vector<Eigen::Index> all;
};

/// A lobe that rises beyond the samples, where light or viewer is closer to the horizon than in any sample, may
/// reach `k_most_excess` there. The coefficient of a lobe that rises between or beyond them, relative to the values
/// at the samples, is at most `k_most_excess` times that of any texel in which the lobes were found.
SampledLobes sampled_lobes(const Library& basis, const SharedPairs& pairs) {
    float least = 1;  // cosine of a sample
    for (std::size_t i = 0; i < pairs.wl.size(); ++i)
        if (const float cosine = std::min(pairs.wl[i].z, pairs.wv[i].z); cosine > 0) least = std::min(least, cosine);
    std::vector<Vec3f> wl, wv;
    for (const auto& grid : {horizon_grid(), brink_grid()})
        for (const DirectionPair& pair : grid) wl.push_back(pair.wl), wv.push_back(pair.wv);
    const auto M = Eigen::Index(pairs.wl.size()), J = Eigen::Index(basis.basis.lobes);
    const Eigen::ArrayXd shares = largest_shares(basis, pairs);
    SampledLobes lobes{Eigen::MatrixXd(M, J), Eigen::ArrayXd(J), {}, {}};
    for (Eigen::Index j = 0; j < J; ++j) {
        double at_samples = 0, between = 0, beyond = 0;
        const std::vector<Rgb> sampled = lobe_values(basis, std::size_t(j), pairs.wl, pairs.wv);
        for (std::size_t i = 0; i < sampled.size(); ++i) {
            const double value = lobes.values(Eigen::Index(i), j) = double(sampled[i].r);
            at_samples = std::max(at_samples, value * cosines(pairs.wl[i], pairs.wv[i]));
        }
        const std::vector<Rgb> values = lobe_values(basis, std::size_t(j), wl, wv);
        for (std::size_t i = 0; i < wl.size(); ++i) {
            double& peak = std::min(wl[i].z, wv[i].z) < least ? beyond : between;
            peak = std::max(peak, double(values[i].r) * bound_cosines(wl[i], wv[i]));
        }
        lobes.largest[j] = beyond > k_most_excess * between ? k_most_excess / beyond : k_unlimited;
        lobes.all.push_back(j);
        const bool is_constrained = std::max(between, beyond) <= k_most_excess * at_samples;
        if (is_constrained)
            lobes.constrained.push_back(j);
        else
            lobes.largest[j] = std::min(lobes.largest[j], k_most_excess * shares[j]);
    }
    return lobes;
}

/// The coefficients of a texel, J × 3, with their stored precision, and the weighted squared residual.
struct Solution {
    Eigen::MatrixXd beta;
    double residual = 0;
};

/// The non-negative least-squares solution for y (M × 3) with the given lobes.
Solution solve(const SampledLobes& lobes, const std::vector<Eigen::Index>& subset, const Eigen::VectorXd& weight,
               const Eigen::MatrixXd& y, const Eigen::VectorXd& limit) {
    const Eigen::MatrixXd E = lobes.values(Eigen::all, subset), weighted = weight.asDiagonal() * E,
                          G = E.transpose() * weighted;
    Solution solution{Eigen::MatrixXd::Zero(lobes.values.cols(), y.cols())};
    for (Eigen::Index c = 0; c < y.cols(); ++c) {
        Eigen::VectorXd beta = bounded_least_squares(G, weighted.transpose() * y.col(c), limit(subset));
        for (double& number : beta) number = double(round_to_half(float(number)));
        solution.residual += (weight.array() * (y.col(c) - E * beta).array().square()).sum();
        solution.beta(subset, c) = beta;
    }
    return solution;
}

/// True if `more` further coefficients above 0 lower the squared residual of `count` values from `before` to
/// `after` by more than noise would: the Bayesian information criterion.
bool is_evident(double before, double after, std::size_t more, double count) {
    return before > after &&
           (after == 0 || count * elementary::log(before / after) > double(more) * elementary::log(count));
}

/// Uses the lobes that the samples constrain, or all lobes if it is evident that these are not enough.
Solution solve_texel(const SampledLobes& lobes, const Eigen::VectorXd& weight, const Eigen::MatrixXd& y,
                     const Eigen::VectorXd& limit) {
    Solution complete = solve(lobes, lobes.all, weight, y, limit);
    if (lobes.constrained.size() == lobes.all.size()) return complete;
    Solution constrained = solve(lobes, lobes.constrained, weight, y, limit);
    const double count = double(y.cols()) * double((weight.array() > 0).count());
    const auto used = [](const Solution& solution) { return (solution.beta.array() > 0).count(); };
    const auto more = std::size_t(std::max<Eigen::Index>(used(complete) - used(constrained), 1));
    return is_evident(constrained.residual, complete.residual, more, count) ? complete : constrained;
}

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
        ScatteredSamples samples;
        samples.isotropic = pairs.isotropic;
        for (std::size_t i = 0; i < M; ++i)
            if (is_finite(f[t * M + i]) && pairs.wl[i].z > 0 && pairs.wv[i].z > 0) {
                samples.wl.push_back(pairs.wl[i]), samples.wv.push_back(pairs.wv[i]);
                samples.colour.push_back(f[t * M + i]);
            }
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

TexelCoefficients fit_texels_to_basis(const Library& basis, const SharedPairs& pairs, std::span<const Rgb> f,
                                      int threads) {
    const StandardArithmetic mode;
    const std::size_t M = pairs.wl.size(), T = f.size() / M, J = std::size_t(basis.basis.lobes);
    const SampledLobes lobes = sampled_lobes(basis, pairs);
    TexelCoefficients texels{std::vector<Rgb>(T * J), std::vector<float>(T)};
    parallel_for_parts(T, 64, threads, [&](std::size_t begin, std::size_t end) {
        std::vector<double> weight(M);
        std::vector<Rgb> value(M);
        Eigen::MatrixXd y(Eigen::Index(M), 3);
        for (std::size_t t = begin; t < end; ++t) {
            double measured = 0;
            for (std::size_t i = 0; i < M; ++i) {
                const Rgb& value_at_pair = f[t * M + i];
                const bool is_known = is_finite(value_at_pair) && pairs.wl[i].z > 0 && pairs.wv[i].z > 0;
                weight[i] = is_known ? 1 : 0;
                value[i] = is_known ? Rgb{std::max(value_at_pair.r, 0.f), std::max(value_at_pair.g, 0.f),
                                          std::max(value_at_pair.b, 0.f)}
                                    : Rgb{};
                measured = std::max(measured, largest_of(value[i]) * cosines(pairs.wl[i], pairs.wv[i]));
                for (int c = 0; c < 3; ++c) y(Eigen::Index(i), c) = double(value[i][c]);
            }
            const double typical = typical_value(Objective::appearance, pairs.wl, pairs.wv, value, weight);
            if (!(typical > 0)) continue;
            weigh(Objective::appearance, typical, pairs.wl, pairs.wv, value, weight, 1);
            const Eigen::Map<const Eigen::VectorXd> w(weight.data(), Eigen::Index(M));
            const Solution solution = solve_texel(lobes, w, y, (measured * lobes.largest).min(double(k_half_max)));
            for (std::size_t j = 0; j < J; ++j)
                for (int c = 0; c < 3; ++c) texels.coefficient[t * J + j][c] = float(solution.beta(Eigen::Index(j), c));
            const double energy = (w.asDiagonal() * y.cwiseAbs2()).sum();
            texels.error[t] = energy > 0 ? float(std::sqrt(solution.residual / energy)) : 0.f;
        }
    });
    return texels;
}

}  // namespace srbf
