// BRDFs as sums of closures of Cycles, Blender's renderer, for renderers that have such closures and no formulas.
#pragma once
#include "srbf/brdf.h"
#include "srbf/progress.h"
#include "srbf/result.h"

SRBF_BEGIN

/// A glossy closure of Cycles, with Beckmann's distribution of facets. Its normal is tilted from N in the plane of
/// incidence: N' = (N + `slope` T) / |N + `slope` T|, with T = ((N·wv) N − wv) / |(N·wv) N − wv|, away from the viewer.
struct Closure {
    float slope = 0;
    float roughness = 1;   ///< (αx αy)^¼, of α along T and across it
    float anisotropy = 0;  ///< 1 − √(αx / αy), or √(αy / αx) − 1 if αx > αy; −1..1
    Rgb weight{};
};

/// A sum of closures and of a diffuse BRDF whose parameters depend on the angle of the viewer θv:
///   f(wl, wv) cosθl = Σ_k weight_k D_k / (4 (N'_k·wv) (1 + Λ_k(wv) + Λ_k(wl))) + ramp(cosθl) / π
/// The ramp is linear between 0 at cosθl = 0 and `diffuse`_j at j / R, j = 1..R: with R = 1 it is Lambert's BRDF, with
/// R = 7 the closure diffuse_ramp of OSL in Cycles. D is Beckmann's distribution about N' and Λ Smith's function, as
/// approximated by Walter (2007). A term is 0 where N'·wv ≤ 0 or N'·wl < 0. The parameters are linear between knots
/// θv = i π / (2 (n − 1)), i < n.
struct ClosureSum {
    std::size_t terms = 0;
    std::vector<Rgb> diffuse;       ///< n × ramp, of n ≥ 2 knots
    std::vector<Closure> closures;  ///< n × terms
    std::size_t ramp = 1;           ///< R
    std::size_t knots() const { return diffuse.size() / ramp; }
};

Rgb value(const ClosureSum& sum, Vec3f wl, Vec3f wv);

struct ClosureFitOptions {
    int terms = 4;
    int ramp = 1;
    int knots = 24;
    int threads = 0;  ///< number of threads; 0: all of the machine. The result does not depend on it
};
inline constexpr int k_max_closures = 8, k_ramp_of_osl = 7;

/// Fits a sum of closures to an isotropic BRDF. It minimises ΔE_ITP of pictures of a sphere under directional and
/// extended lights. No albedo is above 1: where the albedo of `f` is, `f` is divided by it. NaN counts as not measured.
/// Each view has one azimuth if the BRDF is not isotropic. Returns an error if `terms` is not from 1 to
/// `k_max_closures`, `ramp` not from 1 to 7, `knots` less than four or no value above 0, and if it is cancelled.
Result<ClosureSum> fit_closures(const Evaluate& f, const ClosureFitOptions& options = {},
                                const ProgressToken& progress = {});

SRBF_END
