#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "fit/fits.h"
#include "fit/objective/bound.h"
#include "fit/objective/objective.h"
#include "srbf/elementary.h"
#include "srbf/fit_samples.h"

namespace srbf {
namespace {

/// A fit of Lambert and GGX: by the weights of this objective, with this many lobes.
struct Way {
    Objective objective;
    int lobes;
};
/// The first alone where one is asked for.
constexpr Way k_ways[] = {{Objective::appearance, 2}, {Objective::appearance, 1}, {Objective::cosine, 2}};

/// What several g_i agree on is likelier than what one expects alone, and may exceed the samples by more than a fit may.
constexpr double k_most_agreed = 1.8;

/// What is expected at a pair of directions.
struct Expected {
    std::array<double, 3> root{};  ///< e of `CompletedSamples`
    double bound = 0;              ///< b of `CompletedSamples`
};
Expected expected(const CompletedSamples& samples, Vec3f wl, Vec3f wv) {
    const double area = double(wl.z) * double(wv.z);
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

}  // namespace

Result<CompletedSamples> complete(const ScatteredSamples& samples, double max_theta, int threads, bool of_one) {
    const float cos_max = sample_cap(max_theta);
    CompletedSamples completed;
    ScatteredSamples& rest = completed.rest;
    rest.isotropic = samples.isotropic;
    Observations observed;
    for (std::size_t i = 0; i < samples.wl.size(); ++i) {
        if (std::min(samples.wl[i].z, samples.wv[i].z) < cos_max) continue;
        Rgb f = samples.colour[i];
        clamp_negative(f);
        for (const bool exchanged : {false, true}) {
            rest.wl.push_back(exchanged ? samples.wv[i] : samples.wl[i]);
            rest.wv.push_back(exchanged ? samples.wl[i] : samples.wv[i]);
            observed.f.push_back(f);
        }
    }
    observed.wl = rest.wl, observed.wv = rest.wv;
    for (const Way& way : std::span(k_ways).first(of_one ? 1 : std::size(k_ways))) {
        observed.weight.assign(observed.f.size(), 1);
        observed.objective = way.objective;
        observed.typical = typical_value(way.objective, observed.wl, observed.wv, observed.f, observed.weight);
        if (!(observed.typical > 0))
            return Error{"samples", {}, "values within the largest angle", "some above 0", "none", ErrorCode::no_data};
        weigh(way.objective, observed.typical, observed.wl, observed.wv, observed.f, observed.weight, threads);
        observed.normalise();
        auto prior = fit_ggx(observed, {way.lobes, threads});
        if (!prior) return prior.error();
        completed.priors.push_back(std::move(prior->unrounded));
    }
    const double largest = largest_measured(observed);
    completed.allowed = (of_one ? k_most_excess : 1) * largest;
    completed.most = (of_one ? k_most_excess : k_most_agreed) * largest;
    for (std::size_t i = 0; i < rest.wl.size(); ++i) {
        const double area = double(rest.wl[i].z) * double(rest.wv[i].z);
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
    const double area = double(wl.z) * double(wv.z);
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
