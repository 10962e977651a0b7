// Lobes of a model under light from one direction; slices through BRDFs.
#pragma once
#include <vector>

#include "srbf/brdf.h"
#include "srbf/model.h"

namespace srbf {

/// The hemisphere of view directions in rings of constant θv, `k_rings` + 1 from the normal to 89.5°, with `k_around`
/// azimuths each.
inline constexpr int k_rings = 36, k_around = 96;
std::vector<Vec3f> view_directions();

/// A term as a function of wv under light from wl.
struct SeenLobe {
    Vec3f centre;                 ///< wv of its maximum
    Rgb peak;                     ///< f_r there [1/sr]
    double width = 0;             ///< [rad] of the cap with the solid angle in which it is at least half its maximum
    double share = 0;             ///< of the luminance of ∫ f cosθv dωv; all terms sum to 1
    std::vector<float> relative;  ///< its luminance over that of its peak, at `view_directions`
};
/// The lobes that reflect light from wl, by decreasing share. The lobes of a view-by-view model with sampled views are
/// functions of the light: they are over wl, for the given view direction, with light and view exchanged in the above.
std::vector<SeenLobe> seen_lobes(const Model& model, Vec3f wl);
bool is_seen_over_lights(const Model& model);

/// f |cosθv| for light at θl in a plane through the normal, turned by φ from that of incidence: `angle` from −89° to 89°,
/// positive on the mirror direction's side for φ = 0; of a BSDF also from 91° to 269°, where 180° is the normal of
/// the back.
struct Slice {
    std::vector<float> angle;  ///< [rad]
    std::vector<Rgb> f;        ///< f |cosθv| [1/sr]; NaN: not measured
    bool both_sides = false;
    float most() const;  ///< maximum over values and channels
};
Slice slice(const Evaluate& f, double theta_l, double phi, bool both_sides);

}  // namespace srbf
