// The errors of a fit.
#pragma once
#include "fit/fitted_data.h"

namespace SRBF_NAMESPACE {

/// Measures the errors of `outcome`, and writes the main ones into the provenance of its model. Errors of a fit to
/// samples are against these, with gaps filled; a draft of such a fit has none.
Result<Done> measure_errors(FitOutcome& outcome, const FittedData& data, const FitRequest& request,
                            const ProgressToken& progress);

}  // namespace
