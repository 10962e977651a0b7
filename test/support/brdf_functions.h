// BRDFs made of functions of a pair of directions, and errors of one BRDF against another.
#pragma once
#include "brdf/values.h"
#include "errors/measures.h"
#include "srbf/metrics.h"

namespace srbf {

/// The BRDF with the value f(wl, wv) at each pair.
template <typename F> Evaluate pairwise(F f) {
    return [f = std::move(f)](std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> values) {
        for (std::size_t i = 0; i < values.size(); ++i) values[i] = f(wl[i], wv[i]);
    };
}

inline Rgb grey(double value) { return {float(value), float(value), float(value)}; }

inline Evaluate constant_brdf(const Rgb& value) {
    return pairwise([value](Vec3f, Vec3f) { return value; });
}

/// `brdf` with `change` applied to each value.
template <typename Change> Evaluate with_values(Evaluate brdf, Change change) {
    return [=](std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> values) {
        brdf(wl, wv, values);
        for (Rgb& f : values) f = change(f);
    };
}

/// Objectives, each with the measure that it minimises.
inline constexpr std::pair<Objective, double Measures::*> k_objective_measures[] = {
    {Objective::raw, &Measures::squared_error_ratio},
    {Objective::cosine, &Measures::squared_error_ratio_cosine},
    {Objective::log, &Measures::log_rms_cosine},
    {Objective::cube_root, &Measures::cube_root_error_ratio},
    {Objective::relative, &Measures::log10_rms}};

/// The measures of one BRDF against the reference at held-out pairs up to `max_theta`.
inline Measures heldout_measures(const Evaluate& reference, const Evaluate& brdf, double max_theta = 80 * k_degree,
                                 std::uint64_t pairs = k_heldout_pairs) {
    const Channels channels[] = {rgb_channels(brdf)};
    return measure_heldout(rgb_channels(reference), channels, {max_theta}, pairs)[0];
}

}  // namespace srbf
