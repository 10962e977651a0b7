#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "fit/data/errors.h"
#include "fit/data/observe_samples.h"
#include "fit/objective/bound.h"
#include "fit/objective/objective.h"
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
    return f;
}

}  // namespace srbf
