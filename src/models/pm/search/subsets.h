// The subsets of the observations that a search sees.
#pragma once
#include <vector>

#include "models/pm/search/schedule.h"
#include "models/pm/search/search.h"

namespace srbf {

/// The first few, some and more of the observations, in colours; with further observations, more from stage to stage,
/// at which candidates exceeded the measurement.
class Subsets {
  public:
    /// Keeps a reference to `observations`, which must outlive it.
    explicit Subsets(const Observations& observations);

    /// Evaluates the candidates at the other observations. Adds those at which they exceed the measurement, and updates
    /// the loss to which the weight of integrals is relative.
    void add_exceeded(const std::vector<Candidate>& candidates, const FitOptions& options, double log_peak_limit);

    /// Adds to the pairs that pictures are fitted with the weights of point lights, relative to the errors of a fit.
    void add_directional_lights(const Evaluate& fitted);

    /// The rows of a stage, unless of all pairs.
    Rows rows(const Stage& stage, double picture_importance) const;

    /// The increase of the sum if every integral is off by its luminance in one of three channels; beside weights of
    /// point lights it is larger.
    double integral_importance(bool beside_directional_lights = false) const;
    /// The factor with which the pixels of this candidate cost `k_pixels` times the loss per mean ΔE_ITP.
    double picture_importance(const Candidate& candidate, const Stage& stage, const FitOptions& options,
                              double log_peak_limit) const;

  private:
    struct Part {
        Observations observations;
        std::size_t begin;  ///< this many of the first of all observations; those after them were added
    };
    Part beginning_of_all(Pairs pairs) const;

    const Observations& all_;
    Part few_, some_, more_;
    double largest_, loss_ = 1;
    bool has_directional_lights_ = false;  ///< whether weights of `some_` have them
};

}  // namespace srbf
