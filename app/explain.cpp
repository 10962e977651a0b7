// `srbf explain` prints what a multivariate fit minimises, and its stages.
#include <memory>

#include "app/commands.h"
#include "app/fit_options.h"
#include "fit/request_traits.h"

namespace srbf {

void add_explain(CommandLine& app, int& status) {
    const auto texts = std::make_shared<FitTexts>();
    const Subcommand sub = app.add_subcommand("explain", "Print the terms that a fit minimises, and its stages");
    add_fit_options(sub, *texts, {"objective", "max_theta"});
    sub.add_option(
           "--lobes", [texts](const std::string& text) { (*texts)["lobes"] = text; },
           fmt::format("Number of lobes, 1 to {}", k_most_fitted_lobes))
        .type_name("J")
        .default_text(std::to_string(LobeCount{}.lobes));
    add_fit_options(sub, *texts, {"variates"});
    sub.footer("Example:\n  srbf explain --objective cube-root --lobes 16");
    sub.callback([sub, texts, &status] {
        fmt::print("{}", explain(requested(sub, *texts)));
        status = k_done;
    });
}

}  // namespace srbf
