// Conversion of any BRDF to a table of a measured format, and the files of these tables.
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "srbf/measured.h"
#include "srbf/progress.h"

SRBF_BEGIN

/// Size of the tables of the MERL database: n_h, n_d, n_p.
inline constexpr std::array<std::uint32_t, 3> k_merl_size{90, 90, 180};
/// `brdf` at the nodes of a MERL table. A node holds the mean of f_r(wl, wv) and f_r(wv, wl), since such a table is
/// reciprocal. A node is marked as not measured if one of its directions lies beyond 89.7°. An anisotropic `brdf` is
/// evaluated with the half vector at azimuth 0.
MerlTable to_merl(const Evaluate& brdf, std::array<std::uint32_t, 3> size = k_merl_size, int threads = 0);

struct RglOptions {
    std::uint32_t polar = 32;    ///< number of angles θ_l; 8 in the RGL database
    std::uint32_t colours = 96;  ///< nodes of the colours along each side; 32 or 64 in the RGL database
    std::string description;
    Channels spectra = {};  ///< the spectra of `brdf`, which the table then has too; none without wavelengths
    int threads = 0;        ///< number of threads; 0: all of the machine. The result does not depend on it
};
/// `brdf` in the parameterization of `RglTable`, as an isotropic material. With
///   D(θ_h) = 0.9 D_h(θ_h) + 0.1/π,  D_h ∝ max over directions within 84° of the luminance of f_r (cosθl cosθv)^¾,
///   ∫ D_h(m) cosθ_m dm = 1,
///   σ(θ) = ∫ D(m) max(0, m·ω) dm / ∫ D(m) cosθ_m dm,
/// `ndf` is D, `sigma` is σ, `visible` is D(m) max(0, m·ωl) sinθ_m u(θ_m), normalised. The colours are f_r cosθv 4 σ /
/// D at the directions that the warp gives. Where such a direction lies beyond 89.7°, the nearest node within gives the
/// colour.
RglTable to_rgl(const Evaluate& brdf, const RglOptions& options = {});

struct MbsdfOptions {
    std::uint32_t polar = 90;      ///< n_θ, number of angles θ_l and of θ_v; 45 in NVIDIA's examples
    std::uint32_t azimuths = 181;  ///< n_φ; 90 in NVIDIA's examples
    std::vector<MbsdfTable::Entry> metadata;
    int threads = 0;  ///< number of threads; 0: all of the machine. The result does not depend on it
};
/// `brdf` at the samples of an `MbsdfTable`, as an isotropic material, with azimuth 0 of the light; not evaluated
/// beyond 89.7°. The format has no mark for values that were not measured: such a sample is the mean of its neighbours
/// in θ_v and φ. It is `grey` if all channels of all samples are equal.
MbsdfTable to_mbsdf(const Evaluate& brdf, const MbsdfOptions& options = {});

/// `brdf` at all pairs of n directions of the Fibonacci set on the cap θ ≤ θmax [rad], without the pairs that were not
/// measured.
ScatteredSamples to_samples(const Evaluate& brdf, bool isotropic, int n, double theta_max);
/// Samples f at pairs of unit vectors, without those that have no value: not finite, below the horizon, or with a
/// number such as −999 (`notes`). It builds no index (`make_index`).
ScatteredSamples valid_samples(std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<const Rgb> f,
                               bool isotropic);

/// The bytes of a MERL `.binary`. Cells without a measurement are −1. Reading them gives `table`.
std::vector<std::byte> write_merl(const MerlTable& table);
/// The bytes of an RGL `.bsdf` of an isotropic table with `jacobian`. It holds `rgb` and `luminance`, and for renderers
/// that read only spectra also `spectra` at `wavelengths`, whose colours are these (`reflectance_spectrum`). For a
/// spectral table it holds the table's own spectra in place of `rgb`. Reading it gives `table` up to rounding. Without
/// `spectra` it holds the colours alone, for renderers that would read the file as spectral otherwise.
std::vector<std::byte> write_rgl(const RglTable& table, bool spectra = true);
/// The bytes of an MBSDF file, version 1, with a block of reflection. Control characters in values of the metadata,
/// other than line ends, become blanks. Reading it gives `table`. With `transmission` a block of it follows, whose
/// metadata are ignored.
std::vector<std::byte> write_mbsdf(const MbsdfTable& table, const MbsdfTable* transmission = nullptr);
/// CSV with a row per sample: wl_x .. wv_z, then r,g,b, or a spectrum in columns such as 450nm.
/// Reading it gives `samples`. Once cancelled it ends early.
std::string write_csv(const ScatteredSamples& samples, const ProgressToken& token = {});

SRBF_END
