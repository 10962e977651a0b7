// The fits to each material of a report.
#pragma once
#include <string_view>

#include "app/fit.h"

namespace SRBF_NAMESPACE {

/// A run of `srbf fit`.
struct FitPlan {
    FitRequest request;
    std::string id;    ///< "pm-extended-8x4-cosine"; unique among the fits of a material
    std::string role;  ///< role in pictures: "pm", "pm2", "su" or "ggx"; empty: not drawn
};

/// The number of fits and the quality of pictures.
enum class Sweep {
    whole,
    quick,  ///< about a third of the fits, coarser pictures: about a minute per material on two cores
    least,  ///< one small fit of each kind, tiny pictures: seconds, for tests
};
std::string_view name(Sweep sweep);

/// The fits to a measurement: the sizes and forms of Table 7.1 and Figure 7.6 of Tsai 2009, other objectives, and
/// baselines. The main fit, of the role "pm", has eight lobes of the form `extended`, which fits a table as measured;
/// for scans it has six reciprocal lobes. Samples have fewer fits: each is cross-validated with about a dozen fits.
std::vector<FitPlan> plan(const Measured& measured, Sweep sweep, int threads);

}  // namespace
