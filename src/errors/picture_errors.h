// Errors of pictures of a sphere: their names and their verdicts.
#pragma once
#include <array>
#include <cstddef>
#include <string>

#include "srbf/metrics.h"

SRBF_BEGIN

inline constexpr int k_sphere_pixels = 64;  ///< width and height of a picture [pixels]

/// The verdict on an error of pictures: the worse of the verdicts by ΔE_ITP and by ꟻLIP.
enum class Verdict { alike, close, differs, other };
inline constexpr std::size_t k_verdicts = 4;
/// The largest errors that each verdict but the last allows. A ΔE_ITP of 1 is just noticeable (ITU-R BT.2124).
struct VerdictLimits {
    double delta_e, flip;
};
inline constexpr std::array<VerdictLimits, k_verdicts - 1> k_verdict_limits{{{1, 0.03}, {3, 0.07}, {10, 0.15}}};
Verdict verdict(const PictureErrors& errors);
/// "hardly visible", "visible if you look for it", "visible side by side", "visible at once".
std::string_view words(Verdict verdict);

/// Names of a picture's error in output.
struct PictureErrorName {
    const char* name;   ///< name in JSON
    const char* title;  ///< title in tables
    double PictureErrors::*member;
};
inline constexpr std::array<PictureErrorName, 4> k_picture_errors{{
    {"delta_e_itp", "ΔE_ITP", &PictureErrors::delta_e},
    {"flip", "ꟻLIP", &PictureErrors::flip},
    {"psnr", "PSNR, dB", &PictureErrors::psnr},
    {"rms", "RMS of radiance", &PictureErrors::rms},
}};

/// The errors by which a fit is judged. Pictures of a fit to samples are compared with samples whose gaps the fit
/// itself filled. So the worse of these errors and of the cross-validated ones counts, or ΔE_ITP at the samples if that
/// is larger.
Appearance judged(const Comparison& of);
/// "hardly visible: ΔE_ITP 0.346 in the mean of eight lights, 0.41 under the worst". For a fit to samples it has two
/// sentences, with errors of the fit and of cross-validation; the second says whether they differ by a factor of two.
std::string headline(const Comparison& of, std::string_view between_sentences = "; ");
/// The mean of one or more.
Appearance mean_of(std::span<const Appearance> all);
/// `is_isotropic`: true if the reference is isotropic, which saves time.
std::vector<Appearance> compare_pictures(const Evaluate& reference, std::span<const Evaluate> others, int threads = 0,
                                         const ProgressToken& progress = {}, int size = k_sphere_pixels,
                                         bool is_isotropic = false);

SRBF_END
