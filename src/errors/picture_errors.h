// Errors of pictures of a sphere: their names and their verdicts.
#pragma once
#include <array>
#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "srbf/metrics.h"

namespace [[gnu::visibility("default")]] srbf {

inline constexpr int k_sphere_pixels = 64;  ///< of a picture along a side

/// The verdict on an error of pictures: the worse of those by ΔE_ITP and by ꟻLIP.
enum class Verdict { alike, close, differs, other };
inline constexpr std::size_t k_verdicts = 4;
/// The most that a verdict but the last allows; of ΔE_ITP 1 is just noticeable (ITU-R BT.2124).
struct VerdictLimits {
    double delta_e, flip;
};
inline constexpr std::array<VerdictLimits, k_verdicts - 1> k_verdict_limits{{{1, 0.03}, {3, 0.07}, {10, 0.15}}};
Verdict verdict(const PictureErrors& errors);
/// "hardly visible", "visible if you look for it", "visible side by side", "visible at once".
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

/// The pictures by which a fit is judged: for fits to scattered samples those in cross-validation.
inline const Appearance& judged(const Comparison& of) {
    return of.heldout_appearance ? *of.heldout_appearance : of.appearance;
}
/// The mean of at least one.
Appearance mean_of(std::span<const Appearance> all);
/// `is_isotropic`: the reference is, which saves time.
std::vector<Appearance> compare_pictures(const Evaluate& reference, std::span<const Evaluate> others, int threads = 0,
                                         const ProgressToken& progress = {}, int size = k_sphere_pixels,
                                         bool is_isotropic = false);

}  // namespace srbf
