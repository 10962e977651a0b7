// Fits of both sides of a surface, part by part.
#pragma once
#include <array>
#include <optional>
#include <vector>

#include "srbf/fit.h"

SRBF_BEGIN

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

/// Fits the parts of a two-sided measurement: those that are like their counterparts, with a squared error ratio of at
/// most 1e-4, only once. A part is fitted like the measurement of a BRDF; patches are fitted to their sums. Beams are
/// kept as they are. Errors: those of `fit`; a measurement of one side.
Result<BsdfOutcome> fit_bsdf(const Measured& measured, const FitRequest& request, const ProgressToken& progress = {});

/// Fits a BSDF that is given as functions in the parts' frames, none for those that are 0.
Result<BsdfOutcome> fit_bsdf(const std::array<Evaluate, k_parts>& parts, const FitRequest& request,
                             const ProgressToken& progress = {});

SRBF_END
