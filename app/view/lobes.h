// What a model is made of, as seen under light from one direction; slices through BRDFs.
#pragma once
#include <vector>

#include "srbf/brdf.h"
#include "srbf/model.h"

namespace srbf {

/// Models of one term each whose sum is `model`: lobes of either fitted kind; of Lambert and GGX the diffuse term and each lobe. At most
/// `most` of them, of a multivariate model those of the largest coefficients; the others are left out.
std::vector<Model> terms_of(const Model& model, std::size_t most = 64);

/// The hemisphere of view directions in rings of constant θv, `k_rings` + 1 from the normal to 89.5°, each of `k_around` azimuths.
inline constexpr int k_rings = 36, k_around = 96;
std::vector<Vec3f> view_directions();

/// A term as a function of wv under light from wl.
struct SeenLobe {
    Vec3f centre;                 ///< wv where it is largest
    Rgb peak;                     ///< f_r there [1/sr]
    double width = 0;             ///< [rad] of the cap whose solid angle is that where it is at least half as large
    double share = 0;             ///< of the luminance of ∫ f cosθv dωv, all terms together 1
    std::vector<float> relative;  ///< its luminance over that of its peak, at `view_directions`
};
/// Those that reflect anything under that light, by their share, largest first. The lobes of a view-by-view model that samples views are
/// functions of the light: theirs are over wl, seen from the direction given, and light and view change places in the above.
std::vector<SeenLobe> seen_lobes(const Model& model, Vec3f wl);
bool is_seen_over_lights(const Model& model);

/// f_r cosθv in the plane of incidence, light at θl: `angle` from −89° to 89°, positive on the mirror direction's side.
struct Slice {
    std::vector<float> angle;  ///< [rad]
    std::vector<Rgb> f;        ///< f_r cosθv [1/sr]; NaN: not measured
    float most() const;        ///< the largest value of a channel
};
Slice slice(const Evaluate& brdf, double theta_l);

}  // namespace srbf
