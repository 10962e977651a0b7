// A microfacet model with a free distribution of normals, fitted to scattered samples.
#pragma once
#include <vector>

#include "observe/observations.h"

namespace SRBF_NAMESPACE {

/// Lambert and one GGX lobe for each roughness α_r, from 1/1024 to 1 in half octaves: in channel c
///   f_c = k_c / π + Σ_r ggx_facets(α_r) (F0_rc (1 − s) + F90_rc s) [1/sr], s = (1 − l·h)⁵.
/// All amounts solve one non-negative linear problem, and most of them become 0. It has one minimum, whatever the seed.
/// It continues scans to other angles of incidence as microfacets do, whatever the distribution of their normals.
struct FacetMixture {
    std::array<std::vector<float>, 3> amounts;  ///< amounts of each channel: k, then F0_r, F90_r of each roughness
    double bound = 0;                           ///< bound on f cosθl cosθv, as for fits, if the Lambert term is less
};
/// Fits with the weights of the observations, adapted to the residuals.
FacetMixture fit_facets(const Observations& samples);
/// f [1/sr]; 0 below the horizon.
Rgb value(const FacetMixture& mixture, Vec3f wl, Vec3f wv);

}  // namespace
