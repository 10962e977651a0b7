// The noise of a measurement, and the measurement smoothed to it.
#pragma once
#include "srbf/fit.h"

namespace SRBF_NAMESPACE {

/// The noise of f where it is dark, from its second differences over 3° of the light's direction: smooth values have
/// hardly any, independent noise of variance σ² has 3/2 σ². f may be negative or NaN.
Noise noise_of(const Evaluate& f);

/// True if noise biases a fit to the values as they are: if it is large, or if it makes values negative.
bool is_noisy(const Noise& noise);

/// The deviation relative to the value, by means over the channels; 0 where the value is not above 0.
inline double fraction_of(const Noise& noise) {
    const auto sum = [](const Rgb& x) { return double(x.r) + double(x.g) + double(x.b); };
    return sum(noise.level) > 0 ? sum(noise.deviation) / sum(noise.level) : 0;
}
/// The largest deviation of a channel relative to its value; infinite for noise about a value that is not above 0.
double largest_fraction(const Noise& noise);

/// f smoothed to its noise: f − λ clamp(f − f̂, ±3σ). It is f̂ where the two differ by noise, and keeps features that
/// f̂ lacks. λ = min(1, σ²/ρ²) is the fraction of the difference f − f̂, whose deviation is ρ in the dark, that is
/// noise. f̂ comes from short fits to f as it is, negative values included, whose weights come from √(f² + 25 σ²) first
/// and from the smoothed f then. `axial`: true if f is isotropic.
Result<Evaluate> smoothed(const Evaluate& f, const Noise& noise, bool axial, int threads,
                          const ProgressToken& progress);

}  // namespace
