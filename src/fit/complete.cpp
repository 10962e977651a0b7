#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "fit/excess.h"
#include "fit/objective.h"
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

/// e of `CompletedSamples`.
std::array<double, 3> expected_root(const CompletedSamples& samples, Vec3f wl, Vec3f wv) {
    std::array<double, 3> root{};
    for (const GgxModel& prior : samples.priors) {
        const Rgb g = value(prior, wl, wv);
        for (int c = 0; c < 3; ++c) {
            const double expected = std::min(double(g[c]) * double(wl.z) * double(wv.z), samples.most);
            root[std::size_t(c)] += std::cbrt(expected) / double(samples.priors.size());
        }
    }
    return root;
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
        normalise(observed);
        auto prior = fit_ggx(observed, {way.lobes, threads});
        if (!prior) return prior.error();
        completed.priors.push_back(std::move(prior->unrounded));
    }
    completed.most = k_most_excess * largest_measured(observed);
    for (std::size_t i = 0; i < rest.wl.size(); ++i) {
        const double area = double(rest.wl[i].z) * double(rest.wv[i].z);
        const auto expected = expected_root(completed, rest.wl[i], rest.wv[i]);
        Rgb r;
        for (int c = 0; c < 3; ++c)
            r[c] = float((std::cbrt(double(observed.f[i][c]) * area) - expected[std::size_t(c)]) / area);
        rest.colour.push_back(r);
    }
    make_index(rest);
    return completed;
}

Rgb value(const CompletedSamples& samples, Vec3f wl, Vec3f wv) {
    if (!(wl.z > 0 && wv.z > 0)) return {};
    const double area = double(wl.z) * double(wv.z);
    const auto expected = expected_root(samples, wl, wv);
    const Rgb rest = signed_value(samples.rest, wl, wv);
    Rgb f;
    for (int c = 0; c < 3; ++c) {
        const double root = expected[std::size_t(c)] + double(rest[c]) * area;
        f[c] = float(std::clamp(root * root * root, 0.0, samples.most) / area);
    }
    return f;
}

}  // namespace srbf
