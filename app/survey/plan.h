// What is fitted to each material of a report.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "app/fit.h"

namespace srbf {

/// One `srbf fit`.
struct PlannedFit {
    FitRequest request;
    std::string id;    ///< "pm-extended-8x4-cosine": of all fits of a material another one
    std::string role;  ///< of what is drawn: "pm", "pm2", "su" or "ggx"; empty: it is not
};

/// How much is fitted and drawn.
enum class Sweep {
    whole,
    quick,  ///< about a third of the fits, coarser pictures: about a minute a material on two cores
    least,  ///< one small fit of each kind, hardly a picture: seconds, to try a report
};
std::string_view name(Sweep sweep);

/// The fits of a measurement: the sizes and forms of the source's Table 7.1 and Figure 7.6, the defaults of `srbf fit`, the baseline.
/// Scattered samples are cross-validated, a dozen fits for one; they get fewer.
std::vector<PlannedFit> plan(const Measured& measured, Sweep sweep, int threads);

}  // namespace srbf
