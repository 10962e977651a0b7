#include "samples/gap_filled_samples.h"

#include <algorithm>

#include "base/errors.h"
#include "measured/samples.h"
#include "models/ggx/ggx_kind.h"
#include "observe/excess.h"
#include "observe/pair_weights.h"
#include "samples/observe_samples.h"
#include "srbf/elementary.h"
#include "srbf/fit.h"

namespace SRBF_NAMESPACE {
namespace {

/// A value on which several g_i agree is likelier than one of a single g, and may exceed the samples by more.
constexpr double k_max_agreed = 1.8;

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
    combined.bound = std::max(agreed, samples.min_bound);
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
constexpr double k_min_gain_of_lobe = 20;

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
Result<std::array<GgxModel, k_max_ggx_lobes>> fit_priors(Objective objective, Observations samples, int threads) {
    samples.objective = objective;
    samples.typical = typical_value(objective, samples.wl, samples.wv, samples.f, samples.weight);
    if (!(samples.typical > 0)) return no_data_error("samples", "values within the largest angle", "some above 0");
    weigh(objective, samples.typical, samples.wl, samples.wv, samples.f, samples.weight, threads);
    samples.normalise();
    const double enough = 1 + k_min_gain_of_lobe / (double(samples.f.size()) / 2);
    const auto errors_of = [&](const GgxModel& g) {
        return std::array{loss_of(samples, evaluator(g)), root_error(samples, g)};
    };
    std::array<GgxModel, k_max_ggx_lobes> at_most;
    GgxModel simplest = lambert(samples);
    auto errors = errors_of(simplest);
    for (int lobes = 1; lobes <= k_max_ggx_lobes; ++lobes) {
        auto fit = Kind<GgxModel>::fit(samples, {lobes}, {.threads = threads});
        if (!fit) return fit.error();
        const auto lower = errors_of(fit->unrounded);
        if (errors[0] > enough * lower[0] || errors[1] > enough * lower[1]) {
            simplest = std::move(fit->unrounded);
            errors = lower;
        }
        at_most[std::size_t(lobes - 1)] = simplest;
    }
    return at_most;
}

}  // namespace

Result<GapFilledSamples> fill_gaps(const ScatteredSamples& samples, double max_theta, int threads, bool is_single) {
    const Observations observed = observations_of(samples, samples_within(samples, max_theta), ExchangedSamples::added);
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
    filled.min_bound = (is_single ? k_max_excess : 1) * largest;
    filled.prior_limit = (is_single ? k_max_excess : k_max_agreed) * largest;
    ScatteredSamples& residual = filled.residual;
    residual.isotropic = samples.isotropic;
    residual.wl = observed.wl;
    residual.wv = observed.wv;
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

Rgb value(const GapFilledSamples& samples, Vec3f wl, Vec3f wv) {
    if (!above_horizon(wl, wv)) return {};
    const CombinedPriors priors = combine_priors(samples, wl, wv);
    const Rgb residual = mean_of_neighbours(samples.residual, wl, wv);
    Rgb f;
    for (int c = 0; c < 3; ++c) {
        const double root = priors.root[std::size_t(c)] + double(residual[c]);
        f[c] = float(std::clamp(root * root * root, 0.0, priors.bound) / bound_cosines(wl, wv));
    }
    return f;
}

}  // namespace
