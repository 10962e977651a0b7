// The noise of a measurement, and the measurement smoothed to it.
#pragma once
#include "srbf/fitting.h"

namespace srbf {

/// The noise of f where it is dark, from its second differences over 3° of the light's direction: smooth values have
/// hardly any, independent noise of variance σ² has 3/2 σ². f may be negative or NaN.
Noise noise_of(const Evaluate& f);

/// Whether noise biases a fit that takes each value for what it is.
bool is_noisy(const Noise& noise);

/// The measurement smoothed to its noise: f − clamp(f − f̂, ±3σ), f̂ fitted to it. It is f̂ where the two differ by noise,
/// and keeps what f̂ lacks. f̂ comes from three short fits to f as it is, negative values included, whose weights come
/// from √(f² + 25 σ²) first and from the smoothed measurement then. `axial`: whether f is isotropic.
Result<Evaluate> smoothed(const Evaluate& f, const Noise& noise, bool axial, int threads,
                          const ProgressToken& progress);

}  // namespace srbf
