// Error measures between two BRDFs. All reports of the program use these names.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "srbf/brdf.h"
#include "srbf/progress.h"

SRBF_BEGIN

/// Errors of f̂ against f over pairs of directions and channels: R, G, B or any number of them. Pairs where either is
/// NaN (not measured) are skipped and counted. A ratio is 0 if both of its sums are 0, and infinite if only the
/// denominator is.
struct Measures {
    /// Σ(f−f̂)² / Σf² (Tsai 2009).
    double squared_error_ratio = 0;
    /// The ratio for f cosθl, each pair weighted by cosθv, the projected area of a patch towards the viewer.
    double squared_error_ratio_cosine = 0;
    /// √ of the mean of (log(1 + f cosθl) − log(1 + f̂ cosθl))², weighted by cosθv.
    double log_rms_cosine = 0;
    /// Σ(∛f−∛f̂)² / Σ∛f².
    double cube_root_error_ratio = 0;
    /// Σ(⁶√g−⁶√ĝ)² / Σ∛g of g = f cosθl, each pair weighted by cosθv: differences of dark and bright on a display.
    double sixth_root_error_ratio = 0;
    /// √ of the mean of (log₁₀ f − log₁₀ f̂)² over f > 0: decades, as scatter is judged. f̂ counts as at least 1e-6 f.
    double log10_rms = 0;
    std::uint64_t pairs = 0;   ///< number of pairs compared
    std::uint64_t masked = 0;  ///< number of pairs skipped
};

/// Differences between pictures of a sphere as a display shows them: with the reference's exposure, clipped at white.
/// Means over the sphere's pixels.
struct PictureErrors {
    double delta_e = 0;  ///< ΔE_ITP (ITU-R BT.2124) for a display of 100 cd/m²; 1 is just noticeable
    double flip = 0;     ///< ꟻLIP, 0 to 1; see `flip_map`
    double psnr = 0;     ///< PSNR of the sRGB encoded picture [dB], at most 100
    double rms = 0;      ///< √(Σ(L−L̂)² / ΣL²) of linear radiance, before exposure
};
/// The errors under eight lightings (docs/accuracy.md).
struct Appearance {
    PictureErrors mean;
    double worst_delta_e = 0;
    std::vector<PictureErrors> lighting;  ///< the errors under each lighting
};

struct MeasureOptions {
    double max_theta = 0;         ///< θmax [rad], of both directions; in (0, π/2]
    int threads = 0;              ///< number of threads; 0: all of the machine. The result does not depend on it
    ProgressToken progress = {};  ///< if it is cancelled, the returned values are meaningless
    bool pictures = true;         ///< `compare`: false leaves `Comparison::appearance` empty
    bool isotropic = false;       ///< `compare`: all BRDFs are, and pictures take a third of the time
};

/// Directional albedo of each channel: ∫ f(wl, wv) cosθl dωl over θl ≤ θmax, with wv at polar angle `theta_v` [rad] and
/// azimuth 0. Quadrature with 65,000 points in lobes about the mirror direction of bandwidths up to 30,000; for BRDF
/// lobes of up to that bandwidth the relative error is below 1e-4. Values that were not measured count as 0.
Rgb albedo(const Evaluate& brdf, double theta_v, double max_theta);

/// The measures of one BRDF against another.
struct Comparison {
    Measures matrix;   ///< over all pairs of directions of a set within θmax
    Measures heldout;  ///< over 200,000 independent pairs, which resolve sharp lobes
    /// Largest relative error |Â/A − 1| of the luminance of the albedo at 0, 30, 60 and 75° within θmax.
    double albedo_error = 0;
    Appearance appearance = {};
    /// For fits to scattered samples, where `appearance` is against samples with gaps filled: the mean of the fits to
    /// all folds but one, against the same samples. Where it is much larger, the samples do not determine the pictures.
    std::optional<Appearance> heldout_appearance = {};
    /// For fits to scattered samples: ΔE_ITP of a picture with a pixel for each sample, f cosθl in directional light.
    double samples_delta_e = 0;
    double Measures::*measure = nullptr;  ///< the measure that a fit to samples minimises; null for a table
};
/// Compares each of `others` with `reference`; the matrix covers all pairs of `directions`, which may be none.
std::vector<Comparison> compare(const Evaluate& reference, std::span<const Evaluate> others,
                                const MeasureOptions& options, std::span<const Vec3f> directions);

/// The loss that a fit minimises over the pairs within θmax. Each objective corresponds to a member of `Measures`.
enum class Objective {
    raw,  ///< Σ (f−f̂)²
    /// Σ (f cosθl − f̂ cosθl)² cosθv; for a multivariate model plus 0.005 times the cube-root weights, times cosθl
    /// cosθv
    cosine,
    // The next three are second-order approximations in f − f̂, with the mean of the channels in place of each channel:
    log,        ///< Σ (log(1 + f cosθl) − log(1 + f̂ cosθl))² cosθv
    cube_root,  ///< Σ (∛f − ∛f̂)²; where f is below a hundredth of its mean, with the weight at that value
    /// Σ (log f − log f̂)² over values above 0: an error of a tenth counts alike in the dark and in a peak
    relative,
    /// Errors of pictures: Σ (⁶√(f cosθl + s) − ⁶√(f̂ cosθl + s))² cosθv, s = k_dark_fraction times the upper quartile
    /// q of f cosθl; as much of Σ (∛(f cosθl + q) − ∛(f̂ cosθl + q))² √cosθv and 0.03 of cosine's sum, each scaled to Σ
    /// w |f|² = 1; and for a multivariate model ΔE_ITP of pictures of a sphere. The eye's response to a display is
    /// about the sixth root of its luminance (the exponent 0.159 of the perceptual quantiser, ITU-R BT.2100).
    appearance,
};
inline constexpr Objective k_default_objective = Objective::appearance;
inline constexpr double k_dark_fraction = 0.07;
std::string_view name(Objective objective);
/// The measure that an objective minimises and by which its fits are judged.
double error_of(const Measures& measures, Objective objective);
/// Default θmax of the fit and of its measures [rad]: 80° for raw, cube-root and relative, 89° for the others.
double default_max_theta(Objective objective);

enum class StopReason {
    converged,   ///< the last steps predicted a relative decrease below 1e-7, or none lowered the sum
    iterations,  ///< the iteration limit was reached while steps still lowered the sum, possibly by too little to go on
    cancelled,   ///< the progress token cancelled the fit; the model is the best so far
};
std::string_view name(StopReason reason);

SRBF_END
