// Edits of lobes, and edits that are functions of directions, which lobes are then fitted to.
#pragma once
#include "srbf/edit.h"

namespace SRBF_NAMESPACE {

/// The fractions of lobes that belong to the highlight, and to the body.
struct HighlightAndBody {
    PmModel highlight, body;
};
HighlightAndBody separate_highlight(const PmModel& model);

PmModel tinted(PmModel model, const Tint& tint);
PmModel saturated(PmModel model, double factor);
PmModel turn_hue(PmModel model, double hue);   ///< [rad]
PmModel rotated(PmModel model, double angle);  ///< [rad]
/// All coefficients times `factor`.
PmModel scaled(PmModel model, float factor);
/// Lobes from which a refit of a highlight that is widened by this factor begins: bandwidths and further exponents of
/// the highlight's lobes are changed.
PmModel widened(PmModel model, double factor);

/// The lobes of both. Variates that both have are shared; the result may have more than k_max_variates.
PmModel join_lobes(PmModel a, PmModel b);

/// α of the GGX facets that have the highlight's median slope of half vectors, with light and viewer 30° from the half
/// vector and across its tilt, where masking hardly matters; 0 if the highlight is black.
double roughness_of(const Evaluate& highlight);

/// The highlight with slopes of half vectors `factor` times as large. At half vector h its value is
///   f(l₀, v₀) facets(l, v; factor α) / facets(l₀, v₀; α),
/// with facets = D G / (4 cosθl cosθv) of GGX, and (l₀, v₀) about the half vector of h's azimuth and its slope over
/// `factor`, at the same l·h and, as far as both are above the horizon, the same azimuth about it. For GGX facets with
/// roughness α the result is exactly GGX with `factor` α. It is symmetric if f is.
Evaluate apply_roughening(Evaluate highlight, double factor, double roughness);

/// The surface `base` under a coat, see `Coat`.
Evaluate apply_coat(Evaluate base, const Coat& coat);

/// Fits `lobes` lobes to f. It begins with the best of the models `begin`, at least one, all of one form and
/// parameterization: without the least useful lobes if it has more, and with the best of many random ones if it has
/// fewer. The albedo is at most `albedo_limit`. Returns an error if `observe` or `fit_pm` does.
Result<PmModel> refit(const Evaluate& f, std::span<const PmModel> begin, int lobes, double albedo_limit,
                      const EditOptions& options);

}  // namespace
