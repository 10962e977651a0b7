// Microfacets of any distribution, fitted to scattered samples.
#pragma once
#include <span>
#include <vector>

#include "observe/observations.h"

namespace srbf {

/// Lambert and a lobe of GGX of each roughness α_r, 1/1024 to 1 in half octaves: in channel c
///   f_c = k_c / π + Σ_r ggx_facets(α_r) (F0_rc (1 − s) + F90_rc s) [1/sr], s = (1 − l·h)⁵.
/// All numbers but the α_r are found by one non-negative linear problem, of which most are 0: it has one minimum, whatever
/// the seed, and continues scans to other angles of incidence as microfacets do, whatever the distribution of their normals.
struct FacetMixture {
    std::vector<std::vector<float>> amounts;  ///< of each channel: k, then F0_r, F90_r of each roughness
    double most = 0;                          ///< bound of f cosθl cosθv, as for fits
};
/// By the weights of the observations, adapted to large errors. Channels: R, G, B, then the wavelengths of spectral
/// observations.
FacetMixture fit_facets(const Observations& samples);
/// f of each channel [1/sr]; 0 below the horizon.
void evaluate(const FacetMixture& mixture, Vec3f wl, Vec3f wv, std::span<float> f);

}  // namespace srbf
