// Fits of both sides of a surface, part by part.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "srbf/fit.h"

namespace [[gnu::visibility("default")]] srbf {

/// Light that leaves a surface for a direction of the incident light.
struct Hemispherical {
    double theta = 0;     ///< of the incident light [rad]
    double phi = 0;       ///< its azimuth in the part's frame [rad]
    double measured = 0;  ///< Σ over outgoing directions of f cosθ dω, with the beam; green [1]
    double fitted = 0;
};

/// The fit of a part.
struct PartFit {
    Part part = Part::reflection_front;
    std::optional<Part> answered_by;  ///< the part that answers for it too; none: it has a model of its own
    bool black = false;               ///< all values are 0
    FitOutcome outcome;  ///< of its own model; without errors of pictures where its table says how it is fitted
    /// Σ w (f − f̂)² / Σ w f², without beams: at pairs of directions within 80°, w both cosines,
    /// unless the table is fitted in a way of its own.
    double squared_error_ratio = 0;
    std::vector<Hemispherical> hemispherical;
};

struct BsdfOutcome {
    Model model;
    std::vector<PartFit> parts;
    double fit_seconds = 0;
    /// The largest Σ of reflection and transmission of an angle of incidence, measured and fitted.
    double most_measured = 0, most_fitted = 0;
};

/// A part counts as answered by its counterpart if the squared error ratio between the two is at most this.
inline constexpr double k_same_part = 1e-4;

/// Fits the parts of a two-sided measurement: those that are like their counterparts only once. A part is
/// fitted like the measurement of a BRDF, unless its table says how (`OwnFit`). Beams are kept as they are.
/// Errors: those of `fit`; a measurement of one side.
Result<BsdfOutcome> fit_bsdf(const Measured& measured, const FitRequest& request, const ProgressToken& progress = {});

/// Fits a BSDF that is given as functions in the parts' frames, none for those that are 0.
Result<BsdfOutcome> fit_bsdf(const std::array<Evaluate, k_parts>& parts, const FitRequest& request,
                             const ProgressToken& progress = {});

/// How a table is fitted that is not fitted to its values at pairs of directions.
struct OwnFit {
    std::string_view fitted;  ///< in messages, what is fitted: "patches"
    std::function<Result<FitOutcome>(const FitRequest&, const ProgressToken&)> fit;
    /// Σ w (f − f̂)² / Σ w f² of a function (`PartFit`).
    std::function<double(const Evaluate&)> error_ratio;
    /// Directional-hemispherical sums of the table, and of a function with the part's beam.
    std::function<std::vector<Hemispherical>(const Evaluate&, const Beams&, Part)> hemispherical;
};
/// How a part is fitted; null: to its values, as the measurement of a BRDF.
const OwnFit* own_fit_of(const Measured& part);

}  // namespace srbf
