// Edits of lobes that need no fit.
#pragma once
#include "srbf/edit.h"

namespace SRBF_NAMESPACE {

/// The shares of lobes that belong to the highlight, and to the body.
struct HighlightAndBody {
    PmModel highlight, body;
};
HighlightAndBody separated(const PmModel& model);

PmModel tinted(PmModel model, const Tint& tint);
PmModel saturated(PmModel model, double factor);
PmModel turned(PmModel model, double hue);     ///< [rad]
PmModel rotated(PmModel model, double angle);  ///< [rad]
/// All coefficients times `factor`.
PmModel scaled(PmModel model, float factor);
/// The lobes begin a refit of a highlight widened by this factor: bandwidths and further exponents of the highlight's
/// lobes.
PmModel widened(PmModel model, double factor);

/// The lobes of both. Variates that both have are shared; the result may have more than k_most_variates.
PmModel joined(PmModel a, PmModel b);

}  // namespace srbf
