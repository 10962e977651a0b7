// Selection of a model by its size in bytes or by its visible error.
#pragma once
#include <cstddef>
#include <functional>
#include <optional>
#include <variant>
#include <vector>

#include "srbf/models/pm.h"
#include "srbf/objective.h"

namespace [[gnu::visibility("default")]] srbf {

/// Minimise the held-out error among models of at most `bytes` bytes.
struct ByteBudget {
    std::size_t bytes = 160;  ///< k_least_chosen_bytes..k_most_chosen_bytes
};
/// Minimise the bytes among models without a visible difference: whose pictures of a sphere have at most this mean ΔE_ITP under
/// `standard_lightings`. For tables.
struct TargetDeltaE {
    double delta_e = 2;  ///< (0, 100]
};
using SizeGoal = std::variant<ByteBudget, TargetDeltaE>;

/// A model that was tried.
struct Trial {
    PmForm form = PmForm::extended;
    bool axial = true;
    int lobes = 0, variates = 0;
    std::size_t bytes = 0;
    double error = 0;    ///< held out, by the objective's measure; for a target ΔE_ITP the mean ΔE_ITP
    bool whole = false;  ///< a full fit, as `fit_pm` does by itself; false: a short fit, whose error only ranks models
};

inline constexpr std::size_t k_least_chosen_bytes = 12, k_most_chosen_bytes = 512;
inline constexpr double k_finest_delta_e = 0.01, k_most_delta_e = 100;

inline constexpr int k_most_chosen_variates = 6;

}  // namespace srbf
