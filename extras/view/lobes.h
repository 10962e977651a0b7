// Lobes of a model under light from one direction, and slices through BRDFs.
#pragma once
#include <vector>

#include "srbf/brdf.h"
#include "srbf/model.h"

namespace SRBF_NAMESPACE {

/// The hemisphere of view directions: `k_rings` + 1 rings of constant θv, from the normal to 89.5°, with
/// `k_ring_azimuths` azimuths each.
inline constexpr int k_rings = 36, k_ring_azimuths = 96;
std::vector<Vec3f> view_directions();

/// A lobe as a function of wv, under light from wl.
struct LobeSlice {
    Vec3f centre;      ///< wv of its maximum
    Rgb peak;          ///< f_r at the maximum [1/sr]
    double width = 0;  ///< half angle [rad] of the cap whose solid angle is that where f_r ≥ half the maximum
    double share = 0;  ///< fraction of the luminance of ∫ f cosθv dωv; all lobes sum to 1
    std::vector<float> relative;  ///< luminance over that of the peak, at `view_directions`
};
/// The lobes that reflect light from wl, by decreasing share. The lobes of a view-by-view model with sampled views
/// are functions of the light, so for them light and view are exchanged: `wl` is the view direction and the lobes
/// are over wl.
std::vector<LobeSlice> lobe_slices(const Model& model, Vec3f wl);
bool is_over_lights(const Model& model);

/// f |cosθv| for light at θl, in a plane through the normal that is rotated by φ from the plane of incidence.
/// `angle` runs from −89° to 89° and is positive on the side of the mirror direction for φ = 0. For a BSDF it also
/// runs from 91° to 269°, where 180° is the normal of the back.
struct Slice {
    std::vector<float> angle;  ///< [rad]
    std::vector<Rgb> f;        ///< f |cosθv| [1/sr]; NaN where nothing was measured
    bool both_sides = false;
    float most() const;  ///< maximum over values and channels
};
Slice slice(const Evaluate& f, double theta_l, double phi, bool both_sides);

}  // namespace srbf
