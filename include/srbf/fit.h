// From measurements to models.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "srbf/brdf.h"
#include "srbf/metrics.h"
#include "srbf/model.h"
#include "srbf/progress.h"
#include "srbf/result.h"

namespace [[gnu::visibility("default")]] srbf {

/// What a fit minimises over the pairs within θmax. Each objective corresponds to a measure of metrics.h.
enum class Objective {
    raw,  ///< Σ (f−f̂)²
    /// Σ (f cosθl − f̂ cosθl)² cosθv; for a multivariate model plus 0.005 times the cube-root weights, times cosθl
    /// cosθv
    cosine,
    // The next three are second-order approximations in f − f̂, with the mean of the channels in place of each channel:
    log,        ///< Σ (log(1 + f cosθl) − log(1 + f̂ cosθl))² cosθv
    cube_root,  ///< Σ (∛f − ∛f̂)²; where f is below a hundredth of its mean, with the weight at that value
    /// Σ (log f − log f̂)² over what is above 0: an error of a tenth counts alike in the dark and in a peak
    relative,
    /// What is seen of a picture: Σ (⁶√(f cosθl + s) − ⁶√(f̂ cosθl + s))² cosθv, s = k_dark_share times the upper
    /// quartile q of f cosθl; as much of Σ (∛(f cosθl + q) − ∛(f̂ cosθl + q))² cosθv and 0.03 of cosine's sum, each
    /// scaled to Σ w |f|² = 1; and for a multivariate model ΔE_ITP of pictures of a sphere. The eye's response to a
    /// display is about the sixth root of its luminance (the exponent 0.159 of the perceptual quantiser, ITU-R BT.2100).
    appearance,
};
inline constexpr Objective k_default_objective = Objective::appearance;
inline constexpr double k_dark_share = 0.07;
std::span<const Objective> objectives();  ///< all objectives
std::string_view name(Objective objective);
std::string_view summary(Objective objective);  ///< what it minimises, a line in ASCII
std::optional<Objective> objective_named(std::string_view text);
/// The measure that an objective minimises and by which its fits are judged.
double Measures::*measure_of(Objective objective);
inline double error_of(const Measures& measures, Objective objective) { return measures.*measure_of(objective); }
/// Default θmax of the fit and of its measures [rad]: 80° for raw, cube-root and relative, 89° for the others.
double default_max_theta(Objective objective);

struct TabulateOptions {
    int directions = 1536;                     ///< n, k_least_views..k_most_views
    int between = 512;                         ///< m, 0..k_most_between; 0: only the raw matrix
    Discretise discretise = Discretise::view;  ///< of the model to be fitted
    int threads = 0;                           ///< 0: as many as the machine has; the result does not depend on it
};
inline constexpr std::size_t k_most_between = 4096;

struct FitOptions {
    PmForm form = PmForm::extended;
    bool axial = true;  ///< only centres at +z or −z, sufficient for isotropic data
    /// f(ωl,ωv) = f(ωv,ωl) up to rounding: variates in pairs (a, b), (b, a) with the same centre and bandwidth
    bool reciprocal = false;
    int lobes = 8;     ///< J, 1..64
    int variates = 4;  ///< N, 1..8, even for a reciprocal model
    /// Upper bound 1/finest² on bandwidths, and 1/finest [1/rad] on the other weights; 0: the range of 16-bit floats.
    double finest = 0;
    /// form gaussian: true stores a log scale per lobe where β leaves the range of 16-bit floats; false bounds β
    bool log_scale = true;
    /// Number of starts: independent growths of J lobes. The best four are polished, one to three of them finished;
    /// of appearance pictures choose among all of them, and one is finished. Default: 20, or 16 for 8 lobes and more.
    std::optional<int> starts = {};
    /// Maximum number of perturbations of a candidate, replacements of the least useful lobe, or every fourth time of
    /// the least useful variate. All starts get a fifth of them, the better half another three tenths, the best quarter
    /// the remaining half; of appearance all of them get 0.28 of these. Default: 45 for up to 5 lobes, falling to 25
    /// for 8 and more.
    std::optional<int> perturbations = {};
    std::uint64_t seed = 0;  ///< of the random numbers
    int threads = 0;         ///< 0: as many as the machine has; the result does not depend on it
};
inline constexpr int k_most_fitted_lobes = 64;

enum class StopReason {
    converged,   ///< the last steps predicted a relative decrease below 1e-7, or none lowered the sum
    iterations,  ///< the iteration limit was reached while steps still lowered the sum, possibly by too little to go on
    cancelled,   ///< by the progress token; the model is the best so far
};
std::string_view name(StopReason reason);

struct SuFitOptions {
    int lobes = 8;  ///< J, 1..k_most_view_lobes
    Objective objective = k_default_objective;
    double max_theta = 0;  ///< [rad], 1 to 89.9°; 0: the objective's default. Pairs beyond it have small weights
    /// Whether lobes have shapes, see `SuModel`; none: for objective appearance.
    std::optional<bool> shaped = {};
    SuInterpolation interpolation = SuInterpolation::rotated;  ///< stored in the model; the fit does not depend on it
    int neighbours = 3;                                        ///< K of plain interpolation, 1..k_most_neighbours
    std::uint64_t seed = 0;                                    ///< of the random numbers
    int threads = 0;  ///< 0: as many as the machine has; the result does not depend on it
};

struct PbrFitOptions {
    PbrSurfaceKind surface = PbrSurfaceKind::openpbr;  ///< whose parameters are fitted; others keep their defaults
    bool is_isotropic = true;                          ///< no anisotropy is fitted
    int threads = 0;  ///< 0: as many as the machine has; the result does not depend on it
};

struct GgxFitOptions {
    int lobes = 1;    ///< 1..k_most_ggx_lobes
    int threads = 0;  ///< 0: as many as the machine has; the result does not depend on it
};

}  // namespace srbf
