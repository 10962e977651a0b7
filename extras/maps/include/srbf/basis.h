// Fits of many materials with lobes that they share.
#pragma once
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "srbf/fit_batch.h"
#include "srbf/library.h"
#include "srbf/measured.h"
#include "srbf/metrics.h"
#include "srbf/progress.h"
#include "srbf/result.h"

SRBF_BEGIN

struct BasisOptions {
    PmForm form = PmForm::extended;  ///< not reciprocal
    bool axial = true;               ///< only centres at +z or −z, sufficient for isotropic materials
    int lobes = 16;                  ///< J, 1..k_most_basis_lobes
    int variates = 4;                ///< N, 1..8
    int active = 0;                  ///< K: number of lobes of which a material is the sum; 0: all, a dense library
    double max_theta = 0;            ///< [rad]; 0: the default of objective appearance
    std::uint64_t seed = 0;
    int threads = 0;  ///< 0: as many as the machine has; the result does not depend on it
};
inline constexpr int k_most_basis_lobes = 256;

/// A material: its name, and a function that reads its table. It is called several times and from several threads.
struct LibrarySource {
    std::string name;
    std::function<Result<Measured>()> read;
};

/// Finds J lobes that the materials share, by variable projection: the minimum over lobes of Σ_t L_t / r_t. L_t is
/// the loss of pairs and albedos of material t (docs/fitting.md) with its own best coefficients. r_t is √L_t of the
/// current fit, at least a tenth of the largest, so that the sum of roots falls with the sum.
///
/// Lobes are added in sixteen groups. Each lobe is the one of 256 random ones that would lower the sum most. Then
/// they follow all terms of the objectives, with directional lights, bounds and pixels. With K active lobes, a
/// material is a sum of the K lobes for which its loss is least, as soon as there are more. The coefficients of a
/// material minimise all terms of its own objective. `error` is its mean ΔE_ITP under `standard_lightings`.
///
/// Errors: those of `read`; samples, or a two-sided measurement; options out of range; two materials with the same
/// name; cancelled.
Result<Library> fit_library(std::span<const LibrarySource> sources, const BasisOptions& options,
                            const ProgressToken& progress = {});
/// Fits materials as sums of the lobes of `basis`, without a search for lobes. Of `options` it reads `active`,
/// `max_theta`, `seed` and `threads`.
Result<Library> fit_to_basis(const Library& basis, std::span<const LibrarySource> sources, const BasisOptions& options,
                             const ProgressToken& progress = {});

/// Finds J lobes that texels share, namely those of texels whose gaps are filled as by `fit_batch`. The result is a
/// dense library of these texels. Errors: those of `fit_library`, and no texel with a value above 0.
Result<Library> fit_texel_basis(const SharedPairs& pairs, std::span<const Rgb> f, const BasisOptions& options,
                                const ProgressToken& progress = {});
/// The coefficients of texels, T × J, with their stored precision, 16-bit floats. They solve non-negative least
/// squares at the texels' own samples (NaN: not measured), with the weights of objective appearance for these
/// values.
///
/// A lobe that rises beyond the samples, towards the horizon, may exceed their largest f cosθl cosθv there by a
/// factor of at most 1.6. A lobe that rises between or beyond them is used only if it is evident that a texel needs
/// such lobes. It is then limited to 1.6 times the largest coefficient among the library's materials, relative to
/// their largest value at the pairs.
///
/// Values that are not finite, or 10¹⁵ times the texel's typical value, are left out. So are the largest values of a
/// texel whose coefficients would exceed 16-bit floats, at most one in sixteen. If that is not enough, or nothing was
/// measured, the texel has `TexelState::failed` and coefficients 0.
///
/// `basis` must be dense. `error` is √(Σ w |f−f̂|² / Σ w |f|²) of each texel with these coefficients, 0 for a black
/// one and 1 if it failed.
struct TexelCoefficients {
    std::vector<Rgb> coefficient;
    std::vector<float> error;
    std::vector<TexelState> state;
    std::vector<std::uint32_t> left_out;  ///< number of values of each texel that were left out
};
TexelCoefficients fit_texels_to_basis(const Library& basis, const SharedPairs& pairs, std::span<const Rgb> f,
                                      int threads = 0);

SRBF_END
