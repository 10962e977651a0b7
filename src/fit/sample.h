// The subsets of the observations that the search for lobes uses.
#pragma once
#include <vector>

#include "fit/search.h"

namespace srbf {

/// Prefixes of the observations for growing, searching and polishing lobes, in colours; plus a growing set of further
/// observations at which candidates exceeded the measurement.
class Sample {
  public:
    /// Keeps a reference to `observations`, which must outlive it.
    explicit Sample(const Observations& observations);

    /// Evaluates the candidates at the other observations. Adds those at which they exceed the measurement, and updates
    /// the loss to which the weight of radiances is relative.
    void look_about(const std::vector<Candidate>& candidates, const FitOptions& options, double log_peak_limit);

    /// Adapts the weights of `to_see` to the errors of a fit, see `large_error_weight` and `add_phase_weights`.
    void weigh_by_errors(const PmModel& fitted, double most);

    /// The increase of the sum if every radiance is off by its luminance in one of three channels; beside phase weights
    /// it is larger.
    double radiance_importance(bool beside_phases = false) const;

    Rows to_grow_on() const { return Rows(few_.observations); }
    /// `first`: for the many initial candidates.
    Rows to_search(bool first) const {
        return Rows((first ? few_ : some_).observations,
                    {.radiance_importance = radiance_importance(), .roughly = true});
    }
    Rows to_polish() const { return Rows(more_.observations, {.radiance_importance = radiance_importance()}); }
    /// With the views of pictures.
    Rows to_see(double picture_importance) const {
        return Rows(some_.observations, {.radiance_importance = radiance_importance(has_phases_),
                                         .roughly = true,
                                         .picture_importance = picture_importance});
    }
    /// The factor with which the mean error of pixels costs about twice as much as the loss, more beside phase weights,
    /// for this candidate.
    double picture_importance(const Candidate& candidate, const FitOptions& options, double log_peak_limit) const;

  private:
    struct Part {
        Observations observations;
        std::size_t begin;  ///< this many of the first of all observations; those after them were added
    };
    Part beginning_of_all(std::size_t count) const;

    const Observations& all_;
    Part few_, some_, more_;
    double largest_, loss_ = 1;
    bool has_phases_ = false;  ///< whether `to_see` has phase weights
};

}  // namespace srbf
