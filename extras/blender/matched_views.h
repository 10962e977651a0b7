// Pictures of a sphere that a sum of closures is fitted to.
#pragma once
#include <algorithm>

#include "extras/blender/closure_terms.h"
#include "srbf/brdf.h"

namespace SRBF_NAMESPACE {

using Colour = std::array<double, 3>;

/// A pixel of a picture of a sphere: Σ_i weight_i f(wl_i) cosθl_i over the directions of its view from `first` on.
struct MatchedPixel {
    std::size_t first;
    std::vector<double> weight;
    double fraction;                  ///< weight of the pixel in the loss
    Colour colour{}, limit{}, itp{};  ///< the measurement's colour; the limit of `shown`
};
/// The pixels of all lights at points of the sphere with one θv. The frame is the same as for `ClosureTerm`.
struct MatchedView {
    double theta, weight;
    Vec3d wv;
    std::vector<ClosureLight> lights;
    std::vector<double> pdf;    ///< density of each direction to the light [1/sr]
    std::vector<Rgb> radiance;  ///< f cosθl
    std::vector<MatchedPixel> pixels;
};

/// A colour as it is compared: a channel that is clipped at white in the reference ends at white.
inline Colour shown(const Colour& colour, const Colour& limit) {
    return {std::min(colour[0], limit[0]), std::min(colour[1], limit[1]), std::min(colour[2], limit[2])};
}

/// `count` views from the normal to the horizon with pixels under directional and extended lights. The fractions of
/// each kind sum to 1. Views without a measurement are left out.
std::vector<MatchedView> matched_views(const Evaluate& f, std::size_t count, int threads);

}  // namespace
