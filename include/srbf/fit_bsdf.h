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
    FitOutcome outcome;               ///< of its own model; without errors of pictures where patches were fitted
    /// Σ w (f − f̂)² / Σ w f², without beams: of averages over pairs of patches, w their projected solid angles; of
    /// other parts at pairs of directions within 80°, w both cosines.
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

/// Fits the parts of a two-sided measurement: those that are like their counterparts only once. A part of patches
/// is fitted to their averages (`patches.h`), any other like the measurement of a BRDF. Beams are kept as they are.
/// Errors: those of `fit`; a measurement of one side.
Result<BsdfOutcome> fit_bsdf(const Measured& measured, const FitRequest& request, const ProgressToken& progress = {});

/// Fits a BSDF that is given as functions in the parts' frames, none for those that are 0.
Result<BsdfOutcome> fit_bsdf(const std::array<Evaluate, k_parts>& parts, const FitRequest& request,
                             const ProgressToken& progress = {});

/// The sums that are fitted and measured of a matrix of patches: the mean of a function over pairs of them, as sums over points.
struct PatchSums {
    std::vector<Rgb> mean;       ///< of each class of pairs
    std::vector<double> weight;  ///< the product of their projected solid angles
    std::size_t points = 0;      ///< of each
    std::vector<Vec3f> wl, wv;   ///< classes × points
    /// The mean of `f` over the points of each.
    std::vector<Rgb> averages(const Evaluate& f) const;
    /// The weighted squared error ratio of these means, over all channels.
    double error_ratio(const Evaluate& f) const;
};
/// Points of each pair with which errors are measured.
inline constexpr std::size_t k_measured_points = 64;
/// `points` of each pair, uniform in the projected solid angles.
PatchSums sums_of(const KlemsTable& table, std::size_t points);

/// Fits a part to averages over patches. Squared errors of these averages, weighted by projected solid angles, are
/// minimised by expectation and maximisation: a fit to values at points within the patches, which are then replaced by
/// the fitted values plus the error of their average, and again. Directional-hemispherical sums count as radiances.
/// Without a number of lobes the smallest of some sizes is taken that is within 0.1 % of the data's Σ f² and within 1 %
/// or 0.001 of every directional-hemispherical sum.
Result<FitOutcome> fit_patches(const KlemsTable& table, const FitRequest& request, const ProgressToken& progress = {});

/// The directional-hemispherical sums of a matrix for each incident ring, of an anisotropic one for each incident patch,
/// and those of `f` and the part's beam for light from the middles of these patches.
std::vector<Hemispherical> hemispherical(const KlemsTable& table, const Evaluate& f, const Beams& beams, Part part);

}  // namespace srbf
