// `srbf explain`: what a multivariate fit minimises, and in which stages.
#include <memory>

#include "app/commands.h"
#include "app/fit_options.h"
#include "srbf/directions.h"

namespace srbf {

void add_explain(CommandLine& app, int& status) {
    struct State {
        int lobes = LobeCount{}.lobes, variates = PmRequest{}.variates;
        std::string objective = std::string(name(FitRequest{}.objective));
        double max_theta = 0;
    };
    const auto state = std::make_shared<State>();
    const Subcommand sub = app.add_subcommand("explain", "Print the terms that a fit minimises, and its stages");
    add_objective(sub, state->objective);
    add_max_theta(sub, state->max_theta);
    sub.add_option("--lobes", state->lobes, fmt::format("Number of lobes, 1 to {}", k_most_fitted_lobes))
        .type_name("J")
        .check(within<int>(fit_option("lobes")))
        .capture_default_str();
    add_number_of_variates(sub, state->variates);
    sub.footer("Example:\n  srbf explain --objective cube-root --lobes 16");
    sub.callback([state, &status] {
        FitRequest request{.model = PmRequest{.variates = state->variates, .size = LobeCount{state->lobes}}};
        request.objective = *objective_named(state->objective);
        if (state->max_theta > 0) request.max_theta = state->max_theta * k_degree;
        fmt::print("{}", explain(request));
        status = k_done;
    });
}

}  // namespace srbf
