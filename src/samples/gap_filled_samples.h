// Scattered samples with gaps filled.
#pragma once
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "srbf/measured.h"
#include "srbf/models/ggx.h"
#include "srbf/result.h"

namespace srbf {

/// The continuation of the highlights of gap-filled samples: where f A by them or by g_i, i = `prior`, exceeds `from` times the
/// largest sample, f is `share` times g_i, and from half of that on something between both. Not finite: nothing; 0: g_i
/// takes the place of all.
struct Continuation {
    std::size_t prior = 0;
    double from = std::numeric_limits<double>::infinity(), share = 1;
};
/// "neighbours", "one lobe of GGX beyond the largest sample", "0.8 times two lobes of GGX", ...
std::string words(const Continuation& continuation);

/// The prior of at most one lobe: what a fit to samples is compared with.
inline constexpr std::size_t k_one_lobe = 1;

/// Samples with gaps filled: what fits g_i of Lambert and GGX to the samples within θmax expect in
/// the mean, each sample also with light and viewer exchanged, plus what this leaves of the samples, interpolated. A lobe of
/// GGX is no narrower than the samples support, and there only if it lowers the error at them by more than noise
/// would: matte samples have none. With
/// A = cosθl cosθv, e = the mean over i of ∛(g_i A) and the w_k of `ScatteredSamples`,
///   f A = (e + Σ_k w_k (∛(f_k A_k) − e_k) / Σ_k w_k)³ [1/sr].
/// Each g_i A is at most `most`. f A is clamped to 0..b, where b is the least g_i A (by its largest channel), but at
/// least `allowed`: highlights exceed the samples where all g_i agree that they do. At a sample this is the sample's own
/// value. Between samples far apart it has the highlight of microfacet models, where interpolation alone would have a
/// band or a gap.
struct GapFilledSamples {
    /// g_i: of two lobes by the weights of `Objective::appearance`, of one by the same, of two by those of
    /// `Objective::cosine`, which continue a highlight differently; or the first alone
    std::vector<GgxModel> priors;
    ScatteredSamples rest;  ///< of colour (∛(f A) − e) / A, so that `signed_value` times A is the mean over k
    double allowed = 0;     ///< the largest f A of the samples; by one g, with which none disagrees, `most`
    double most = 0;        ///< 1.8 times the largest f A of the samples; by one g 1.6 times, as for fits
    Continuation continuation = {};
};
/// The name of the model that continues the highlights: `words(Continuation)`, or `k_no_highlight` if all g_i are Lambert alone.
std::string words(const GapFilledSamples& samples);
/// `of_one`: by the first g alone, in a third of the time.
/// Errors: no sample within max_theta [rad] that is not black.
Result<GapFilledSamples> fill_gaps(const ScatteredSamples& samples, double max_theta, int threads = 0,
                                   bool of_one = false);
/// f [1/sr]; 0 below the horizon. f A is what is known near it: beyond 89.95° A in f = (f A) / A is no less than there, so that f
/// stays below the bound of a fit.
Rgb value(const GapFilledSamples& samples, Vec3f wl, Vec3f wv);

/// The samples without each fold, filled, all with the continuation that predicts what the folds leave out best. None, if the
/// squared errors of f and of cube roots are then at most 0.8 times those of one lobe of GGX; otherwise, of those with no larger
/// error of f, the one with the least product of both.
/// Errors: those of `fill_gaps`.
Result<std::vector<GapFilledSamples>> fill_gaps_without_folds(const ScatteredSamples& samples,
                                                              std::span<const int> fold, double max_theta,
                                                              int threads = 0);

}  // namespace srbf
