// How far one BRDF is from another: level 2. One implementation, one vocabulary; the program's reports use
// these names.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "srbf/brdf.h"
#include "srbf/progress.h"

namespace srbf {

/// Errors of f̂ against f over pairs of directions and channels, R, G, B or any number of them. Pairs where either is NaN (not measured) are
/// left out and counted. A ratio is 0 where both of its sums are 0, and infinite where only the lower one is.
struct Measures {
    /// Σ(f−f̂)² / Σf² (Tsai 2009).
    double squared_error_ratio = 0;
    /// The same of f cosθl, each pair weighted by cosθv, the area that a patch shows the viewer.
    double squared_error_ratio_cosine = 0;
    /// √ of the mean of (log(1 + f cosθl) − log(1 + f̂ cosθl))², weighted by cosθv.
    double log_rms_cosine = 0;
    /// Σ(∛f−∛f̂)² / Σ∛f².
    double cube_root_error_ratio = 0;
    std::uint64_t pairs = 0;   ///< that were compared
    std::uint64_t masked = 0;  ///< that were left out
};

/// How a measure is named and printed.
struct MeasureName {
    const char* name;   ///< in JSON and provenance
    const char* title;  ///< in tables
    double Measures::*member;
    bool is_ratio;  ///< printed as per cent
};
inline constexpr std::array<MeasureName, 4> k_measures{{
    {"squared_error_ratio", "squared error ratio", &Measures::squared_error_ratio, true},
    {"squared_error_ratio_cosine", "  of f cosθl", &Measures::squared_error_ratio_cosine, true},
    {"log_rms_cosine", "RMS of log(1 + f cosθl)", &Measures::log_rms_cosine, false},
    {"cube_root_error_ratio", "cube root error ratio", &Measures::cube_root_error_ratio, true},
}};

struct MeasureOptions {
    double max_theta = 0;         ///< θmax [rad], of both directions; in (0, π/2]
    int threads = 0;              ///< 0: as many as the machine has; the result does not depend on it
    ProgressToken progress = {};  ///< once it is cancelled, what is returned means nothing
};

/// The measures of each of `others` over the n × n pairs of the Fibonacci set of the cap θ ≤ θmax: the
/// source's matrix.
inline constexpr int k_matrix_directions = 1536;
std::vector<Measures> measure_matrix(const Evaluate& reference, std::span<const Evaluate> others,
                                     const MeasureOptions& options, int n = k_matrix_directions);
/// The same over the n × n pairs of the given directions, as far as they lie within θmax: a view-by-view model's own matrix.
std::vector<Measures> measure_matrix(const Evaluate& reference, std::span<const Evaluate> others,
                                     const MeasureOptions& options, std::span<const Vec3f> directions);

std::vector<Measures> measure_matrix(const Channels& reference, std::span<const Channels> others,
                                     const MeasureOptions& options, std::span<const Vec3f> directions);

/// The same over `count` independent pairs: wv even over the cap, wl from a mixture around the mirror
/// direction, weighted back to even solid angle. Fibonacci pairs undersample sharp lobes; these do not.
inline constexpr std::uint64_t k_heldout_pairs = 200000;
inline constexpr std::uint64_t k_heldout_seed = 0x5eed'0f'4e1d'0047;
std::vector<Measures> measure_heldout(const Evaluate& reference, std::span<const Evaluate> others,
                                      const MeasureOptions& options, std::uint64_t count = k_heldout_pairs,
                                      std::uint64_t seed = k_heldout_seed);
std::vector<Measures> measure_heldout(const Channels& reference, std::span<const Channels> others,
                                      const MeasureOptions& options, std::uint64_t count = k_heldout_pairs,
                                      std::uint64_t seed = k_heldout_seed);

/// The same over samples: f[i] measured at (wl[i], wv[i]), g[i] the other's, each of weight 1; negative channels of f count as 0. Those within
/// `sample_cap` count.
Measures measure_samples(std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<const Rgb> f,
                         std::span<const Rgb> g, double max_theta);
Measures measure_samples(std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<const Rgb> f,
                         const Evaluate& other, double max_theta);
/// Of as many channels as f and g have for each sample.
Measures measure_samples(std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<const float> f,
                         std::span<const float> g, double max_theta);
/// cos(θmax + 0.01°): angles of samples are rounded in their files.
inline float sample_cap(double max_theta) { return float(std::cos(max_theta + 0.01 * k_degree)); }

/// The angles at which albedo is compared [degrees].
inline constexpr std::array<double, 4> k_albedo_theta{0, 30, 60, 75};

/// Directional albedo of each channel: ∫ f(wl, wv) cosθl dωl over θl ≤ θmax, wv at polar angle `theta_v` [rad] and azimuth 0, by
/// 65,000 points in lobes about the mirror direction of bandwidths up to 30,000, which resolve lobes as sharp: relative error
/// below 1e-4. What was not measured counts as 0.
Rgb albedo(const Evaluate& brdf, double theta_v, double max_theta);

/// Largest relative error |Â/A − 1| of the luminance of albedo over those of `k_albedo_theta` that are within
/// θmax.
double albedo_error(const Evaluate& reference, const Evaluate& other, double max_theta);

/// The measures of one BRDF against another: over a matrix of directions, over held-out pairs, and of albedo.
struct Comparison {
    Measures matrix, heldout;
    double albedo_error = 0;
};
/// Of each of `others` against `reference`, the matrix over all pairs of `directions`.
std::vector<Comparison> compare(const Evaluate& reference, std::span<const Evaluate> others,
                                const MeasureOptions& options, std::span<const Vec3f> directions);

}  // namespace srbf
