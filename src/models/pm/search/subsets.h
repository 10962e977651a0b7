// Subsets of the observations, for the search.
#pragma once
#include <vector>

#include "models/pm/search/schedule.h"
#include "models/pm/search/search.h"

namespace SRBF_NAMESPACE {

/// The first observations, in colours: for the search, for the selection, and for the polish. From stage to stage,
/// observations are added at which candidates exceeded the measurement.
class Subsets {
  public:
    /// Keeps a reference to `observations`, which must outlive it.
    explicit Subsets(const Observations& observations);

    /// Evaluates the candidates at the other observations. Adds those at which they exceed the measurement, and
    /// updates the loss to which the weight of integrals is relative.
    void add_exceeded_pairs(const std::vector<Candidate>& candidates, const PmFitOptions& options,
                            double log_peak_limit);

    /// Adds the weights of directional lights, relative to the errors of a fit, to the pairs used with pictures.
    void add_directional_lights(const Evaluate& fitted);

    /// The rows of a stage that does not use all pairs.
    Rows rows(const Stage& stage, double picture_importance) const;

    /// The increase of the sum if every integral differs by its luminance in one of three channels. It is larger
    /// beside weights of directional lights.
    double integral_importance(bool beside_directional_lights = false) const;
    /// The factor with which the pixels of this candidate cost `k_pixels` times the loss per mean ΔE_ITP.
    double picture_importance(const Candidate& candidate, const Stage& stage, const PmFitOptions& options,
                              double log_peak_limit) const;

  private:
    struct Part {
        Observations observations;
        std::size_t begin;  ///< number of initial observations from `all_`; the others were added
    };
    Part first_pairs(Pairs pairs) const;

    const Observations& all_;
    Part search_, selection_, polish_;
    double largest_, loss_ = 1;
    bool has_directional_lights_ = false;  ///< the weights of `selection_` include directional lights
};

}  // namespace srbf
