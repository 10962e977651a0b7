// Where fits exceed what was measured: between the rows that a fit sees a lobe may shoot up.
#pragma once
#include <vector>

#include "srbf/fit.h"

namespace srbf {

/// The largest measured f cosθl cosθv.
double largest_measured(const Observations& observations);

/// The observations from `first` on, checks among them, at which f cosθl cosθv of `model` is more than 1.6 times `largest`, in their order.
std::vector<std::size_t> exceeded(const Observations& observations, std::size_t first, const PmModel& model,
                                  double largest);

/// What check i weighs that becomes an observation, of a fit of such a loss.
double check_weight(const Observations& observations, std::size_t i, double loss, double largest);

/// Where `model` exceeds the checks they become observations, and those that had become so weigh more;
/// returns how many. `first` is where the checks began.
std::size_t take_exceeded(Observations& observations, std::size_t first, const PmModel& model, double loss);

}  // namespace srbf
