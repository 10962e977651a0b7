// Selection of a model by its size in bytes or by its error: level 4.
#pragma once
#include <cstddef>
#include <functional>
#include <optional>
#include <variant>
#include <vector>

#include "srbf/fit.h"

namespace [[gnu::visibility("default")]] srbf {

/// Minimise the held-out error among models of at most `bytes` bytes.
struct ByteBudget {
    std::size_t bytes = 160;  ///< 12..k_most_chosen_bytes
};
/// Minimise the bytes among models whose held-out error, by the objective's own measure, is at most `error`.
struct TargetError {
    double error = 0.005;  ///< (0, 1]
};
/// Minimise the bytes among models that look the same: whose pictures of a sphere have at most this mean ΔE_ITP under
/// `standard_lightings`. For tables.
struct TargetDeltaE {
    double delta_e = 2;  ///< (0, 100]
};
using SizeGoal = std::variant<ByteBudget, TargetError, TargetDeltaE>;

/// A model that was tried.
struct Step {
    PmForm form = PmForm::extended;
    bool axial = true;
    int lobes = 0, variates = 0;
    std::size_t bytes = 0;
    double error = 0;    ///< held out, by the objective's measure; for a target ΔE_ITP the mean ΔE_ITP
    bool whole = false;  ///< a full fit, as `fit_pm` does by itself; false: a short fit, whose error only ranks models
};

/// Returns the error of a model by the objective's measure, for a target ΔE_ITP the mean ΔE_ITP. With `in_short`, a few
/// thousand pairs are enough. It is called from several threads at once.
using JudgeModel = std::function<double(const PmModel& model, bool in_short)>;

struct Chosen {
    PmFit fit;
    std::vector<Step> path;  ///< all models that were tried, by bytes
    bool reached = true;     ///< false: no model of up to k_most_chosen_bytes reaches the goal, or none was expected to
};
inline constexpr std::size_t k_most_chosen_bytes = 512;
inline constexpr double k_most_delta_e = 100;

/// Searches for a model that meets `goal` among all forms, up to k_most_chosen_variates variates and, where
/// `options.axial` is false, both axial and general lobes. Models of each kind get short fits to a subset of the
/// observations. The most promising ones get full fits. All other settings come from `options`.
/// Errors: those of `fit_pm`; a goal out of range; fewer bytes than one lobe takes; cancelled.
Result<Chosen> choose_pm(const Observations& observations, const FitOptions& options, const SizeGoal& goal,
                         const JudgeModel& judge, const ProgressToken& progress = {});
inline constexpr int k_most_chosen_variates = 6;

}  // namespace srbf
