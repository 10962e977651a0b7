// Weights of pairs: the objectives.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "observe/costs.h"
#include "observe/observations.h"
#include "srbf/elementary.h"

namespace srbf {

/// Definition of an objective: a row of the table in pair_weights.cpp.
struct ObjectiveTraits {
    Objective objective;
    std::string_view name, summary;
    double Measures::*measure;  ///< that it minimises
    double max_theta;           ///< default θmax [degrees]
    /// The weight of (f−f̂)² per solid angle of both directions, for a pair with mean `f` over its channels; `typical`
    /// is their `typical_value`.
    double (*weight)(double f, double typical, double cos_l, double cos_v);
    /// Weights that are added for pairs which `weight` alone neglects: an error of 100 % everywhere adds to Σ w |f|²
    /// the share `importance` of it.
    struct Further {
        std::string_view name = {}, error_of = {};  ///< as `srbf explain` says them
        double (*weight)(double f, double typical, double cos_l, double cos_v) = nullptr;
        double importance = 0;
    };
    std::array<Further, 2> further{};  ///< null: none
    /// The g of an objective Σ (g(f) − g(f̂))² whose weights, squares of its slope, hold for small errors only;
    /// `weigh_large_errors` corrects them elsewhere. null: weights hold for errors of any size.
    double (*seen)(double f, double typical, double cos_l) = nullptr;
    double (*slope)(double f, double typical, double cos_l) = nullptr;
    /// Over decades, where a sample on the flank of a peak determines its width: lobes may be narrower than the samples
    /// are apart, and between samples a fit follows microfacets (`FacetMixture`), not interpolated values.
    bool of_scatter = false;
    bool of_pictures = false;  ///< relative to f cosθl, the radiance seen under a light; also observes extended lights
};
const ObjectiveTraits& traits(Objective objective);

/// The value to which an objective's weights are relative: the mean f, or for an objective of pictures the upper
/// quartile of f cosθl, weighted by cosθv, which a display exposed for the picture shows as bright. f by its mean over
/// the channels; `weight`: solid angles of the pairs. 0 if all of f is 0.
double typical_value(Objective objective, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<const Rgb> f,
                     std::span<const double> weight);

/// Multiplies the weights of pairs (their solid angles) by the weights of the objective.
void weigh(Objective objective, double typical, std::span<const Vec3f> wl, std::span<const Vec3f> wv,
           std::span<const Rgb> f, std::span<double> weight, int threads);

}  // namespace srbf
