// Fits of lobes to functions, beginning with lobes that are nearly right.
#pragma once
#include "srbf/edit.h"

namespace SRBF_NAMESPACE {

/// Fits `lobes` lobes to f. It begins with the best of the models `begin`, at least one, all of one form and parameterization:
/// without the least useful lobes if it has more, and with the best of many random ones if it has fewer. The albedo is at
/// most `albedo_limit`. Errors: those of `observe` and `fit_pm`.
Result<PmModel> refit(const Evaluate& f, std::span<const PmModel> begin, int lobes, double albedo_limit,
                      const EditOptions& options);

}  // namespace srbf
