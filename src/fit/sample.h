// What the search for lobes looks at: not all observations.
#pragma once
#include <vector>

#include "fit/search.h"

namespace srbf {

/// The beginnings of the observations by which lobes are grown, searched and polished, as colours; and more and more of those beyond, where
/// candidates were found to exceed the measurement.
class Sample {
  public:
    /// `observations` must outlive it.
    explicit Sample(const Observations& observations);

    /// Evaluates the candidates where they have not been looked at: takes in where they exceed the measurement, and learns how large a
    /// loss is that albedo is to be weighed against.
    void look_about(const std::vector<Candidate>& candidates, const FitOptions& options, double log_peak_limit);

    /// What the sum is to rise by where every albedo is off by its luminance in one of three channels.
    double albedo_importance() const;

    Rows to_grow_on() const { return Rows(few_.observations); }
    /// `first`: of the many candidates there are at first.
    Rows to_search(bool first) const {
        return Rows((first ? few_ : some_).observations, {.albedo_importance = albedo_importance(), .roughly = true});
    }
    Rows to_polish() const { return Rows(more_.observations, {.albedo_importance = albedo_importance()}); }

  private:
    struct Part {
        Observations observations;
        std::size_t begin;  ///< of all the first so many; those behind them were taken in
    };
    Part beginning_of_all(std::size_t count) const;

    const Observations& all_;
    Part few_, some_, more_;
    double largest_, loss_ = 1;
};

}  // namespace srbf
