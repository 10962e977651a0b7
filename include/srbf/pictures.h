// How different pictures of a sphere look.
#pragma once
#include <array>
#include <span>
#include <string_view>
#include <vector>

#include "srbf/brdf.h"
#include "srbf/progress.h"

namespace [[gnu::visibility("default")]] srbf {

inline constexpr int k_sphere_pixels = 64;  ///< of a picture along a side

/// Differences between pictures of a sphere as a display shows them: with the reference's exposure, clipped at white.
/// Means over the sphere's pixels.
struct PictureErrors {
    double delta_e = 0;  ///< ΔE_ITP (ITU-R BT.2124) for a display of 100 cd/m²; 1 is just noticeable
    double flip = 0;     ///< ꟻLIP, 0 to 1; see `flip_map`
    double psnr = 0;     ///< of the sRGB encoded picture [dB], at most 100
    double rms = 0;      ///< √(Σ(L−L̂)² / ΣL²) of linear radiance, before exposure
};

/// The verdict on an error of pictures: the worse of those by ΔE_ITP and by ꟻLIP.
enum class Verdict { alike, close, differs, other };
inline constexpr std::size_t k_verdicts = 4;
/// The most that a verdict but the last allows; of ΔE_ITP 1 is just noticeable (ITU-R BT.2124).
struct VerdictLimits {
    double delta_e, flip;
};
inline constexpr std::array<VerdictLimits, k_verdicts - 1> k_verdict_limits{{{1, 0.03}, {3, 0.07}, {10, 0.15}}};
Verdict verdict(const PictureErrors& errors);
/// "hardly visible", "visible if looked for", "visible beside each other", "visible at once".
std::string_view words(Verdict verdict);

/// Names of a picture's error in output.
struct PictureErrorName {
    const char* name;   ///< in JSON
    const char* title;  ///< in tables
    double PictureErrors::*member;
};
inline constexpr std::array<PictureErrorName, 4> k_picture_errors{{
    {"delta_e_itp", "ΔE_ITP", &PictureErrors::delta_e},
    {"flip", "ꟻLIP", &PictureErrors::flip},
    {"psnr", "PSNR, dB", &PictureErrors::psnr},
    {"rms", "RMS of radiance", &PictureErrors::rms},
}};

/// The errors under `standard_lightings`.
struct Appearance {
    PictureErrors mean;
    double worst_delta_e = 0;
    std::vector<PictureErrors> lighting;  ///< of each
};
/// The mean of at least one.
Appearance mean_of(std::span<const Appearance> all);
/// `is_isotropic`: the reference is, which saves time.
std::vector<Appearance> compare_pictures(const Evaluate& reference, std::span<const Evaluate> others, int threads = 0,
                                         const ProgressToken& progress = {}, int size = k_sphere_pixels,
                                         bool is_isotropic = false);

}  // namespace srbf
