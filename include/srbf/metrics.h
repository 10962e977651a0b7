// Error measures between two BRDFs. All reports of the program use these names.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "srbf/brdf.h"
#include "srbf/elementary.h"
#include "srbf/pictures.h"
#include "srbf/progress.h"

namespace [[gnu::visibility("default")]] srbf {

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
    /// Σ(⁶√g−⁶√ĝ)² / Σ∛g of g = f cosθl, each pair weighted by cosθv: differences of dark and bright as a display shows
    /// them.
    double sixth_root_error_ratio = 0;
    /// √ of the mean of (log₁₀ f − log₁₀ f̂)² over f > 0: decades, as scatter is judged. f̂ counts as at least 1e-6 f.
    double log10_rms = 0;
    std::uint64_t pairs = 0;   ///< number of pairs compared
    std::uint64_t masked = 0;  ///< number of pairs skipped
};

/// Names of a measure in output.
struct MeasureName {
    const char* name;   ///< in JSON and provenance
    const char* title;  ///< in tables
    double Measures::*member;
    bool is_ratio;  ///< printed in per cent; otherwise the root of a mean, divided by `unit`
    double unit = 1;
};
inline constexpr double k_log_10 = 2.302585092994045684;  // ln 10
inline constexpr std::array<MeasureName, 6> k_measures{{
    {"squared_error_ratio", "squared error ratio", &Measures::squared_error_ratio, true},
    {"squared_error_ratio_cosine", "  of f cosθl", &Measures::squared_error_ratio_cosine, true},
    {"log_rms_cosine", "RMS of log(1 + f cosθl)", &Measures::log_rms_cosine, false},
    {"cube_root_error_ratio", "cube root error ratio", &Measures::cube_root_error_ratio, true},
    {"sixth_root_error_ratio", "sixth root error ratio", &Measures::sixth_root_error_ratio, true},
    {"log10_rms", "RMS of log10 f", &Measures::log10_rms, false, k_log_10},
}};

struct MeasureOptions {
    double max_theta = 0;         ///< θmax [rad], of both directions; in (0, π/2]
    int threads = 0;              ///< 0: as many as the machine has; the result does not depend on it
    ProgressToken progress = {};  ///< if it is cancelled, the returned values are meaningless
    bool pictures = true;         ///< `compare`: false leaves `Comparison::appearance` empty
};

/// The number of directions of the matrix of Tsai 2009, the Fibonacci set on the cap θ ≤ θmax.
inline constexpr int k_matrix_directions = 1536;

/// The view angles at which albedo is compared [degrees].
inline constexpr std::array<double, 4> k_albedo_theta{0, 30, 60, 75};

/// Directional albedo of each channel: ∫ f(wl, wv) cosθl dωl over θl ≤ θmax, with wv at polar angle `theta_v` [rad] and
/// azimuth 0. Quadrature with 65,000 points in lobes about the mirror direction of bandwidths up to 30,000; for BRDF
/// lobes of up to that bandwidth the relative error is below 1e-4. Values that were not measured count as 0.
Rgb albedo(const Evaluate& brdf, double theta_v, double max_theta);

/// The number of folds in which scattered samples are held out.
inline constexpr int k_folds = 5;

/// The number of pairs of directions of `Comparison::heldout`.
inline constexpr std::uint64_t k_heldout_pairs = 200000;

/// The measures of one BRDF against another.
struct Comparison {
    Measures matrix;   ///< over all pairs of directions of a set within θmax
    Measures heldout;  ///< over `k_heldout_pairs` independent pairs, which resolve sharp lobes
    /// Largest relative error |Â/A − 1| of the luminance of the albedo over the angles of `k_albedo_theta` within θmax.
    double albedo_error = 0;
    Appearance appearance = {};
    /// For fits to scattered samples, where `appearance` is against samples with gaps filled: the mean of the fits to all
    /// folds but one, against the same. Where it is much larger, the samples do not determine the pictures.
    std::optional<Appearance> heldout_appearance = {};
};
/// The pictures by which a fit is judged: for fits to scattered samples those in cross-validation.
inline const Appearance& judged(const Comparison& of) {
    return of.heldout_appearance ? *of.heldout_appearance : of.appearance;
}
/// Compares each of `others` with `reference`; the matrix covers all pairs of `directions`, which may be none.
std::vector<Comparison> compare(const Evaluate& reference, std::span<const Evaluate> others,
                                const MeasureOptions& options, std::span<const Vec3f> directions);

}  // namespace srbf
