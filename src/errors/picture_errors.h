// Errors of pictures of a sphere: their names and their verdicts.
#pragma once
#include <array>
#include <cstddef>
#include <string>

#include "srbf/metrics.h"

SRBF_BEGIN

inline constexpr int k_sphere_pixels = 64;  ///< width and height of a picture [pixels]

/// The verdict on an error of pictures: the worse of the verdicts by ΔE_ITP and by ꟻLIP.
enum class Verdict { hardly_visible, visible_if_sought, visible_side_by_side, visible_at_once };
inline constexpr std::size_t k_verdicts = 4;
/// The largest errors that each verdict but the last allows. A ΔE_ITP of 1 is just noticeable (ITU-R BT.2124).
struct VerdictLimits {
    double delta_e, flip;
};
inline constexpr std::array<VerdictLimits, k_verdicts - 1> k_verdict_limits{{{1, 0.03}, {3, 0.07}, {10, 0.15}}};
Verdict verdict(const PictureErrors& errors);
/// "hardly visible", "visible if you look for it", "visible side by side", "visible at once".
std::string_view name(Verdict verdict);

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
Appearance headline_errors(const Comparison& found);
/// "hardly visible: ΔE_ITP 0.346 in the mean of eight lights, 0.41 under the worst". For a fit to samples it has two
/// sentences, with errors of the fit and of cross-validation; the second says whether they differ by a factor of two.
std::string headline(const Comparison& found, std::string_view between_sentences = "; ");
/// The mean of one or more.
Appearance mean_of(std::span<const Appearance> all);
/// Options of the comparison of pictures. `is_isotropic`: true if all BRDFs are isotropic, which saves time.
struct PictureOptions {
    int threads = 0, size = k_sphere_pixels;
    bool is_isotropic = false;
    ProgressToken progress = {};
};
/// BRDFs whose pictures are compared, as indices.
struct ComparedPair {
    std::size_t reference, other;
};
/// The errors of pictures of each of the pairs, under the standard lightings.
std::vector<Appearance> compare_pictures(std::span<const Evaluate> brdfs, std::span<const ComparedPair> pairs,
                                         const PictureOptions& options = {});
/// The errors of each of `others` against the reference.
std::vector<Appearance> compare_pictures(const Evaluate& reference, std::span<const Evaluate> others,
                                         const PictureOptions& options = {});

SRBF_END
