// Noise of which the maker of a table set what was below 0 to 0.
#pragma once
#include "srbf/measured.h"

namespace SRBF_NAMESPACE {

/// The standard deviation of the noise of a table's samples [1/sr], of each channel, before those below 0 were set to
/// 0; 0 of a channel where nothing suggests that: fewer than 1 % of its samples are 0 beside others above 0, or some
/// are negative. Only of layouts whose samples are independent along an azimuth: MERL's and MBSDF's. With t = m / σ,
/// samples max(0, m + n) of normal noise n have a mean and a variance whose quotient depends on t alone:
///   mean = σ (φ(t) + t Φ(t)),  mean of squares = σ² ((1 + t²) Φ(t) + t φ(t)),
/// so that σ follows from the mean of neighbours and their second differences; the result is the median over darker
/// ones.
Rgb clamped_deviation(const Measured& measured);

/// E[max(0, m + n)] − m ≥ 0: how much too bright m is in such a table, with m ≥ 0 and a deviation ≥ 0.
float clamped_excess(float m, float deviation);
/// The m ≥ 0 that has this E[max(0, m + n)]; 0 for less than that of 0.
float unclamped(float mean, float deviation);

}  // namespace srbf
