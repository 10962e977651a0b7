// The search for a model that meets a goal.
#pragma once
#include <functional>
#include <vector>

#include "models/pm/search/fit_pm.h"
#include "srbf/fit.h"

namespace SRBF_NAMESPACE {

inline constexpr int k_most_chosen_variates = 6;
/// Returns the error of a model by the objective's measure, for a target ΔE_ITP the mean ΔE_ITP. With `in_short`, a few
/// thousand pairs are enough. It is called from several threads at once.
using JudgeModel = std::function<double(const PmModel& model, bool in_short)>;

struct Chosen {
    PmFit fit;
    std::vector<Trial> path;  ///< all models that were tried, by bytes
    bool reached = true;  ///< false: no model of up to k_most_chosen_bytes reaches the goal, or none was expected to
};
/// Searches for a model that meets `goal` among the forms that are reciprocal if and only if `options.form` is, up to
/// k_most_chosen_variates variates and, where `options.axial` is false, both axial and general lobes. Models of each
/// kind get short fits to a subset of the observations. The most promising ones get full fits. All other settings come
/// from `options`.
/// Errors: those of `fit_pm`; a goal out of range; fewer bytes than one lobe takes; cancelled.
Result<Chosen> choose_pm(const Observations& observations, const PmFitOptions& options, const SizeGoal& goal,
                         const JudgeModel& judge, const ProgressToken& progress = {});
}  // namespace srbf
