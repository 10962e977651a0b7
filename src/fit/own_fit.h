// Fits of tables whose entries are averages over patches.
#pragma once
#include <functional>
#include <string_view>
#include <vector>

#include "srbf/fit_bsdf.h"

SRBF_BEGIN

/// A part takes the model of its counterpart if the squared error ratio between the two is at most this.
inline constexpr double k_same_part = 1e-4;

/// The fit of a table that is not fitted to values at pairs of directions.
struct OwnFit {
    std::string_view fitted;  ///< the fitted things, for messages: "patches"
    std::function<Result<FitOutcome>(const FitRequest&, const ProgressToken&)> fit;
    /// Σ w (f − f̂)² / Σ w f² of a function (`PartFit`).
    std::function<double(const Evaluate&)> error_ratio;
    /// Directional-hemispherical sums of the table, and of a function with the part's beam.
    std::function<std::vector<Hemispherical>(const Evaluate&, const Beams&, Part)> hemispherical;
};
/// Ends beams of reflections at 90°, where they have the light that `parts` do not scatter at the last ring. A beam that
/// ends there, or in 0, stays.
void end_mirrors(Beams& beams, const std::array<Evaluate, k_parts>& parts);
/// The fit of a part; null if it is fitted to values, as a BRDF is.
const OwnFit* own_fit_of(const Measured& part);

SRBF_END
