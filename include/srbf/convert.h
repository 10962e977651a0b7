// Any BRDF as a table of a measured format, and the tables' files: level 4.
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "srbf/measured.h"

namespace srbf {

/// The size of the database's tables: n_h, n_d, n_p.
inline constexpr std::array<std::uint32_t, 3> k_merl_size{90, 90, 180};
/// `brdf` at the nodes of a MERL table: the mean of f_r(wl, wv) and f_r(wv, wl), between which such a table cannot tell. Not measured where
/// a direction of the node lies beyond 89.7°. What is not isotropic is seen with the half-way vector at azimuth 0.
MerlTable to_merl(const Evaluate& brdf, std::array<std::uint32_t, 3> size = k_merl_size, int threads = 0);

struct RglOptions {
    std::uint32_t polar = 32;    ///< angles θ_l: 8 in the database
    std::uint32_t colours = 96;  ///< nodes of the colours along each side: 32 or 64 in the database
    std::string description;
    int threads = 0;  ///< 0: as many as the machine has; the result does not depend on it
};
/// `brdf` in the parameterization of `RglTable`, as an isotropic material: with
///   D(θ_h) ∝ max over directions within 84° of the luminance of f_r (cosθl cosθv)^¾,  ∫ D(m) cosθ_m dm = 1,
///   σ(θ) = ∫ D(m) max(0, m·ω) dm / ∫ D(m) cosθ_m dm,
/// `ndf` is D, `sigma` is σ, `visible` is D(m) max(0, m·ωl) sinθ_m u(θ_m), normalised, and the colours are f_r cosθv 4 σ / D at the
/// directions that the warp leads to; where that lies beyond 89.7°, those of the nearest nodes within.
RglTable to_rgl(const Evaluate& brdf, const RglOptions& options = {});

/// `brdf` at all pairs of n directions of the Fibonacci set of the cap θ ≤ θmax [rad]. Pairs that were not measured are left out.
Scattered to_samples(const Evaluate& brdf, bool isotropic, int n, double theta_max);

/// The bytes of a MERL `.binary`; cells without a measurement are −1. read_merl(write_merl(table)) is `table`.
std::vector<std::byte> write_merl(const MerlTable& table);
/// The bytes of an RGL `.bsdf` of an isotropic table with `jacobian`: `rgb`, `luminance`, and for renderers that read spectra alone
/// `spectra` at `wavelengths` whose colours these are (`reflectance_spectrum`). read_rgl(write_rgl(table)) is `table` but for rounding.
std::vector<std::byte> write_rgl(const RglTable& table);
/// CSV, a row a sample: wl_x .. wv_z, then r,g,b or the spectrum in columns as 450nm. read_csv(write_csv(samples)) is `samples`.
std::string write_csv(const Scattered& samples);

}  // namespace srbf
