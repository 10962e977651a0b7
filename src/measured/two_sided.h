// Beams of two-sided measurements: private to readers and fits.
#pragma once
#include <span>

#include "srbf/measured.h"

namespace srbf {

/// True if two shares of a beam count as one: they differ by no more than a fit differs from a sum.
bool are_same_share(const Rgb& a, const Rgb& b);
Rgb mean_share(std::span<const Rgb> shares);
/// If the beams of both transmissions are one by reciprocity, their mean is that of the front, and the back's is empty.
void unite_transmissions(Beams& beams);

}  // namespace srbf
