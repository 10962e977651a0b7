// Fits of many BRDFs that were measured at the same pairs of directions, such as the texels of a material.
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "srbf/fit.h"
#include "srbf/metrics.h"
#include "srbf/model.h"
#include "srbf/progress.h"
#include "srbf/result.h"

SRBF_BEGIN

/// The pairs of directions at which every texel was measured: unit vectors. Those below the horizon are left out.
struct SharedPairs {
    std::vector<Vec3f> wl, wv;
    bool isotropic = true;  ///< f_r depends only on the difference of the azimuths
};

struct BatchOptions {
    /// PM with a number of lobes; the number of threads is that of all texels together, each takes one.
    FitRequest request = {.model = PmRequest{.size = LobeCount{4}}};
    /// Starts and perturbations of each texel's search, which is shorter than that of a single fit.
    int starts = 3, perturbations = 4;
    /// Models of the same form and size. If there are some, fits start from the lobes of those that match a texel best, and
    /// follow its samples alone in a few steps, a fortieth of the time of a search.
    std::vector<PmModel> examples = {};
};

enum class TexelState {
    fitted,
    black,   ///< no value above 0: the model's coefficients are 0
    failed,  ///< too few values, for example: the model's coefficients are 0
};

struct TexelFit {
    PmModel model;  ///< of the requested form and size, every number rounded to a 16-bit float
    TexelState state = TexelState::fitted;
    Measures errors;  ///< at the texel's own values within θmax, of a texel that is fitted
    StopReason stop = StopReason::converged;
    std::optional<Error> failure;
};

/// Fits T texels to f, which has T × pairs values [1/sr], NaN where nothing was measured. Lobes follow the samples. For
/// an objective of pictures the gaps between the samples are filled as in a single fit, at fewer pairs, and the fit
/// compares no pictures. No fold is left out. A texel becomes a constant if its lobes lower the weighted squares about
/// the constant by no more than three times what noise would. The fit of a texel depends on its values, the pairs and
/// the options alone, not on other texels or the number of threads.
/// Errors: the values are not those of whole texels; the request is for another kind of model, or has no number of
/// lobes; an option is wrong; the fit was cancelled.
Result<std::vector<TexelFit>> fit_batch(const SharedPairs& pairs, std::span<const Rgb> f, const BatchOptions& options,
                                        const ProgressToken& progress = {});

SRBF_END
