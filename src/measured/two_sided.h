// Beams of two-sided measurements, for readers and fits.
#pragma once
#include "srbf/measured.h"

namespace SRBF_NAMESPACE {

/// True if two shares of a beam are equal within the accuracy of a fit: 1 % of their mean, or 0.001.
bool are_same_share(const Rgb& a, const Rgb& b);
Rgb mean_share(std::span<const Rgb> shares);
/// If the beams of both transmissions are reciprocal, sets the front's to their mean, and the back's to none.
void unite_transmissions(Beams& beams);

}  // namespace srbf
