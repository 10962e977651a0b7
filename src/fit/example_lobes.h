// Fits of texels that start from the lobes of other texels.
#pragma once
#include "models/pm/search/fit_pm.h"
#include "observe/observations.h"
#include "observe/pairs.h"
#include "srbf/metrics.h"

namespace SRBF_NAMESPACE {

/// The lobes of examples, from which fits start in place of a search. Texels of a material are alike, so that the lobes
/// of one are near those of others, and a few steps from them are enough.
class ExampleLobes {
  public:
    /// The examples have the form and size of the options.
    ExampleLobes(std::span<const PmModel> examples, const PmFitOptions& options);

    bool empty() const { return starts_.empty(); }

    struct Fit {
        PmModel model;  ///< every number rounded to a 16-bit float
        StopReason stop;
    };
    /// The examples whose lobes match the samples best, with coefficients of their own, take a few steps each, and the
    /// best of them some more. At no pair of the horizon grid does the result exceed k_most_excess times the larger of
    /// the samples' largest f cosθl cosθv and of what the example has there; if it would, the next one is taken that is
    /// better than the example, and at last the example itself. With fewer values than numbers of the model nothing takes steps.
    /// The steps follow `between` too, values that are expected elsewhere.
    Fit fit(const Observations& samples, const Observations& between = {}) const;

  private:
    PmFitOptions options_;
    std::vector<Lobes> starts_;
    std::vector<Vec3f> grid_wl_, grid_wv_;
};

}  // namespace srbf
