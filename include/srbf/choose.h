// The model that is asked for by its bytes or its error: level 4.
#pragma once
#include <cstddef>
#include <functional>
#include <optional>
#include <variant>
#include <vector>

#include "srbf/fit.h"

namespace srbf {

/// The least held-out error of all models of at most so many bytes.
struct ByteBudget {
    std::size_t bytes = 160;  ///< 12..k_most_chosen_bytes
};
/// The fewest bytes of all models whose held-out error, by the objective's own measure, is at most this.
struct TargetError {
    double error = 0.005;  ///< (0, 1]
};
using SizeGoal = std::variant<ByteBudget, TargetError>;

/// A model on the way.
struct Step {
    PmForm form = PmForm::extended;
    bool axial = true;
    int lobes = 0, variates = 0;
    std::size_t bytes = 0;
    double error = 0;    ///< of the objective, held out
    bool whole = false;  ///< fitted as `fit_pm` does by itself; else in short, which tells little more than an order
};

/// The objective's error of a model; `in_short`: a few thousand pairs will do. It is called from several threads at once.
using JudgeModel = std::function<double(const PmModel& model, bool in_short)>;

struct Chosen {
    PmFit fit;
    std::vector<Step> path;  ///< what was tried, by bytes
    bool reached = true;  ///< false: none of up to k_most_chosen_bytes is as good as asked for, or was expected to be
};
inline constexpr std::size_t k_most_chosen_bytes = 512;

/// Looks for the model of that goal among all forms, up to k_most_chosen_variates variates and, where `options.axial` is false, axial and
/// general lobes. Of each kind models are fitted in short to a part of the observations; those that then look best are fitted whole, with
/// `options` for all else. Errors: those of `fit_pm`; a goal out of its range; fewer bytes than one lobe takes; cancelled.
Result<Chosen> choose_pm(const Observations& observations, const FitOptions& options, const SizeGoal& goal,
                         const JudgeModel& judge, const ProgressToken& progress = {});
inline constexpr int k_most_chosen_variates = 6;

}  // namespace srbf
