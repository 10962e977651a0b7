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

/// Values of a filled texel, as many as `fit_batch` completes.
constexpr std::size_t k_gap_filled_pairs_of_texel = 4096;
/// Searches for lobes, of which the best is kept: one alone ended far from the others for a map of GGX lobes
/// (docs/basis.md).
constexpr std::size_t k_searches = 3;
constexpr double k_unlimited = std::numeric_limits<double>::infinity();

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

/// The largest coefficients of the library's materials, of samples of theirs whose f cosθl cosθv is at most 1.
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
    Eigen::MatrixXd values;          ///< M × J, of coefficient 1
    Eigen::ArrayXd largest;          ///< coefficients for samples whose f cosθl cosθv is at most 1
    std::vector<Eigen::Index> seen;  ///< those that do not rise by `k_most_excess` between or beyond the samples
    std::vector<Eigen::Index> all;
};

/// A lobe that rises beyond the samples, where light or viewer is nearer to the horizon than in all of them, may reach
/// `k_most_excess` there. One that rises between or beyond them has no larger a coefficient, relative to the values at the
/// samples, than `k_most_excess` times that of any of the texels in which the lobes were found.
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
        double at_samples = 0, within = 0, beyond = 0;
        const std::vector<Rgb> sampled = lobe_values(basis, std::size_t(j), pairs.wl, pairs.wv);
        for (std::size_t i = 0; i < sampled.size(); ++i) {
            const double value = lobes.values(Eigen::Index(i), j) = double(sampled[i].r);
            at_samples = std::max(at_samples, value * cosines(pairs.wl[i], pairs.wv[i]));
        }
        const std::vector<Rgb> values = lobe_values(basis, std::size_t(j), wl, wv);
        for (std::size_t i = 0; i < wl.size(); ++i) {
            double& peak = std::min(wl[i].z, wv[i].z) < least ? beyond : within;
            peak = std::max(peak, double(values[i].r) * bound_cosines(wl[i], wv[i]));
        }
        lobes.largest[j] = beyond > k_most_excess * within ? k_most_excess / beyond : k_unlimited;
        lobes.all.push_back(j);
        const bool is_seen = std::max(within, beyond) <= k_most_excess * at_samples;
        if (is_seen)
            lobes.seen.push_back(j);
        else
            lobes.largest[j] = std::min(lobes.largest[j], k_most_excess * shares[j]);
    }
    return lobes;
}

/// The coefficients of a texel, J × 3, as they are stored, and what they leave of the weighted squares.
struct Solution {
    Eigen::MatrixXd beta;
    double rest = 0;
};

/// The non-negative least-squares solution of y (M × 3) by `which` of the lobes.
Solution solved(const SampledLobes& lobes, const std::vector<Eigen::Index>& which, const Eigen::VectorXd& weight,
                const Eigen::MatrixXd& y, const Eigen::VectorXd& limit) {
    const Eigen::MatrixXd E = lobes.values(Eigen::all, which), weighted = weight.asDiagonal() * E,
                          G = E.transpose() * weighted;
    Solution of{Eigen::MatrixXd::Zero(lobes.values.cols(), y.cols())};
    for (Eigen::Index c = 0; c < y.cols(); ++c) {
        Eigen::VectorXd beta = bounded_least_squares(G, weighted.transpose() * y.col(c), limit(which));
        for (double& number : beta) number = double(round_to_half(float(number)));
        of.rest += (weight.array() * (y.col(c) - E * beta).array().square()).sum();
        of.beta(which, c) = beta;
    }
    return of;
}

/// True if `more` coefficients above 0 lower the squares of `count` values from `rest` to `left` by more than noise
/// does: the Bayesian information criterion.
bool is_evident(double rest, double left, std::size_t more, double count) {
    return rest > left && (left == 0 || count * elementary::log(rest / left) > double(more) * elementary::log(count));
}

/// By the lobes that the samples see; by all if it is evident that these are not enough.
Solution solved(const SampledLobes& lobes, const Eigen::VectorXd& weight, const Eigen::MatrixXd& y,
                const Eigen::VectorXd& limit) {
    Solution all = solved(lobes, lobes.all, weight, y, limit);
    if (lobes.seen.size() == lobes.all.size()) return all;
    Solution seen = solved(lobes, lobes.seen, weight, y, limit);
    const double count = double(y.cols()) * double((weight.array() > 0).count());
    const auto used = [](const Solution& of) { return (of.beta.array() > 0).count(); };
    const auto more = std::size_t(std::max<Eigen::Index>(used(all) - used(seen), 1));
    return is_evident(seen.rest, all.rest, more, count) ? all : seen;
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
        observing.threads = 1, observing.only_gap_filled = k_gap_filled_pairs_of_texel;
        if (auto seen = observe(samples, observing))
            observed[t] = std::make_shared<const Observations>(std::move(seen->gap_filled_table));
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
    const SampledLobes lobes = sampled_lobes(basis, pairs);
    TexelCoefficients all{std::vector<Rgb>(T * J), std::vector<float>(T)};
    parallel_for_parts(T, 64, threads, [&](std::size_t begin, std::size_t end) {
        std::vector<double> weight(M);
        std::vector<Rgb> value(M);
        Eigen::MatrixXd y(Eigen::Index(M), 3);
        for (std::size_t t = begin; t < end; ++t) {
            double measured = 0;
            for (std::size_t i = 0; i < M; ++i) {
                const Rgb& of = f[t * M + i];
                const bool known = is_finite(of) && pairs.wl[i].z > 0 && pairs.wv[i].z > 0;
                weight[i] = known ? 1 : 0;
                value[i] = known ? Rgb{std::max(of.r, 0.f), std::max(of.g, 0.f), std::max(of.b, 0.f)} : Rgb{};
                measured = std::max(measured, largest_of(value[i]) * cosines(pairs.wl[i], pairs.wv[i]));
                for (int c = 0; c < 3; ++c) y(Eigen::Index(i), c) = double(value[i][c]);
            }
            const double typical = typical_value(Objective::appearance, pairs.wl, pairs.wv, value, weight);
            if (!(typical > 0)) continue;
            weigh(Objective::appearance, typical, pairs.wl, pairs.wv, value, weight, 1);
            const Eigen::Map<const Eigen::VectorXd> w(weight.data(), Eigen::Index(M));
            const Solution of = solved(lobes, w, y, (measured * lobes.largest).min(double(k_half_max)));
            for (std::size_t j = 0; j < J; ++j)
                for (int c = 0; c < 3; ++c) all.coefficient[t * J + j][c] = float(of.beta(Eigen::Index(j), c));
            const double energy = (w.asDiagonal() * y.cwiseAbs2()).sum();
            all.error[t] = energy > 0 ? float(std::sqrt(of.rest / energy)) : 0.f;
        }
    });
    return all;
}

}  // namespace srbf
