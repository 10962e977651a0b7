// Scattered samples with gaps filled.
#pragma once
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "srbf/measured.h"
#include "srbf/models/ggx.h"
#include "srbf/result.h"

namespace SRBF_NAMESPACE {

/// How the highlights of gap-filled samples continue beyond the samples. Let x be the larger of f A and g_i A, i =
/// `prior`, divided by `from` times the largest sample. f is blended linearly into `share` times g_i, from x = 1/2
/// to x = 1. If `from` is infinite, nothing is continued; if it is 0, g_i replaces f everywhere.
struct Continuation {
    std::size_t prior = 0;
    double from = std::numeric_limits<double>::infinity(), share = 1;
};
/// "neighbours", "one lobe of GGX beyond the largest sample", "0.8 times two lobes of GGX", ...
std::string words(const Continuation& continuation);

/// Index of the prior with at most one lobe, to which fits of samples are compared.
inline constexpr std::size_t k_one_lobe = 1;

/// Samples with gaps filled. Lambert-GGX fits g_i to the samples within θmax, each also with light and viewer
/// swapped, give an expected value. What they leave of the samples is interpolated and added. A GGX lobe is no
/// narrower than the samples support, and is used only if it lowers the error at the samples by more than noise
/// would: matte samples have none. With
/// A = cosθl cosθv, e = the mean over i of ∛(g_i A) and the w_k of `ScatteredSamples`,
///   f A = (e + Σ_k w_k (∛(f_k A_k) − e_k) / Σ_k w_k)³ [1/sr].
/// Each g_i A is clamped to `prior_limit`, or to the least Lambert term of the g_i times A if that is larger. f A is
/// clamped to 0..b, where b is the least g_i A (in its largest channel), but at least `least_bound`: highlights exceed
/// the samples only where all g_i do. At a sample, f is the sample's own value. Between distant samples it has the
/// highlight of microfacet models, where interpolation alone would leave a band or a gap.
struct GapFilledSamples {
    /// The g_i: two lobes with the weights of `Objective::appearance`; one lobe with these weights; two lobes with
    /// the weights of `Objective::cosine`, which continue a highlight differently. Or the first one alone.
    std::vector<GgxModel> priors;
    ScatteredSamples residual;  ///< its colours are ∛(f A) − e
    /// the largest f A of the samples; with a single g, which no other contradicts, `prior_limit`
    double least_bound = 0;
    double prior_limit = 0;  ///< 1.8 times the largest f A of the samples; with a single g 1.6 times, as for fits
    Continuation continuation = {};
};
inline constexpr std::string_view k_no_highlight = "no highlight";
/// Description of the continuation: `words(Continuation)`, or `k_no_highlight` if all g_i are Lambert alone.
std::string words(const GapFilledSamples& samples);
/// `is_single`: use the first g alone, in a third of the time.
/// Errors: no sample within max_theta [rad] that is not black.
Result<GapFilledSamples> fill_gaps(const ScatteredSamples& samples, double max_theta, int threads = 0,
                                   bool is_single = false);
/// f [1/sr]; 0 below the horizon. Near the horizon the samples determine f A. Beyond 89.95° the divisor in
/// f = (f A) / A is no smaller than at that angle, so that f stays below the bound of a fit.
Rgb value(const GapFilledSamples& samples, Vec3f wl, Vec3f wv);

/// Fills the samples without each fold, all with the continuation that best predicts the left-out folds. There is
/// no continuation if the squared errors of f and of cube roots are then at most 0.8 times those of one GGX lobe.
/// Otherwise the result is the one with the least product of both errors, among those whose error of f is no larger
/// than GGX's.
/// Errors: those of `fill_gaps`.
Result<std::vector<GapFilledSamples>> fill_gaps_without_folds(const ScatteredSamples& samples,
                                                              std::span<const int> fold, double max_theta,
                                                              int threads = 0);

}  // namespace srbf
