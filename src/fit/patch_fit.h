// Fits of tables whose entries are averages over patches.
#pragma once
#include "srbf/fit.h"

SRBF_BEGIN

/// A part takes the model of its counterpart if the squared error ratio between the two is at most this.
inline constexpr double k_same_part = 1e-4;

/// The way to fit tables of one type whose entries are averages, not values at pairs of directions.
struct PatchFit {
    std::string_view fitted;  ///< what is fitted, for messages: "patches"
    bool (*is_of)(const Measured& part);
    Result<FitOutcome> (*fit)(const Measured& part, const FitRequest& request, const ProgressToken& progress);
    /// Σ w (f − f̂)² / Σ w f² of a function (`PartFit`).
    double (*error_ratio)(const Measured& part, const Evaluate& f);
    /// Directional-hemispherical sums of the table, and of a function with the part's beam.
    std::vector<Hemispherical> (*hemispherical)(const Measured& data, const Evaluate& f, const Beams& beams, Part part);
};
/// Ends beams of reflections at 90°, where they have the light that `parts` do not scatter at the last ring. A beam
/// that ends there, or in 0, stays.
void end_mirrors(Beams& beams, const std::array<Evaluate, k_parts>& parts);
/// The way to fit a part; null: it is fitted to its values, as the measurement of a BRDF.
const PatchFit* patch_fit_of(const Measured& part);

SRBF_END
