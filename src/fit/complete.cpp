#include <algorithm>
#include <cmath>

#include "fit/excess.h"
#include "fit/objective.h"
#include "srbf/fit_samples.h"

namespace srbf {

Result<CompletedSamples> complete(const ScatteredSamples& samples, double max_theta, int threads) {
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
    observed.weight.assign(observed.f.size(), 1);
    observed.objective = Objective::appearance;
    observed.typical = typical_value(observed.objective, observed.wl, observed.wv, observed.f, observed.weight);
    if (!(observed.typical > 0))
        return Error{"samples", {}, "values within the largest angle", "some above 0", "none", ErrorCode::no_data};
    weigh(observed.objective, observed.typical, observed.wl, observed.wv, observed.f, observed.weight, threads);
    normalise(observed);

    auto prior = fit_ggx(observed, {k_most_ggx_lobes, threads});
    if (!prior) return prior.error();
    completed.prior = std::move(prior->unrounded);
    completed.most = k_most_excess * largest_measured(observed);
    for (std::size_t i = 0; i < rest.wl.size(); ++i) {
        const double area = double(rest.wl[i].z) * double(rest.wv[i].z);
        const Rgb expected = value(completed.prior, rest.wl[i], rest.wv[i]);
        Rgb r;
        for (int c = 0; c < 3; ++c)
            r[c] = float((std::cbrt(double(observed.f[i][c]) * area) - std::cbrt(double(expected[c]) * area)) / area);
        rest.colour.push_back(r);
    }
    make_index(rest);
    return completed;
}

Rgb value(const CompletedSamples& samples, Vec3f wl, Vec3f wv) {
    if (!(wl.z > 0 && wv.z > 0)) return {};
    const double area = double(wl.z) * double(wv.z);
    const Rgb expected = value(samples.prior, wl, wv), rest = signed_value(samples.rest, wl, wv);
    Rgb f;
    for (int c = 0; c < 3; ++c) {
        const double root = std::cbrt(std::min(double(expected[c]) * area, samples.most)) + double(rest[c]) * area;
        f[c] = float(std::clamp(root * root * root, 0.0, samples.most) / area);
    }
    return f;
}

}  // namespace srbf
