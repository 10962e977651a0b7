#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "base/errors.h"
#include "base/parallel.h"
#include "errors/measures.h"
#include "measured/samples.h"
#include "models/ggx/ggx_kind.h"
#include "observe/bound.h"
#include "observe/pair_weights.h"
#include "samples/folds.h"
#include "samples/observe_samples.h"
#include "srbf/elementary.h"
#include "srbf/fit.h"

namespace SRBF_NAMESPACE {
namespace {

/// Candidates: the two-lobe or the one-lobe prior; used above 5 % of the largest sample or only above it; at full
/// height or at 0.8, because GGX fitted to samples often rises too high beyond them. The
/// last candidate uses no prior.
constexpr double k_not_dark = 0.05, k_lowered = 0.8;
constexpr auto k_continuations = [] {
    std::array<Continuation, 9> continuations{};
    auto next = continuations.begin();
    for (const std::size_t prior : {std::size_t(0), k_one_lobe})
        for (const double from : {k_not_dark, 1.0})
            for (const double share : {1.0, k_lowered}) *next++ = {prior, from, share};
    return continuations;
}();

/// The error of f may exceed that of the one-lobe GGX fit by this factor. A continuation by that fit has the error
/// of the fit itself, except in dark regions.
constexpr double k_as_good_as_ggx = 1.01;
/// Highlights are not continued if interpolation alone has at most this fraction of GGX's errors, both of f and of
/// cube roots: it then reproduces pictures of whole tables better than GGX.
constexpr double k_better_than_ggx = 0.8;
/// A later continuation must lower the product of errors to this fraction: lobes follow a highlight of one origin
/// more easily than one that changes within.
constexpr double k_better_than_before = 0.97;

/// A value on which several g_i agree is more likely than one of a single g. It may exceed the samples by more than
/// a fit may.
constexpr double k_most_agreed = 1.8;

/// The priors at a pair of directions, combined.
struct CombinedPriors {
    std::array<double, 3> root{};  ///< e of `GapFilledSamples`
    double bound = 0;              ///< b of `GapFilledSamples`
};
CombinedPriors combine_priors(const GapFilledSamples& samples, Vec3f wl, Vec3f wv) {
    const double area = cosines(wl, wv);
    CombinedPriors combined;
    double matte = std::numeric_limits<double>::infinity();
    for (const GgxModel& prior : samples.priors) matte = std::min(matte, largest_of(prior.diffuse) / k_pi);
    const double limit = std::max(samples.prior_limit, matte * area);
    double agreed = limit;
    for (const GgxModel& prior : samples.priors) {
        const Rgb g = value(prior, wl, wv);
        for (int c = 0; c < 3; ++c)
            combined.root[std::size_t(c)] +=
                elementary::cbrt(std::min(double(g[c]) * area, limit)) / double(samples.priors.size());
        agreed = std::min(agreed, largest_of(g) * area);
    }
    combined.bound = std::max(agreed, samples.least_bound);
    return combined;
}

/// Lambert alone, without a lobe, with the mean of the samples.
GgxModel lambert(const Observations& samples) {
    const auto mean = mean_value(samples);
    GgxModel model;
    for (int c = 0; c < 3; ++c) model.diffuse[c] = float(k_pi * mean[std::size_t(c)]);
    return model;
}

/// A lobe must lower the weighted squared error of f or the squared error of ∛(f A) by a larger fraction than this
/// number divided by the number of samples. If height, roughness and F90 are fitted to the noise of one channel,
/// they lower the error by 3 on average, and by 20 in one of a few thousand sets of samples.
constexpr double k_least_gain_of_lobe = 20;

/// Σ (∛(f A) − ∛(g A))² over samples and channels.
double root_error(const Observations& samples, const GgxModel& g) {
    double sum = 0;
    for (std::size_t i = 0; i < samples.f.size(); ++i) {
        const double area = cosines(samples.wl[i], samples.wv[i]);
        const Rgb g_value = value(g, samples.wl[i], samples.wv[i]);
        for (int c = 0; c < 3; ++c)
            sum += elementary::square(elementary::cbrt(double(samples.f[i][c]) * area) -
                                      elementary::cbrt(double(g_value[c]) * area));
    }
    return sum;
}

/// Fits Lambert and GGX, with the weights of the objective, to samples of weight 1, each of which occurs twice.
/// The results have at most one and at most two lobes, as many as the samples support.
Result<std::array<GgxModel, k_most_ggx_lobes>> fit_priors(Objective objective, Observations samples, int threads) {
    samples.objective = objective;
    samples.typical = typical_value(objective, samples.wl, samples.wv, samples.f, samples.weight);
    if (!(samples.typical > 0)) return no_data_error("samples", "values within the largest angle", "some above 0");
    weigh(objective, samples.typical, samples.wl, samples.wv, samples.f, samples.weight, threads);
    samples.normalise();
    const double enough = 1 + k_least_gain_of_lobe / (double(samples.f.size()) / 2);
    const auto errors_of = [&](const GgxModel& g) {
        return std::array{loss_of(samples, evaluator(g)), root_error(samples, g)};
    };
    std::array<GgxModel, k_most_ggx_lobes> at_most;
    GgxModel simplest = lambert(samples);
    auto errors = errors_of(simplest);
    for (int lobes = 1; lobes <= k_most_ggx_lobes; ++lobes) {
        auto fit = Kind<GgxModel>::fit(samples, {lobes}, {.threads = threads});
        if (!fit) return fit.error();
        const auto lower = errors_of(fit->unrounded);
        if (errors[0] > enough * lower[0] || errors[1] > enough * lower[1])
            simplest = std::move(fit->unrounded), errors = lower;
        at_most[std::size_t(lobes - 1)] = simplest;
    }
    return at_most;
}

}  // namespace

Result<GapFilledSamples> fill_gaps(const ScatteredSamples& samples, double max_theta, int threads, bool is_single) {
    const Observations observed = observations_of(samples, samples_within(samples, max_theta), true, false);
    GapFilledSamples filled;
    auto appearance_priors = fit_priors(Objective::appearance, observed, threads);
    if (!appearance_priors) return appearance_priors.error();
    filled.priors = {(*appearance_priors)[1]};
    if (!is_single) {
        auto cosine_priors = fit_priors(Objective::cosine, observed, threads);
        if (!cosine_priors) return cosine_priors.error();
        filled.priors.insert(filled.priors.end(), {(*appearance_priors)[0], (*cosine_priors)[1]});
    }
    const double largest = largest_measured(observed);
    filled.least_bound = (is_single ? k_most_excess : 1) * largest;
    filled.prior_limit = (is_single ? k_most_excess : k_most_agreed) * largest;
    ScatteredSamples& residual = filled.residual;
    residual.isotropic = samples.isotropic;
    residual.wl = observed.wl, residual.wv = observed.wv;
    for (std::size_t i = 0; i < residual.wl.size(); ++i) {
        const double area = cosines(residual.wl[i], residual.wv[i]);
        const auto root = combine_priors(filled, residual.wl[i], residual.wv[i]).root;
        Rgb r;
        for (int c = 0; c < 3; ++c)
            r[c] = float(elementary::cbrt(double(observed.f[i][c]) * area) - root[std::size_t(c)]);
        residual.colour.push_back(r);
    }
    make_index(residual);
    return filled;
}

std::string words(const Continuation& continuation) {
    if (!std::isfinite(continuation.from)) return "neighbours";
    return fmt::format("{}{} of GGX{}", continuation.share == 1 ? "" : fmt::format("{:g} times ", continuation.share),
                       continuation.prior == k_one_lobe ? "one lobe" : "two lobes",
                       continuation.from < 1 ? "" : " beyond the largest sample");
}

std::string words(const GapFilledSamples& samples) {
    const bool is_matte = std::ranges::all_of(samples.priors, [](const GgxModel& g) { return g.lobes.empty(); });
    return is_matte ? std::string(k_no_highlight) : words(samples.continuation);
}

namespace {

/// f without continuation, above the horizon.
Rgb filled_value(const GapFilledSamples& samples, Vec3f wl, Vec3f wv) {
    const double area = cosines(wl, wv);
    const CombinedPriors priors = combine_priors(samples, wl, wv);
    const Rgb residual = mean_of_neighbours(samples.residual, wl, wv);
    Rgb f;
    for (int c = 0; c < 3; ++c) {
        const double root = priors.root[std::size_t(c)] + double(residual[c]);
        f[c] = float(std::clamp(root * root * root, 0.0, priors.bound) / area);
    }
    return f;
}

/// Continues a highlight from that value.
Rgb continued_value(const GapFilledSamples& samples, const Continuation& continuation, Rgb f, Vec3f wl, Vec3f wv) {
    if (!std::isfinite(continuation.from)) return f;
    const Rgb g = value(samples.priors[continuation.prior], wl, wv);
    const double largest =
        std::max(largest_of(f), largest_of(g)) * cosines(wl, wv) / (continuation.from * samples.least_bound);
    const auto blend = float(std::clamp(2 * largest - 1, 0.0, 1.0));
    for (int c = 0; c < 3; ++c) f[c] += blend * (float(continuation.share) * g[c] - f[c]);
    return f;
}

}  // namespace

Rgb value(const GapFilledSamples& samples, Vec3f wl, Vec3f wv) {
    if (!above_horizon(wl, wv)) return {};
    Rgb f = continued_value(samples, samples.continuation, filled_value(samples, wl, wv), wl, wv);
    const auto grazing = float(cosines(wl, wv) / bound_cosines(wl, wv));
    for (int c = 0; c < 3; ++c) f[c] *= grazing;
    return f;
}

namespace {

/// Compares the continuations by how well they predict each sample from the other folds. The last prediction is GGX
/// alone.
Continuation best_continuation(const ScatteredSamples& samples, std::span<const int> fold, double max_theta,
                               std::span<const GapFilledSamples> without) {
    constexpr std::size_t count = k_continuations.size();
    std::array<std::vector<Rgb>, count + 1> predicted;
    predicted.fill(std::vector<Rgb>(fold.size()));
    for (std::size_t i = 0; i < fold.size(); ++i) {
        const GapFilledSamples& others = without[std::size_t(fold[i])];
        const Vec3f wl = samples.wl[i], wv = samples.wv[i];
        const Rgb f = filled_value(others, wl, wv);
        for (std::size_t k = 0; k < count; ++k)
            predicted[k][i] = continued_value(others, k_continuations[k], f, wl, wv);
        predicted[count][i] = value(others.priors[k_one_lobe], wl, wv);
    }
    std::array<Measures, count + 1> errors;
    std::ranges::transform(predicted, errors.begin(), [&](const std::vector<Rgb>& f) {
        return measure_samples(samples.wl, samples.wv, samples.colour, f, max_theta);
    });
    const Measures &ggx = errors[count], &neighbours = errors[count - 1];
    // On a matte surface, interpolation may only add noise to Lambert. If folds disagree about whether there is a
    // highlight, it is not continued.
    const auto is_matte = [](const GapFilledSamples& samples_of_fold) {
        return samples_of_fold.priors[k_one_lobe].lobes.empty();
    };
    if (std::ranges::any_of(without, is_matte))
        return std::ranges::all_of(without, is_matte) && ggx.cube_root_error_ratio <= neighbours.cube_root_error_ratio
                   ? Continuation{k_one_lobe, 0}
                   : Continuation{};
    if (neighbours.squared_error_ratio <= k_better_than_ggx * ggx.squared_error_ratio &&
        neighbours.cube_root_error_ratio <= k_better_than_ggx * ggx.cube_root_error_ratio)
        return {};
    Continuation best{k_one_lobe, k_not_dark};
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < count; ++k) {
        const double product = errors[k].squared_error_ratio * errors[k].cube_root_error_ratio;
        if (errors[k].squared_error_ratio > k_as_good_as_ggx * ggx.squared_error_ratio ||
            product >= k_better_than_before * least)
            continue;
        best = k_continuations[k], least = product;
    }
    return best;
}

}  // namespace

Result<std::vector<GapFilledSamples>> fill_gaps_without_folds(const ScatteredSamples& samples,
                                                              std::span<const int> fold, double max_theta,
                                                              int threads) {
    std::vector<GapFilledSamples> without(k_folds);
    std::array<std::optional<Error>, k_folds> errors;
    parallel_for(k_folds, threads, [&](std::size_t left_out) {
        auto filled = fill_gaps(without_fold(samples, fold, int(left_out)), max_theta, threads);
        if (!filled) return void(errors[left_out] = filled.error());
        without[left_out] = *std::move(filled);
    });
    for (const auto& error : errors)
        if (error) return *error;
    const Continuation best = best_continuation(samples, fold, max_theta, without);
    for (GapFilledSamples& filled : without) filled.continuation = best;
    return without;
}

}  // namespace srbf
