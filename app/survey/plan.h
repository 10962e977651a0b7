// What is fitted to each material of a report.
#pragma once
#include <string>
#include <vector>

#include "app/fit.h"

namespace srbf {

/// One `srbf fit`.
struct PlannedFit {
    FitRequest request;
    std::string id;    ///< "pm-extended-8x4-cosine": of all fits of a material another one
    std::string role;  ///< of what is drawn: "pm", "pm2", "su" or "ggx"; empty: it is not
};

/// The fits of a measurement: the sizes and forms of the source's Tables 7.1 and Figure 7.6, the defaults of `srbf fit`, the baseline.
/// Scattered samples are cross-validated, a dozen fits for one; they get fewer. `quick`: about a third.
std::vector<PlannedFit> plan(const Measured& measured, bool quick, int threads);

}  // namespace srbf
