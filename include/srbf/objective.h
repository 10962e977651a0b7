// The loss that a fit minimises, and why it stops.
#pragma once
#include <string_view>

#include "srbf/metrics.h"

SRBF_BEGIN

/// The loss that a fit minimises over the pairs within θmax. Each objective corresponds to a measure of metrics.h.
enum class Objective {
    raw,  ///< Σ (f−f̂)²
    /// Σ (f cosθl − f̂ cosθl)² cosθv; for a multivariate model plus 0.005 times the cube-root weights, times cosθl
    /// cosθv
    cosine,
    // The next three are second-order approximations in f − f̂, with the mean of the channels in place of each channel:
    log,        ///< Σ (log(1 + f cosθl) − log(1 + f̂ cosθl))² cosθv
    cube_root,  ///< Σ (∛f − ∛f̂)²; where f is below a hundredth of its mean, with the weight at that value
    /// Σ (log f − log f̂)² over what is above 0: an error of a tenth counts alike in the dark and in a peak
    relative,
    /// Errors of pictures: Σ (⁶√(f cosθl + s) − ⁶√(f̂ cosθl + s))² cosθv, s = k_dark_share times the upper
    /// quartile q of f cosθl; as much of Σ (∛(f cosθl + q) − ∛(f̂ cosθl + q))² √cosθv and 0.03 of cosine's sum, each
    /// scaled to Σ w |f|² = 1; and for a multivariate model ΔE_ITP of pictures of a sphere. The eye's response to a
    /// display is about the sixth root of its luminance (the exponent 0.159 of the perceptual quantiser, ITU-R BT.2100).
    appearance,
};
inline constexpr Objective k_default_objective = Objective::appearance;
inline constexpr double k_dark_share = 0.07;
std::string_view name(Objective objective);
/// The measure that an objective minimises and by which its fits are judged.
double error_of(const Measures& measures, Objective objective);
/// Default θmax of the fit and of its measures [rad]: 80° for raw, cube-root and relative, 89° for the others.
double default_max_theta(Objective objective);

enum class StopReason {
    converged,   ///< the last steps predicted a relative decrease below 1e-7, or none lowered the sum
    iterations,  ///< the iteration limit was reached while steps still lowered the sum, possibly by too little to go on
    cancelled,   ///< by the progress token; the model is the best so far
};
std::string_view name(StopReason reason);

SRBF_END
