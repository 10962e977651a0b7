#include "samples/fit_pm_to_samples.h"

#include <fmt/format.h>

#include "base/floating_point.h"

namespace SRBF_NAMESPACE {

Result<PmFit> fit_pm(const SampleObservations& observations, const PmFitOptions& options,
                     const ProgressToken& progress) {
    const StandardArithmetic mode;
    // Each sample is observed twice: as it is, and exchanged.
    const std::size_t parameters = parameter_count(options), values = 3 * observations.samples.f.size() / 2;
    if (values < parameters)
        return Error{"fit", {}, "samples", fmt::format("at least {} values", parameters), fmt::format("{}", values)};
    auto fit = fit_pm(observations.gap_filled_table, options, progress);
    if (!fit || observations.samples.wavelengths.empty()) return fit;
    return with_spectra(*std::move(fit), observations.samples, options);
}

}  // namespace
