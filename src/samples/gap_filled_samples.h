// Scattered samples with gaps filled.
#pragma once
#include "srbf/measured.h"
#include "srbf/models/ggx.h"
#include "srbf/result.h"

namespace SRBF_NAMESPACE {

/// Samples whose gaps are filled by the mean of up to three fits of Lambert and GGX, the *priors* g_i, plus
/// interpolated residuals of the samples. The priors are fitted to the samples within θmax, each also with light and
/// viewer exchanged. A GGX lobe is no narrower than the samples support, and is used only if it lowers the error at the
/// samples by more than noise would: matte samples have none. With A = cosθl cosθv, the mean e of ∛(g_i A) over the
/// priors, and for the nearest samples k the values f_k, A_k, e_k and the weights w_k of `ScatteredSamples`,
///   f A = (e + Σ_k w_k (∛(f_k A_k) − e_k) / Σ_k w_k)³ [1/sr].
/// Each g_i A is clamped to `prior_limit`, or to the least Lambert term of the g_i times A if that is larger. f A is
/// clamped to 0..b, where b is the least g_i A (in its largest channel), but at least `min_bound`: highlights exceed
/// the samples only where all priors do. At a sample, f is the sample's own value. Between distant samples it has the
/// highlight of microfacet models, where interpolation alone would leave a band or a gap.
struct GapFilledSamples {
    /// The g_i: two lobes with the weights of `Objective::appearance`; one lobe with these weights; two lobes with
    /// the weights of `Objective::cosine`, which continue a highlight differently. Or the first one alone.
    std::vector<GgxModel> priors;
    ScatteredSamples residual;  ///< its colours are ∛(f A) − e
    /// the largest f A of the samples; with a single g, which no other contradicts, `prior_limit`
    double min_bound = 0;
    double prior_limit = 0;  ///< 1.8 times the largest f A of the samples; with a single g 1.6 times, as for fits
};
/// `is_single`: use the first g alone, in a third of the time.
/// Returns an error if all samples within max_theta [rad] are black.
Result<GapFilledSamples> fill_gaps(const ScatteredSamples& samples, double max_theta, int threads = 0,
                                   bool is_single = false);
/// f [1/sr]; 0 below the horizon. Near the horizon the samples determine f A. Beyond 89.95° the divisor in
/// f = (f A) / A is no smaller than at that angle, so that f stays below the bound of a fit.
Rgb value(const GapFilledSamples& samples, Vec3f wl, Vec3f wv);

}  // namespace
