// Fits of texels with lobes that they share.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "srbf/map.h"
#include "srbf/measured.h"
#include "srbf/progress.h"

SRBF_BEGIN

struct MapOptions {
    PmForm form = PmForm::extended;  ///< not reciprocal
    bool axial = true;               ///< only centres at +z or −z, sufficient for isotropic materials
    int lobes = 16;                  ///< J, 1..k_max_map_lobes
    int variates = 4;                ///< N, 1..8
    double max_theta = 0;            ///< [rad]; 0: the default of objective appearance
    std::uint64_t seed = 0;
    int threads = 0;  ///< number of threads; 0: all of the machine. The result does not depend on it
};
inline constexpr int k_max_map_lobes = 256;

/// The pairs of directions at which every texel was measured: unit vectors. Those below the horizon are left out.
struct SharedPairs {
    std::vector<Vec3f> wl, wv;
    bool isotropic = true;  ///< f_r depends only on the difference of the azimuths
};

/// Finds J lobes that the materials share, by variable projection: the minimum over lobes of Σ_t L_t / r_t. L_t is the
/// loss of pairs and albedos of material t (docs/fitting.md) with its own best coefficients. r_t is √L_t of the
/// current fit, at least a tenth of the largest, so that the sum of roots falls with the sum.
///
/// Lobes are added in sixteen groups. Each lobe is the one of 256 random ones that would lower the sum most. Then the
/// lobes are improved by all terms of the objectives, with bounds and pixels. The coefficients of a material minimise
/// all terms of its own objective. The result is a row of the materials, whose `error` is their mean ΔE_ITP under
/// `standard_lightings`.
///
/// Returns an error if there is no material, if one is of samples or two-sided, if an option is out of range, or if it
/// is cancelled.
Result<TexelMap> fit_map(std::span<const Measured> materials, const MapOptions& options,
                         const ProgressToken& progress = {});
/// Finds lobes that T texels share, of values f [T, pairs], NaN where nothing was measured. Their gaps are filled as in
/// a fit of scattered samples, at fewer pairs. The best of three searches counts. The result is a row of the texels
/// that have values above 0, and its `error` is 0. Returns an error as above, and if no texel has a value above 0.
Result<TexelMap> fit_map(const SharedPairs& pairs, std::span<const Rgb> f, const MapOptions& options,
                         const ProgressToken& progress = {});

enum class TexelState {
    fitted,
    black,   ///< no value above 0: the coefficients are 0
    failed,  ///< no value, or too large ones: the coefficients are 0
};
struct TexelCoefficients {
    std::vector<Rgb> coefficient;  ///< T × J, with their stored precision, 16-bit floats
    std::vector<float> error;
    std::vector<TexelState> state;
    std::vector<std::uint32_t> left_out;  ///< number of values of each texel that were left out
};
/// The coefficients of texels in the lobes of a map of some of them. They solve non-negative least squares at the
/// texels' own samples (NaN: not measured), with the weights of objective appearance for these values.
///
/// A lobe that rises beyond the samples, towards the horizon, may exceed their largest f cosθl cosθv there by a factor
/// of at most 1.6. A lobe that rises between or beyond them is used only if it is evident that a texel needs such
/// lobes. It is then limited to 1.6 times the largest coefficient among the map's texels, relative to their largest
/// value at the pairs.
///
/// Values that are not finite, or 10¹⁵ times the texel's typical value, are left out. So are the largest values of a
/// texel whose coefficients would exceed 16-bit floats, at most one in sixteen. If that is not enough, or nothing was
/// measured, the texel has `TexelState::failed` and coefficients 0.
///
/// `error` is √(Σ w |f−f̂|² / Σ w |f|²) of each texel with these coefficients, 0 for a black one and 1 if it failed.
TexelCoefficients coefficients_of_texels(const TexelMap& map, const SharedPairs& pairs, std::span<const Rgb> f,
                                         int threads = 0);
/// Texels that are sums of the map's texels, its materials, weighted by `fractions` [T, materials] of at least 0. Their
/// errors are the same sums.
TexelCoefficients painted_texels(const TexelMap& materials, std::span<const float> fractions);

SRBF_END
