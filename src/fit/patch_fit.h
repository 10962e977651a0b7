// Fits of tables whose entries are averages over patches.
#pragma once
#include "srbf/fit.h"

SRBF_BEGIN

/// A part takes the model of its counterpart if the squared error ratio between the two is at most this.
inline constexpr double k_same_part = 1e-4;

/// The way to fit tables of one type whose entries are averages, not values at pairs of directions.
struct PatchFitter {
    std::string_view fitted;  ///< what is fitted, for messages: "patches"
    bool (*is_of)(const Measured& part);
    Result<FitOutcome> (*fit)(const Measured& part, const FitRequest& request, const ProgressToken& progress);
    /// Σ w (f − f̂)² / Σ w f² of a function (`PartFit`).
    double (*error_ratio)(const Measured& part, const Evaluate& f);
    /// Directional-hemispherical sums of the table, and of a function with the part's beam.
    std::vector<Hemispherical> (*hemispherical)(const Measured& data, const Evaluate& f, const Beams& beams, Part part);
};
/// Adds a ring at 90° to each beam of a reflection: its τ is 1 minus the albedo of `parts` at the beam's last ring. A
/// beam whose last ring is at 90°, or is 0, does not change.
void end_mirrors(Beams& beams, const std::array<Evaluate, k_parts>& parts);
/// The way to fit a part; null: it is fitted to its values, as the measurement of a BRDF.
const PatchFitter* patch_fit_of(const Measured& part);

SRBF_END
