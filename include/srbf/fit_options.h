// The options of a fit that the command line and Python share.
#pragma once
#include <string_view>

#include "srbf/choose.h"
#include "srbf/model.h"
#include "srbf/models/ggx.h"
#include "srbf/models/su.h"
#include "srbf/objective.h"

namespace [[gnu::visibility("default")]] srbf {

inline constexpr int k_most_threads = 1024;

/// An option, the kind of models that reads it (pm, su or ggx; empty: any), and the range of its numbers, or
/// `least` > `most` if it is none. In a name '_' separates words; the command line has '-'.
struct FitOptionRow {
    std::string_view name, model;
    double least = 1, most = 0;
    bool is_whole = true;
};
inline constexpr FitOptionRow k_fit_options[] = {
    {"lobes", "pm", 1, k_most_fitted_lobes},
    {"lobes", "su", 1, k_most_view_lobes},
    {"lobes", "ggx", 1, k_most_ggx_lobes},
    {"variates", "pm", 1, k_most_variates},
    {"form", "pm"},
    {"axial", "pm"},
    {"reciprocal", "pm"},
    {"budget", "pm", 12, k_most_chosen_bytes},
    {"target_delta_e", "pm", 0.01, k_most_delta_e, false},
    {"max_theta", "", 1, 89.9, false},  // [degrees]
    {"threads", "", 0, k_most_threads},
};
/// The row of an option that is a number, of models of that kind.
constexpr const FitOptionRow& fit_option(std::string_view name, std::string_view model = "pm") {
    for (const FitOptionRow& row : k_fit_options)
        if (row.name == name && (row.model.empty() || row.model == model)) return row;
    throw "no such option";  // which does not compile where it is a constant
}

}  // namespace srbf
