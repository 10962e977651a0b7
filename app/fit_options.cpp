#include "app/fit_options.h"

#include <filesystem>
#include <limits>

#include "app/commands.h"

namespace srbf {

PmRequest LobeSettings::request() const {
    PmRequest pm;
    pm.form = *form_named(form);
    pm.variates = variates;
    if (axial != 0) pm.axial = axial > 0;
    pm.reciprocal = reciprocal;
    pm.log_scale = !no_scale;
    return pm;
}

LobeOptions add_lobe_options(const Subcommand& sub, LobeSettings& to) {
    LobeOptions of;
    std::vector<std::string> forms, summaries;
    for (const FormRow& row : k_form_rows) {
        forms.emplace_back(row.name);
        summaries.push_back(fmt::format("{}: {}", row.name, row.summary));
    }
    const auto known = [is_one = one_of(forms)](std::string& text) {
        return form_named(text) ? std::string() : is_one(text);
    };
    of.form = sub.add_option("--form", to.form, fmt::format("{}", fmt::join(summaries, "; ")))
                  .type_name("NAME")
                  .check(known, forms)
                  .capture_default_str();
    of.variates = add_number_of_variates(sub, to.variates);
    of.axial = sub.add_flag("--axial{1},--no-axial{-1}", to.axial,
                            "Centres only at +z or -z; or general centres, which take 4 J N more bytes.\n"
                            "Default: general for anisotropic measurements");
    return of;
}

void add_single_lobe_options(const Subcommand& sub, LobeSettings& to, LobeOptions& of) {
    of.reciprocal =
        sub.add_flag("--reciprocal", to.reciprocal,
                     "f(wl, wv) = f(wv, wl): pairs of variates share bandwidths; N must be even. Larger errors");
    of.no_scale =
        sub.add_flag("--no-scale", to.no_scale,
                     "Store no log scales: bounds the coefficients in the fit.\nSaves 2 J bytes; larger errors");
}

std::vector<Reading> lobe_readings(const LobeOptions& of, const LobeSettings& to) {
    return {
        {{of.no_scale},
         "only with --form gaussian; other forms always store log scales",
         [&] { return form_named(to.form) == PmForm::gaussian; }},
        {{of.variates}, "an even number with --reciprocal", [&] { return !to.reciprocal || to.variates % 2 == 0; }},
    };
}

Option add_number_of_variates(const Subcommand& sub, int& to) {
    return sub
        .add_option("--variates", to,
                    fmt::format("Number of variates, the factors of a lobe, 1 to {}", k_most_variates))
        .type_name("N")
        .check(within<int>(fit_option("variates")))
        .capture_default_str();
}

Option add_objective(const Subcommand& sub, std::string& to) {
    std::string about = "What the fit minimises:";
    std::vector<std::string> names;
    for (const Objective objective : objectives()) {
        names.emplace_back(name(objective));
        about += fmt::format("\n{}: {}", names.back(), summary(objective));
    }
    return sub.add_option("--objective", to, about).type_name("NAME").one_of(names).capture_default_str();
}

void add_max_theta(const Subcommand& sub, double& to) {
    std::vector<std::string> defaults;
    for (const Objective objective : objectives())
        defaults.push_back(fmt::format("{} {:g}", name(objective), default_max_theta(objective) / k_degree));
    sub.add_option(
           "--max-theta", to,
           fmt::format("Largest angle from the normal in the fit and in all errors,\n1 to 89.9 degrees; default: {}",
                       fmt::join(defaults, ", ")))
        .type_name("DEG")
        .check(within<double>(fit_option("max_theta")));
}

void add_seed(const Subcommand& sub, std::uint64_t& to) {
    sub.add_option("--seed", to, "Seed of the random numbers")
        .type_name("SEED")
        .check(within(std::uint64_t(0), std::numeric_limits<std::uint64_t>::max()))
        .capture_default_str();
}

Option add_threads(const Subcommand& sub, int& to) {
    return sub.add_option("--threads", to, "Number of threads; 0: all of the machine. The model does not depend on it")
        .type_name("T")
        .check(within<int>(fit_option("threads")))
        .capture_default_str();
}

bool is_folder(const std::string& output) {
    std::error_code ignored;
    return output.ends_with('/') || std::filesystem::is_directory(output, ignored);
}

}  // namespace srbf
