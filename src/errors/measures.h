// Measures over pairs of directions and over samples.
#pragma once
#include <array>

#include "srbf/metrics.h"

namespace SRBF_NAMESPACE {

/// The number of directions of the matrix of Tsai 2009, the Fibonacci set on the cap θ ≤ θmax.
inline constexpr int k_matrix_directions = 1536;
/// The number of folds in which scattered samples are held out.
inline constexpr int k_folds = 5;
/// The number of pairs of directions of `Comparison::heldout`.
inline constexpr std::uint64_t k_heldout_pairs = 200000;
/// The view angles at which albedo is compared [degrees].
inline constexpr std::array<double, 4> k_albedo_theta{0, 30, 60, 75};

/// Names of a measure in output.
struct MeasureName {
    const char* name;   ///< name in JSON and provenance
    const char* title;  ///< title in tables; two leading blanks: it continues the title of the row before
    double Measures::*member;
    bool is_ratio;  ///< printed in per cent; otherwise the root of a mean, divided by `unit`
    double unit = 1;
    const char* full_title = title;  ///< title in a sentence
};
inline constexpr double k_log_10 = 2.302585092994045684;  // ln 10
inline constexpr std::array<MeasureName, 6> k_measures{{
    {"squared_error_ratio", "squared error ratio", &Measures::squared_error_ratio, true},
    {"squared_error_ratio_cosine", "  of f cosθl", &Measures::squared_error_ratio_cosine, true, 1,
     "squared error ratio of f cosθl"},
    {"log_rms_cosine", "RMS of log(1 + f cosθl)", &Measures::log_rms_cosine, false},
    {"cube_root_error_ratio", "cube root error ratio", &Measures::cube_root_error_ratio, true},
    {"sixth_root_error_ratio", "sixth root error ratio", &Measures::sixth_root_error_ratio, true},
    {"log10_rms", "RMS of log10 f", &Measures::log10_rms, false, k_log_10},
}};
/// Calls add(name, value) for the measures of a comparison: over the matrix, held out, and of albedo.
template <typename Add> void for_measures(const Comparison& comparison, const Add& add) {
    for (const MeasureName& m : k_measures) add(std::string(m.name), comparison.matrix.*m.member);
    for (const MeasureName& m : k_measures) add("heldout_" + std::string(m.name), comparison.heldout.*m.member);
    add(std::string("albedo_error"), comparison.albedo_error);
}

/// The measures of each of `others` over all pairs of the given directions within θmax.
std::vector<Measures> measure_matrix(const Channels& reference, std::span<const Channels> others,
                                     const MeasureOptions& options, std::span<const Vec3f> directions);

/// The measures over `count` independent pairs: wv uniform over the cap, wl from `MirrorMixture`, weighted to uniform
/// solid angle. Unlike pairs of the Fibonacci set, these resolve sharp lobes.
inline constexpr std::uint64_t k_heldout_seed = 0x5eed'0f'4e1d'0047;
std::vector<Measures> measure_heldout(const Channels& reference, std::span<const Channels> others,
                                      const MeasureOptions& options, std::uint64_t count = k_heldout_pairs,
                                      std::uint64_t seed = k_heldout_seed);

/// The measures over samples: f has the measured channels of each sample, g the channels of the other BRDF. Each sample
/// has weight 1; negative channels of f count as 0. Only samples within `sample_cap` count.
Measures measure_samples(std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<const float> f,
                         std::span<const float> g, double max_theta);
/// cos(θmax + 0.01°), with a tolerance for rounded angles in files.
inline float sample_cap(double max_theta) { return float(elementary::cos(max_theta + 0.01 * k_degree)); }

/// `Comparison::albedo_error` of each of `others`. Pairs at which the reference was not measured count in neither.
std::vector<double> albedo_errors(const Evaluate& reference, std::span<const Evaluate> others,
                                  const MeasureOptions& options);

}  // namespace
