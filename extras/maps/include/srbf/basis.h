// Fits of many materials by lobes that they share.
#pragma once
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "fit/fit_batch.h"
#include "srbf/library.h"
#include "srbf/measured.h"
#include "srbf/objective.h"
#include "srbf/progress.h"
#include "srbf/result.h"

namespace [[gnu::visibility("default")]] srbf {

struct BasisOptions {
    PmForm form = PmForm::extended;
    bool axial = true;                  ///< only centres at +z or −z, sufficient for isotropic materials
    int lobes = 16;                     ///< J, 1..k_most_basis_lobes
    int variates = k_default_variates;  ///< N, 1..8
    int active = 0;                     ///< K: of so many lobes a material is the sum; 0: of all, a dense library
    double max_theta = 0;               ///< [rad]; 0: the default of objective appearance
    std::uint64_t seed = 0;
    int threads = 0;  ///< 0: as many as the machine has; the result does not depend on it
};
inline constexpr int k_most_basis_lobes = 256;

/// A material: its name, and what reads its table, which is called several times and from several threads.
struct LibrarySource {
    std::string name;
    std::function<Result<Measured>()> read;
};

/// Finds J lobes that the materials share, by variable projection: the minimum over lobes of Σ_t L_t / r_t, L_t the loss
/// of pairs and albedos of material t (docs/fitting.md) by its own best coefficients, r_t = √L_t of the fit so far, at
/// least a tenth of the largest, so that the sum falls as the sum of roots does. Lobes are added in sixteen groups, each
/// lobe the one of 256 random ones that would lower the sum most; then they follow all terms of the objectives, with point
/// lights, bounds and pixels. With K active lobes a material is a sum of those K for which its loss is least, from the time
/// that there are more. The coefficients of a material minimise all terms of its own objective. `error` is its mean
/// ΔE_ITP under `standard_lightings`.
/// Errors: those of `read`; samples, or a two-sided measurement; options out of range; two materials of one name;
/// cancelled.
Result<Library> fit_library(std::span<const LibrarySource> sources, const BasisOptions& options,
                            const ProgressToken& progress = {});
/// Materials as sums of the lobes of `basis`: no lobe is searched for. Of `options` it reads `active`, `max_theta`,
/// `seed` and `threads`.
Result<Library> fit_to_basis(const Library& basis, std::span<const LibrarySource> sources, const BasisOptions& options,
                             const ProgressToken& progress = {});

/// Finds J lobes that texels share: those of `chosen` texels, completed as by `fit_batch`. The result is
/// a dense library of these texels. Errors: those of `fit_library`, and no texel with a value above 0.
Result<Library> fit_texel_basis(const SharedPairs& pairs, std::span<const Rgb> f, const BasisOptions& options,
                                const ProgressToken& progress = {});
/// The coefficients of texels, T × J, as they are stored, 16-bit floats: non-negative least squares at their own samples,
/// with the weights of objective appearance for these values, NaN: not measured. A lobe that rises beyond the samples,
/// towards the horizon, exceeds their largest f cosθl cosθv there by at most a factor of 1.6. A lobe that rises between
/// or beyond them is used only if it is evident that a texel needs such lobes, and then by at most 1.6 times the largest
/// coefficient of the library's materials relative to their largest value at the pairs. `basis`: dense. `error`: of each
/// √(Σ w |f−f̂|² / Σ w |f|²) by these coefficients, 0 of a black one.
struct TexelCoefficients {
    std::vector<Rgb> coefficient;
    std::vector<float> error;
};
TexelCoefficients fit_texels_to_basis(const Library& basis, const SharedPairs& pairs, std::span<const Rgb> f,
                                      int threads = 0);

}  // namespace srbf
