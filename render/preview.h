// A picture to judge a fit by: three spheres, measured, fitted, and how they differ: level 6.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "render/image.h"
#include "render/scene.h"
#include "srbf/brdf.h"

namespace srbf {

/// A sphere in a square picture, seen from (0,0,1) without perspective.
struct SphereOptions {
    int size = 320;   ///< pixels along a side, ≥ 1
    int samples = 4;  ///< a pixel is the mean of samples × samples points, evenly spread; ≥ 1
    int threads = 0;  ///< 0: as many as the machine has; the picture does not depend on it
    static constexpr double k_radius = 0.92;  ///< of the sphere, where 1 touches the picture's border
};

/// The radiance of the sphere towards the viewer,
///   L = Σ_k f(wl_k, wv) max(0, n·l_k) E_k  over `k_three_lights`, x right, y up, z to the viewer,
/// averaged over those points of a pixel that lie on the sphere; 0 where none does. The local frame is `surface_frame`, which
/// has no seam on the visible half. A pixel is NaN where f is NaN at one of its lit points (n·l_k > 0).
Image render_sphere(const Evaluate& f, const SphereOptions& options);
/// The share of each pixel's points that lie on the sphere.
std::vector<float> sphere_coverage(const SphereOptions& options);

struct PreviewOptions {
    int size = 320;   ///< pixels along a side of each sphere's square, ≥ 16
    int samples = 4;  ///< as in SphereOptions
    int threads = 0;  ///< likewise
    std::array<std::string, 3> captions{"measured", "fit", "10 x difference"};
};

/// Three squares side by side, a caption in a strip of max(12, size/8) rows below each: the sphere of `measured`, that of
/// `fit`, and 10 |L − L̂| of their radiances, channel by channel. All are shown at one exposure, automatic_exposure of the
/// first. The background is a neutral grey; `k_not_measured` marks pixels without a measurement.
Image8 preview(const Evaluate& measured, const Evaluate& fit, const PreviewOptions& options = {});

}  // namespace srbf
