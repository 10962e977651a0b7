#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "errors.h"
#include "fit/objective/bound.h"
#include "fit/objective/pair_weights.h"
#include "microfacets/fits.h"
#include "parallel.h"
#include "samples/observe_samples.h"
#include "srbf/elementary.h"

namespace srbf {
namespace {

/// A fit of Lambert and GGX: by the weights of this objective, with this many lobes.
struct Prior {
    Objective objective;
    int lobes;
};
/// The first alone where one is asked for.
constexpr Prior k_priors[] = {{Objective::appearance, 2}, {Objective::appearance, 1}, {Objective::cosine, 2}};

/// One lobe by pictures: what a fit to samples is compared with.
constexpr std::size_t k_one_lobe = 1;
/// The first: none. The third is GGX itself but for what is dark. Where GGX rises far above the samples the last is nearer
/// to what folds leave out (docs/notes/samples.md).
constexpr Continuation k_continuations[] = {
    {}, {k_one_lobe, 1}, {k_one_lobe, 0.05}, {0, 0.05}, {.prior = k_one_lobe, .from = 0.05, .most = 1.2}};

/// A continuation by one lobe of GGX has its error of f but for what lies below 0.05.
constexpr double k_as_good_as_ggx = 1.01;
/// Neighbours alone continue highlights unless GGX predicts f better, or cube roots nearly as well as this: pictures of
/// whole tables are nearer to them than to GGX.
constexpr double k_better_than_ggx = 0.8;

/// What several g_i agree on is likelier than what one expects alone, and may exceed the samples by more than a fit may.
constexpr double k_most_agreed = 1.8;

/// What is expected at a pair of directions.
struct Expected {
    std::array<double, 3> root{};  ///< e of `CompletedSamples`
    double bound = 0;              ///< b of `CompletedSamples`
};
Expected expected(const CompletedSamples& samples, Vec3f wl, Vec3f wv) {
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

/// g of `CompletedSamples`, fitted to samples of weight 1.
Result<GgxModel> fitted_prior(const Prior& prior, Observations samples, int threads) {
    samples.objective = prior.objective;
    samples.typical = typical_value(prior.objective, samples.wl, samples.wv, samples.f, samples.weight);
    if (!(samples.typical > 0)) return no_data_error("samples", "values within the largest angle", "some above 0");
    weigh(prior.objective, samples.typical, samples.wl, samples.wv, samples.f, samples.weight, threads);
    samples.normalise();
    auto fit = fit_ggx(samples, {prior.lobes, threads});
    if (!fit) return fit.error();
    return std::move(fit->unrounded);
}

}  // namespace

Result<CompletedSamples> complete(const ScatteredSamples& samples, double max_theta, int threads, bool of_one) {
    const Observations observed = observations_of(samples, samples_within(samples, max_theta), true, false);
    CompletedSamples completed;
    for (const Prior& prior : std::span(k_priors).first(of_one ? 1 : std::size(k_priors))) {
        auto fitted = fitted_prior(prior, observed, threads);
        if (!fitted) return fitted.error();
        completed.priors.push_back(*std::move(fitted));
    }
    const double largest = largest_measured(observed);
    completed.allowed = (of_one ? k_most_excess : 1) * largest;
    completed.most = (of_one ? k_most_excess : k_most_agreed) * largest;
    ScatteredSamples& rest = completed.rest;
    rest.isotropic = samples.isotropic;
    rest.wl = observed.wl, rest.wv = observed.wv;
    for (std::size_t i = 0; i < rest.wl.size(); ++i) {
        const double area = cosines(rest.wl[i], rest.wv[i]);
        const auto root = expected(completed, rest.wl[i], rest.wv[i]).root;
        Rgb r;
        for (int c = 0; c < 3; ++c)
            r[c] = float((elementary::cbrt(double(observed.f[i][c]) * area) - root[std::size_t(c)]) / area);
        rest.colour.push_back(r);
    }
    make_index(rest);
    return completed;
}

std::string_view words(const Continuation& continuation) {
    if (!std::isfinite(continuation.from)) return "neighbours";
    if (continuation.from >= 1) return "one lobe of GGX beyond the largest sample";
    if (continuation.prior != k_one_lobe) return "two lobes of GGX";
    return std::isfinite(continuation.most) ? "one lobe of GGX that exceeds them by at most a fifth"
                                            : "one lobe of GGX";
}

Rgb value(const CompletedSamples& samples, Vec3f wl, Vec3f wv) {
    if (!(wl.z > 0 && wv.z > 0)) return {};
    const double area = cosines(wl, wv);
    const Expected here = expected(samples, wl, wv);
    const Rgb rest = signed_value(samples.rest, wl, wv);
    Rgb f;
    for (int c = 0; c < 3; ++c) {
        const double root = here.root[std::size_t(c)] + double(rest[c]) * area;
        f[c] = float(std::clamp(root * root * root, 0.0, here.bound) / area);
    }
    const auto [prior, from, most] = samples.continuation;
    if (!std::isfinite(from)) return f;
    const Rgb g = value(samples.priors[prior], wl, wv);
    const auto lowered = float(std::max(largest_of(g) * area / (most * samples.allowed), 1.0));
    const double largest = std::max(largest_of(f), largest_of(g)) * area / (from * samples.allowed);
    const auto share = float(std::clamp(2 * largest - 1, 0.0, 1.0));
    for (int c = 0; c < 3; ++c) f[c] += share * (g[c] / lowered - f[c]);
    return f;
}

Result<Continuation> best_continuation(const ScatteredSamples& samples, std::span<const int> fold, double max_theta,
                                       int threads) {
    constexpr std::size_t count = std::size(k_continuations);
    std::array<std::vector<Rgb>, count> predicted;
    predicted.fill(std::vector<Rgb>(fold.size()));
    std::vector<Rgb> of_ggx(fold.size());
    std::array<std::optional<Error>, k_folds> errors;
    parallel_for(k_folds, threads, [&](std::size_t left_out) {
        auto completed = complete(without_fold(samples, fold, int(left_out)), max_theta, threads);
        if (!completed) return void(errors[left_out] = completed.error());
        for (std::size_t i = 0; i < fold.size(); ++i) {
            if (fold[i] != int(left_out)) continue;
            of_ggx[i] = value(completed->priors[k_one_lobe], samples.wl[i], samples.wv[i]);
            for (std::size_t k = 0; k < count; ++k) {
                completed->continuation = k_continuations[k];
                predicted[k][i] = value(*completed, samples.wl[i], samples.wv[i]);
            }
        }
    });
    for (const auto& error : errors)
        if (error) return *error;
    const auto measures = [&](const std::vector<Rgb>& f) {
        return measure_samples(samples.wl, samples.wv, samples.colour, f, max_theta);
    };
    const Measures ggx = measures(of_ggx), neighbours = measures(predicted[0]);
    if (neighbours.squared_error_ratio <= ggx.squared_error_ratio &&
        neighbours.cube_root_error_ratio <= k_better_than_ggx * ggx.cube_root_error_ratio)
        return k_continuations[0];
    Continuation best = k_continuations[2];
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < count; ++k) {
        const Measures of = measures(predicted[k]);
        if (of.squared_error_ratio > k_as_good_as_ggx * ggx.squared_error_ratio || of.cube_root_error_ratio >= least)
            continue;
        best = k_continuations[k], least = of.cube_root_error_ratio;
    }
    return best;
}

}  // namespace srbf
