// Weights of pairs, which define the objectives.
#pragma once
#include "observe/observations.h"
#include "srbf/elementary.h"
#include "srbf/metrics.h"

SRBF_BEGIN

/// Definition of an objective: a row of the table in pair_weights.cpp.
struct ObjectiveTraits {
    Objective objective;
    std::string_view name, summary;
    double Measures::*measure;  ///< the measure that the objective minimises
    double max_theta;           ///< default θmax [degrees]
    /// The weight of (f−f̂)² per solid angle of both directions, for a pair whose mean over the channels is `f`.
    /// `typical` is the `typical_value` of the pairs.
    double (*weight)(double f, double typical, double cos_l, double cos_v);
    /// Weights added for pairs that `weight` alone neglects. With them, an error of 100 % everywhere adds
    /// `importance` times Σ w |f|² to the loss.
    struct FurtherWeight {
        double (*weight)(double f, double typical, double cos_l, double cos_v) = nullptr;
        double importance = 0;
    };
    std::array<FurtherWeight, 2> further{};  ///< a null `weight`: unused
    /// The function g of an objective Σ (g(f) − g(f̂))², and its derivative. The weights, squares of the derivative, hold
    /// for small errors, and `weigh_large_errors` corrects them elsewhere. Null: they hold for errors of any size.
    double (*response)(double f, double typical, double cos_l) = nullptr;
    double (*response_slope)(double f, double typical, double cos_l) = nullptr;
    /// True for values over decades, where a sample on the flank of a peak determines its width. Lobes may be narrower
    /// than the spacing of samples, between which a fit follows microfacets (`FacetMixture`), not interpolated values.
    bool is_for_scatter = false;
    /// true if weights are relative to f cosθl, the radiance under a directional light, and extended lights are observed
    bool uses_pictures = false;
};
const ObjectiveTraits& traits(Objective objective);

/// The value to which an objective's weights are relative: the mean of f. For an objective of pictures it is the
/// upper quartile of f cosθl, weighted by cosθv, which appears bright on a display exposed for the picture. Here f
/// is the mean over the channels; `weight` holds solid angles of the pairs. 0 if all of f is 0.
double typical_value(Objective objective, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<const Rgb> f,
                     std::span<const double> weight);

/// Multiplies the weights of pairs, which are their solid angles, by the weights of the objective.
void weigh(Objective objective, double typical, std::span<const Vec3f> wl, std::span<const Vec3f> wv,
           std::span<const Rgb> f, std::span<double> weight, int threads);

/// Models with few parameters, such as Lambert and GGX, leave large residuals. Their weights adapt to them in this
/// many rounds, each by at most this factor.
inline constexpr int k_facet_rounds = 8;
inline constexpr double k_max_facet_change = 100;

/// Multiplies the weights of the fitted observations by `large_error_weight`, given the values of the fit. Applies
/// only to observations both of whose cosines are at least `min_cos`.
void weigh_large_errors(Observations& observations, const Evaluate& fitted, double max, float min_cos = 0);

std::span<const Objective> objectives();        ///< all objectives
std::string_view summary(Objective objective);  ///< what it minimises, a line in ASCII
std::optional<Objective> objective_named(std::string_view text);
/// The measure that an objective minimises and by which its fits are judged.
double Measures::*measure_of(Objective objective);

SRBF_END
