// The mean of a measurement and of its transpose, which a reciprocal model is fitted to.
#pragma once
#include "srbf/brdf.h"

namespace SRBF_NAMESPACE {

/// (cosθv f(ωl, ωv) + cosθl f(ωv, ωl)) / (cosθv + cosθl) [1/sr]. Instruments
/// measure f cosθ; this averages the measured signals, so the value with the larger cosine counts most.
/// Where only one of the two was measured, the mean is that one.
Evaluate reciprocal_mean(Evaluate f);
Channels reciprocal_mean(Channels f);

}  // namespace srbf
