// Prints the terms that a multivariate fit minimises, and its stages.
#include <fmt/format.h>

#include "fit/requests.h"
#include "models/pm/search/schedule.h"
#include "observe/albedo_bound.h"
#include "observe/bound.h"
#include "observe/costs.h"
#include "observe/objectives.h"
#include "observe/pair_weights.h"

namespace SRBF_NAMESPACE {
namespace {

/// A row of the table of terms: what is an error, and what it costs.
struct Term {
    std::string name, of, weight;
};

std::vector<Term> terms_of(Objective objective) {
    std::vector<Term> terms{{"pairs", std::string(summary(objective)), "1"}};
    const bool of_pictures = traits(objective).of_pictures;
    for (const auto& [name, error_of, weight, importance] : traits(objective).further)
        if (weight)
            terms.push_back({std::string(name), std::string(error_of), fmt::format("{} of the pairs'", importance)});
    terms.push_back({"beyond", "f cos(theta_l) cos(theta_v) beyond the largest angle",
                     fmt::format("{} if all errors are its largest value", k_horizon_importance)});
    terms.push_back({"bounds",
                     fmt::format("f cos(theta_l) cos(theta_v) above {} times its largest value", k_most_excess),
                     fmt::format("{} of the loss, rising", k_excess_weight)});
    terms.push_back({"albedos",
                     fmt::format("directional albedo at 9 angles{}", of_pictures ? ", and at 3 near the horizon" : ""),
                     fmt::format("the loss, at most {}, if their errors are {:g} %", k_most_albedo_loss,
                                 100 * (of_pictures ? k_albedo_error_with_pixels : k_albedo_error))});
    if (!of_pictures) return terms;
    terms.push_back({"directional", "radiance under one directional light, of every phase angle",
                     fmt::format("{} times the loss; albedos {} times more", k_directional_lights,
                                 k_albedos_beside_directional_lights)});
    terms.push_back({"pixels", "delta E ITP in pictures under extended and directional lights (robust: linear above 1)",
                     fmt::format("{} times the loss for each of its mean", k_pixels)});
    return terms;
}

std::string work_of(const Stage& stage, const PmFitOptions& options) {
    switch (stage.kind) {
        case StageKind::grow:
            return fmt::format("{} lobes, one by one", options.lobes);
        case StageKind::perturb:
            return fmt::format("until {} lobes or variates were replaced", stage.perturbations_until(options));
        case StageKind::polish:
            return fmt::format("{} steps; useless lobes are replaced", stage.steps);
        case StageKind::by_pictures:
            return fmt::format("{} steps, ordered by delta E ITP", stage.steps);
        case StageKind::finish:
            return fmt::format("steps while they pay, rounding to 16 bits; bounds begin anew{}",
                               stage.pictures ? "; all that remain where pictures are far off" : "");
    }
    return "";
}

/// `bounds`: whether this stage or one before it adds bounds, which remain rows of those after it.
std::string rows_of(const Stage& stage, bool bounds) {
    return fmt::format("{}, beyond{}{}{}",
                       stage.pairs == Pairs::all ? "all pairs" : fmt::format("{} pairs", std::size_t(stage.pairs)),
                       bounds ? ", bounds" : "", stage.albedos ? ", albedos" : "",
                       stage.pictures ? ", directional lights, pixels" : "");
}

}  // namespace

std::string explain(const FitRequest& request) {
    if (!std::holds_alternative<PmRequest>(request.model)) return "";
    const PmFitOptions options = pm_options(request, true, k_default_form);
    std::string text = fmt::format("objective {} to {:g} degrees, form {}, {} lobes of {} variates, {} starts\n",
                                   name(request.objective), request.theta() / k_degree, name(options.form),
                                   options.lobes, options.variates, starts_of(options));
    if (is_reciprocal(options.form))
        text +=
            "fitted to the mean with light and viewer exchanged, each value weighted by the cosine it was divided by\n";
    text += '\n';
    text += fmt::format("{:<13} {:<66} {}\n", "term", "error of", "cost");
    std::vector<Term> terms = terms_of(request.objective);
    if (const double limit = options.albedo_limit.value_or(default_albedo_limit(options.form)); !std::isinf(limit))
        terms.push_back(
            {"albedo limit", fmt::format("directional albedo above {:g}", limit),
             fmt::format("{} times all albedos', rising; in the end lobes are lowered", k_albedo_bound_cost)});
    for (const Term& term : terms) text += fmt::format("{:<13} {:<66} {}\n", term.name, term.of, term.weight);
    text += fmt::format("\n{:<13} {:<64} {:>10}  {}\n", "stage", "rows and terms", "candidates", "work");
    bool bounds = false;
    for (const Stage& stage : schedule(traits(request.objective).of_pictures)) {
        bounds = bounds || stage.adds_exceeded_pairs;
        text += fmt::format("{:<13} {:<64} {:>10}  {}\n", stage.name, rows_of(stage, bounds), stage.candidates(options),
                            work_of(stage, options));
    }
    return text;
}

}  // namespace srbf
