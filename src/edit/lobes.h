// Edits of lobes that need no fit.
#pragma once
#include "srbf/edit.h"

namespace srbf {

/// The shares of lobes that belong to the body, or to the highlight.
PmModel part_of(PmModel model, bool body);

PmModel tinted(PmModel model, const Tint& tint);
PmModel saturated(PmModel model, double factor);
PmModel turned(PmModel model, double hue);     ///< [rad]
PmModel rotated(PmModel model, double angle);  ///< [rad]
/// All coefficients times `factor`.
PmModel scaled(PmModel model, float factor);
/// The lobes begin a refit of a highlight widened by this factor: bandwidths and further exponents of the highlight's
/// lobes.
PmModel widened(PmModel model, double factor);

/// The model with another variate, which no lobe depends on.
PmModel with_variate(PmModel model, Parameterization variate);
/// The lobes of both. Variates that both have are shared; the result may have more than k_most_variates.
PmModel joined(PmModel a, PmModel b);

}  // namespace srbf
