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
#include "models/ggx/ggx_kind.h"
#include "observe/bound.h"
#include "observe/pair_weights.h"
#include "samples/folds.h"
#include "samples/observe_samples.h"
#include "srbf/elementary.h"
#include "srbf/fit.h"

namespace srbf {
namespace {

/// Two lobes or one, for all that is not dark or from where all samples are exceeded, as they are or lowered: GGX that is fitted
/// to samples often rises too high beyond them (docs/notes/samples.md). The last: none.
constexpr double k_not_dark = 0.05, k_lowered = 0.8;
constexpr auto k_continuations = [] {
    std::array<Continuation, 9> all{};
    auto next = all.begin();
    for (const std::size_t prior : {std::size_t(0), k_one_lobe})
        for (const double from : {k_not_dark, 1.0})
            for (const double share : {1.0, k_lowered}) *next++ = {prior, from, share};
    return all;
}();

/// A continuation by one lobe of GGX has its error of f but for what is dark.
constexpr double k_as_good_as_ggx = 1.01;
/// Neighbours alone continue highlights unless GGX predicts f or cube roots nearly as well as this: pictures of whole tables
/// are nearer to them than to GGX.
constexpr double k_better_than_ggx = 0.8;
/// A later continuation must be better by this: lobes follow a whole highlight more easily than one that changes within.
constexpr double k_better_than_before = 0.97;

/// A value on which several g_i agree is likelier than that of one alone, and may exceed the samples by more than a fit may.
constexpr double k_most_agreed = 1.8;

/// The value expected at a pair of directions.
struct Expected {
    std::array<double, 3> root{};  ///< e of `GapFilledSamples`
    double bound = 0;              ///< b of `GapFilledSamples`
};
Expected expected(const GapFilledSamples& samples, Vec3f wl, Vec3f wv) {
    const double area = cosines(wl, wv);
    Expected all;
    double agreed = samples.most;
    for (const GgxModel& prior : samples.priors) {
        const Rgb g = value(prior, wl, wv);
        for (int c = 0; c < 3; ++c)
            all.root[std::size_t(c)] +=
                elementary::cbrt(std::min(double(g[c]) * area, samples.most)) / double(samples.priors.size());
        agreed = std::min(agreed, largest_of(g) * area);
    }
    all.bound = std::max(agreed, samples.allowed);
    return all;
}

/// Lambert alone, without a lobe: the mean.
GgxModel lambert(const Observations& samples) {
    const auto mean = mean_value(samples);
    GgxModel model;
    for (int c = 0; c < 3; ++c) model.diffuse[c] = float(k_pi * mean[std::size_t(c)]);
    return model;
}

/// A lobe must lower the weighted squared error of f or the squared error of ∛(f A) by a larger share than this, divided by the
/// number of samples. Its height, roughness and F90, fitted to the noise of one channel, lower it by 3 in the mean, and by 20
/// in one of some thousand sets of samples.
constexpr double k_least_gain_of_lobe = 20;

/// Σ (∛(f A) − ∛(g A))² over samples and channels.
double root_error(const Observations& samples, const GgxModel& g) {
    double sum = 0;
    for (std::size_t i = 0; i < samples.f.size(); ++i) {
        const double area = cosines(samples.wl[i], samples.wv[i]);
        const Rgb by_g = value(g, samples.wl[i], samples.wv[i]);
        for (int c = 0; c < 3; ++c)
            sum += elementary::square(elementary::cbrt(double(samples.f[i][c]) * area) -
                                      elementary::cbrt(double(by_g[c]) * area));
    }
    return sum;
}

/// Fits of Lambert and GGX, by the weights of this objective, to samples of weight 1, each of which is there twice:
/// with at most one lobe and with at most two, as many as are supported.
Result<std::array<GgxModel, k_most_ggx_lobes>> fitted_priors(Objective objective, Observations samples, int threads) {
    samples.objective = objective;
    samples.typical = typical_value(objective, samples.wl, samples.wv, samples.f, samples.weight);
    if (!(samples.typical > 0)) return no_data_error("samples", "values within the largest angle", "some above 0");
    weigh(objective, samples.typical, samples.wl, samples.wv, samples.f, samples.weight, threads);
    samples.normalise();
    const double enough = 1 + k_least_gain_of_lobe / (double(samples.f.size()) / 2);
    const auto errors_of = [&](const GgxModel& g) {
        return std::array{loss_of(samples, evaluator(g)), root_error(samples, g)};
    };
    std::array<GgxModel, k_most_ggx_lobes> of_at_most;
    GgxModel simplest = lambert(samples);
    auto errors = errors_of(simplest);
    for (int lobes = 1; lobes <= k_most_ggx_lobes; ++lobes) {
        auto fit = Kind<GgxModel>::fit(samples, {lobes}, {.threads = threads});
        if (!fit) return fit.error();
        const auto less = errors_of(fit->unrounded);
        if (errors[0] > enough * less[0] || errors[1] > enough * less[1])
            simplest = std::move(fit->unrounded), errors = less;
        of_at_most[std::size_t(lobes - 1)] = simplest;
    }
    return of_at_most;
}

}  // namespace

Result<GapFilledSamples> fill_gaps(const ScatteredSamples& samples, double max_theta, int threads, bool of_one) {
    const Observations observed = observations_of(samples, samples_within(samples, max_theta), true, false);
    GapFilledSamples filled;
    auto seen = fitted_priors(Objective::appearance, observed, threads);
    if (!seen) return seen.error();
    filled.priors = {(*seen)[1]};
    if (!of_one) {
        auto in_image = fitted_priors(Objective::cosine, observed, threads);
        if (!in_image) return in_image.error();
        filled.priors.insert(filled.priors.end(), {(*seen)[0], (*in_image)[1]});
    }
    const double largest = largest_measured(observed);
    filled.allowed = (of_one ? k_most_excess : 1) * largest;
    filled.most = (of_one ? k_most_excess : k_most_agreed) * largest;
    ScatteredSamples& rest = filled.rest;
    rest.isotropic = samples.isotropic;
    rest.wl = observed.wl, rest.wv = observed.wv;
    for (std::size_t i = 0; i < rest.wl.size(); ++i) {
        const double area = cosines(rest.wl[i], rest.wv[i]);
        const auto root = expected(filled, rest.wl[i], rest.wv[i]).root;
        Rgb r;
        for (int c = 0; c < 3; ++c)
            r[c] = float((elementary::cbrt(double(observed.f[i][c]) * area) - root[std::size_t(c)]) / area);
        rest.colour.push_back(r);
    }
    make_index(rest);
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
    const Expected here = expected(samples, wl, wv);
    const Rgb rest = signed_value(samples.rest, wl, wv);
    Rgb f;
    for (int c = 0; c < 3; ++c) {
        const double root = here.root[std::size_t(c)] + double(rest[c]) * area;
        f[c] = float(std::clamp(root * root * root, 0.0, here.bound) / area);
    }
    return f;
}

/// That value, continued.
Rgb continued_value(const GapFilledSamples& samples, const Continuation& by, Rgb f, Vec3f wl, Vec3f wv) {
    if (!std::isfinite(by.from)) return f;
    const Rgb g = value(samples.priors[by.prior], wl, wv);
    const double largest = std::max(largest_of(f), largest_of(g)) * cosines(wl, wv) / (by.from * samples.allowed);
    const auto taken = float(std::clamp(2 * largest - 1, 0.0, 1.0));
    for (int c = 0; c < 3; ++c) f[c] += taken * (float(by.share) * g[c] - f[c]);
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

/// By what they predict of each sample, from those of the other folds; the last one is GGX alone.
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
    std::array<Measures, count + 1> of;
    std::ranges::transform(predicted, of.begin(), [&](const std::vector<Rgb>& f) {
        return measure_samples(samples.wl, samples.wv, samples.colour, f, max_theta);
    });
    const Measures &ggx = of[count], &neighbours = of[count - 1];
    // On a matte surface, neighbours may add only noise to Lambert. Where folds disagree whether there is a
    // highlight at all, it is not continued.
    const auto is_matte = [](const GapFilledSamples& one) { return one.priors[k_one_lobe].lobes.empty(); };
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
        const double both = of[k].squared_error_ratio * of[k].cube_root_error_ratio;
        if (of[k].squared_error_ratio > k_as_good_as_ggx * ggx.squared_error_ratio ||
            both >= k_better_than_before * least)
            continue;
        best = k_continuations[k], least = both;
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
