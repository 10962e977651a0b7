// A picture of a sphere under the default lights of all pictures.
#pragma once
#include <vector>

#include "extras/render/scene.h"
#include "extras/render/tone.h"
#include "srbf/brdf.h"

namespace SRBF_NAMESPACE {

/// Options of a sphere in a square image, seen from (0,0,1) in orthographic projection.
struct SphereOptions {
    int size = 320;   ///< pixels per side, ≥ 1
    int samples = 4;  ///< a pixel is the mean of samples × samples uniformly spaced points; ≥ 1
    int threads = 0;  ///< 0: as many as the machine has; the image does not depend on it
    static constexpr double k_radius = 0.92;  ///< radius of the sphere, relative to half the image's side
};

/// The radiance of the sphere towards the viewer,
///   L = Σ_k f(wl_k, wv) max(0, n·l_k) E_k  over `k_three_lights`, x right, y up, z to the viewer,
/// averaged over the points of a pixel that lie on the sphere; 0 if there are none. The local frame is
/// `surface_frame`, which has no seam on the visible half. A pixel is NaN if f is NaN at one of its lit points
/// (n·l_k > 0).
Image render_sphere(const Evaluate& f, const SphereOptions& options);
/// The fraction of each pixel's points that lie on the sphere.
std::vector<float> sphere_coverage(const SphereOptions& options);

}  // namespace srbf
