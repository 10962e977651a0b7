#pragma once
#include "srbf/brdf.h"

namespace SRBF_NAMESPACE {

/// True if f(Rωl, Rωv) = f(ωl, ωv) for rotations R about the normal, up to rounding or noise, over θ ≤ max_theta [rad]:
/// the mean squared change of f cosθl cosθv under random rotations is at most 1e-6 of the mean square of f cosθl cosθv,
/// or at most 2 % of it and at most 2.5 times the change under rotation by 15°. Independent noise of the standard
/// deviation `noise` [1/sr] of each channel changes as much as it does by itself.
bool is_isotropic(const Evaluate& f, double max_theta, const Rgb& noise = {});

}  // namespace srbf
