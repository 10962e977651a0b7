// The table of the options of a fit, which the command line, Python and pages read.
#include "fit/fit_options.h"

#include <fmt/format.h>

#include <limits>

#include "base/text.h"
#include "brdf/directions.h"
#include "fit/patch_fit.h"
#include "fit/request_traits.h"
#include "models/openpbr/openpbr_parameters.h"
#include "models/su/su_functions.h"
#include "observe/pair_weights.h"

namespace SRBF_NAMESPACE {
namespace {

using Text = std::string_view;
using Models = std::vector<Text>;
constexpr double k_min_albedo_limit = 1e-3, k_max_albedo_limit = 1000;
const Models k_all, k_of_pm{"pm"}, k_of_su{"su"}, k_of_ggx{"ggx"};

PmRequest& pm(FitRequest& request) { return std::get<PmRequest>(request.model); }
SuRequest& su(FitRequest& request) { return std::get<SuRequest>(request.model); }

/// Stores a value if there is one.
template <typename T, typename To> bool store(const std::optional<T>& value, To& to) {
    if (value) to = *value;
    return value.has_value();
}

/// A number within [min, max], which `set` stores.
template <typename T>
FitOptionRow number(FitOptionRow option, T min, T max, std::type_identity_t<void (*)(FitRequest&, T)> set) {
    option.expected = fmt::format("{} to {}", min, max);
    option.set = [=](FitRequest& request, Text text) {
        const auto value = to_number<T>(text);
        const bool is_accepted = value && *value >= min && *value <= max;
        if (is_accepted) set(request, *value);
        return is_accepted;
    };
    return option;
}

/// `option`, or a word in place of its number.
FitOptionRow or_word(FitOptionRow option, Text word, void (*set)(FitRequest&)) {
    option.expected += fmt::format(" or {}", word);
    option.set = [number = option.set, word, set](FitRequest& request, Text text) {
        if (text != word) return number(request, text);
        set(request);
        return true;
    };
    return option;
}

/// One of some words, which `set` stores unless it knows no such word.
FitOptionRow word(FitOptionRow option, const std::vector<Text>& words, bool (*set)(FitRequest&, Text)) {
    option.choices.assign(words.begin(), words.end());
    option.expected = fmt::format("{}", fmt::join(option.choices, " or "));
    option.set = set;
    return option;
}

FitOptionRow flag(FitOptionRow option, void (*set)(FitRequest&, bool)) {
    option.expected = "true or false";
    option.set = [set](FitRequest& request, Text text) {
        if (text != "true" && text != "false") return false;
        set(request, text == "true");
        return true;
    };
    return option;
}

template <typename T> std::string preset(const T& value) { return fmt::format("{}", value); }
const FitRequest k_request{};
const SuRequest k_su{};

/// Requests the model R if it has this name.
template <typename R> bool request_if_named(FitRequest& request, Text name) {
    const bool is_named = R::k_name == name;
    if (is_named) request.model = R();
    return is_named;
}

FitOptionRow model() {
    return []<typename... R>(std::type_identity<std::variant<R...>>) {
        std::string about = fmt::format("{}", fmt::join({fmt::format("{}: {}", R::k_name, R::k_about)...}, ";\n"));
        about += ";\ngltf, principled: OpenPBR without the parameters that glTF or Blender's Principled BSDF lacks";
        std::vector<Text> names(k_model_names.begin(), k_model_names.end());
        std::ranges::remove_copy(k_openpbr_surfaces, std::back_inserter(names), OpenPbrRequest::k_name);
        return word({"model", k_all, "NAME", about, preset(model_name(k_request))}, names,
                    [](FitRequest& r, Text name) {
                        const auto surface = openpbr_surface_named(name);
                        if (surface) r.model = OpenPbrRequest{*surface};
                        return surface || (request_if_named<R>(r, name) || ...);
                    });
    }(std::type_identity<AnyRequest>());
}

/// The forms that are fitted, with their summaries.
FitOptionRow form() {
    std::vector<Text> names;
    std::vector<std::string> summaries;
    for (const FormRow& row : k_form_rows) {
        if (!is_fitted(row.form)) continue;
        names.push_back(row.name);
        summaries.push_back(fmt::format("{}: {}", row.name, row.summary));
    }
    return word({"form", k_of_pm, "NAME",
                 fmt::format("{}.\nDefault: {}; for samples {}", fmt::join(summaries, "; "), name(k_default_form),
                             name(PmForm::extended))},
                names, [](FitRequest& r, Text text) { return store(form_named(text), pm(r).form); });
}

/// Patches are fitted to their sums; view by view, to values.
Text needs_values(const FitRequest& request) {
    return std::holds_alternative<SuRequest>(request.model) ? "" : "a table or samples";
}

/// The losses that a fit may minimise.
FitOptionRow objective() {
    std::string about = "What the fit minimises:";
    std::vector<Text> names;
    for (const Objective objective : objectives()) {
        names.push_back(name(objective));
        about += fmt::format("\n{}: {}", name(objective), summary(objective));
    }
    return word({.name = "objective",
                 .type = "NAME",
                 .about = about,
                 .preset = preset(name(k_request.objective)),
                 .state = [](const FitRequest& r) { return std::string(name(r.objective)); },
                 .needed_for_patches = needs_values},
                names, [](FitRequest& r, Text text) { return store(objective_named(text), r.objective); });
}
FitOptionRow max_theta() {
    std::vector<std::string> angles;
    for (const Objective objective : objectives())
        angles.push_back(fmt::format("{} {:g}", name(objective), default_max_theta(objective) / k_degree));
    return number<double>({.name = "max_theta",
                           .type = "DEG",
                           .about = fmt::format("Largest angle from the normal in the fit and in all errors,\n1 to "
                                                "89.9 degrees; default: {}",
                                                fmt::join(angles, ", ")),
                           .state = [](const FitRequest& r) { return fmt::format("{:.6g}", r.theta() / k_degree); },
                           .needed_for_patches = needs_values},
                          1, 89.9, [](FitRequest& r, double degrees) { r.max_theta = degrees * k_degree; });
}

std::vector<FitOptionRow> options_of_lobes() {
    return {
        form(),
        flag({.name = "as_measured",
              .models = k_of_pm,
              .about = fmt::format("Fit the table as it is, which is not reciprocal, by the form {}; not the mean "
                                   "with light\nand viewer exchanged, weighted by the cosines",
                                   name(PmForm::extended))},
             [](FitRequest& r, bool is) {
                 if (is) pm(r).form = PmForm::extended;
             }),
        or_word(number<double>({"albedo_limit", k_of_pm, "A|none",
                                "Limit on the directional albedo of every view and channel. Default: 1; none in forms "
                                "that\nare not reciprocal"},
                               k_min_albedo_limit, k_max_albedo_limit,
                               [](FitRequest& r, double albedo) { pm(r).albedo_limit = albedo; }),
                "none", [](FitRequest& r) { pm(r).albedo_limit = std::numeric_limits<double>::infinity(); }),
        number<int>(
            {.name = "variates",
             .models = k_of_pm,
             .type = "N",
             .about = fmt::format("Number of variates, the factors of a lobe, 1 to {}. Default: {}; {} in forms that "
                                  "are not reciprocal",
                                  k_max_variates, row_of(k_default_form).variates, row_of(PmForm::extended).variates),
             .needed_for_patches = [](const FitRequest& r) -> Text {
                 const auto* pm = std::get_if<PmRequest>(&r.model);
                 return pm && !pm->size ? "a number of lobes as well" : "";
             }},
            1, k_max_variates, [](FitRequest& r, int n) { pm(r).variates = n; }),
        flag({.name = "axial",
              .models = k_of_pm,
              .about = "Centres only at +z or -z; or general centres, which take 4 J N more bytes.\n"
                       "Default: general for anisotropic measurements",
              .negation = "no_axial"},
             [](FitRequest& r, bool is) { pm(r).axial = is; }),
        or_word(number<int>({"lobes", k_of_pm, "J|auto",
                             fmt::format("Number of lobes, 1 to {}; su has it for each sampled direction; ggx has 1 or "
                                         "2. auto takes for a table\nthe fewest with a visible error of at most {:g}, "
                                         "and for samples the most that they determine.\nDefault: {}, or {} in forms "
                                         "that are not reciprocal; auto for samples; 1 for ggx",
                                         k_max_fitted_lobes, k_default_delta_e, LobeCount{}.lobes,
                                         row_of(PmForm::extended).lobes)},
                            1, k_max_fitted_lobes, [](FitRequest& r, int n) { pm(r).size = LobeCount{n}; }),
                "auto", [](FitRequest& r) { pm(r).size = AutomaticLobes{}; }),
        number<int>({"lobes", k_of_su, "J"}, 1, k_max_view_lobes, [](FitRequest& r, int n) { su(r).lobes = n; }),
        number<int>({"lobes", k_of_ggx, "J"}, 1, k_max_ggx_lobes,
                    [](FitRequest& r, int n) { std::get<GgxRequest>(r.model).lobes = n; }),
    };
}

std::vector<FitOptionRow> options_of_views() {
    return {
        word({"discretise", k_of_su, "view|light", "The sampled direction; lobes are functions of the other one",
              preset(name(k_su.discretise))},
             {"view", "light"},
             [](FitRequest& r, Text text) { return store(discretise_named(text), su(r).discretise); }),
        number<int>(
            {"directions", k_of_su, "N",
             fmt::format("Number of sampled directions, {} to {}", k_min_views, k_max_views), preset(k_su.directions)},
            k_min_views, k_max_views, [](FitRequest& r, int n) { su(r).directions = n; }),
        or_word(number<int>(
                    {"interpolation", k_of_su, "rotated|K",
                     "Between the two samples adjacent in elevation, rotated to the azimuth of the direction,\n"
                     "for isotropic measurements; or between the K nearest samples",
                     preset(name(k_su.interpolation))},
                    1, k_max_neighbours,
                    [](FitRequest& r, int n) { su(r).interpolation = SuInterpolation::plain, su(r).neighbours = n; }),
                "rotated", [](FitRequest& r) { su(r).interpolation = SuInterpolation::rotated; }),
        word({"with_index", k_of_su, "cube|parabolic", "Store an index texture, the samples nearest to each direction"},
             {"cube", "parabolic"}, [](FitRequest& r, Text text) { return store(map_named(text), su(r).index); }),
    };
}

std::vector<FitOptionRow> further_options() {
    return {
        word({.name = "channels",
              .type = "NAME",
              .about = "rgb: colours; spectral: lobes with a coefficient for each wavelength of the measurement",
              .preset = "rgb",
              .needed_for_patches = [](const FitRequest& r) -> Text { return r.spectral ? "rgb" : ""; }},
             {"rgb", "spectral"},
             [](FitRequest& r, Text text) {
                 r.spectral = text == "spectral";
                 return r.spectral || text == "rgb";
             }),
        number<double>(
            {.name = "target_delta_e",
             .models = k_of_pm,
             .type = "E",
             .about = fmt::format("Take the fewest of up to {} lobes with at most this visible error against what is "
                                  "fitted, the\nmean Delta E (ITP) of pictures of a sphere, where 1 is just noticeable",
                                  *std::ranges::max_element(k_tried_lobes)),
             .needed_for_patches = [](const FitRequest&) -> Text { return "a table of values"; }},
            k_finest_delta_e, k_max_delta_e, [](FitRequest& r, double e) { pm(r).size = AutomaticLobes{e}; }),
        number<std::uint64_t>({.name = "seed",
                               .type = "SEED",
                               .about = "Seed of the random numbers",
                               .preset = preset(k_request.seed),
                               .state = [](const FitRequest& r) { return fmt::format("{}", r.seed); }},
                              0, std::numeric_limits<std::uint64_t>::max(),
                              [](FitRequest& r, std::uint64_t seed) { r.seed = seed; }),
        number<int>({"threads", k_all, "T", "Number of threads; 0: all of the machine. The model does not depend on it",
                     preset(k_request.threads)},
                    0, k_max_threads, [](FitRequest& r, int n) { r.threads = n; }),
    };
}

std::vector<FitOptionRow> all_options() {
    std::vector<FitOptionRow> options{model()};
    std::ranges::move(options_of_lobes(), std::back_inserter(options));
    options.push_back(objective());
    options.push_back(max_theta());
    std::ranges::move(options_of_views(), std::back_inserter(options));
    std::ranges::move(further_options(), std::back_inserter(options));
    return options;
}

Error wrong(std::string what, std::string expected = {}, std::string found = {}) {
    return {{}, {}, std::move(what), std::move(expected), std::move(found), ErrorCode::argument};
}

/// Returns an error if there is no such option, or if the model does not read it.
Result<Done> check_reads(Text name, Text model, const Spelling& spelled) {
    Models models;
    std::vector<std::string> names;
    bool exists = false;
    for (const FitOptionRow& option : fit_options()) {
        if (names.empty() || names.back() != spelled(option.name)) names.push_back(spelled(option.name));
        if (option.name != name) continue;
        if (option.models.empty() || std::ranges::count(option.models, model) > 0) return Done{};
        exists = true;
        std::ranges::copy(option.models, std::back_inserter(models));
    }
    if (!exists) return wrong("options", fmt::format("{}", fmt::join(names, ", ")), spelled(name));
    return wrong(fmt::format("{}: only with {} {}, found {}", spelled(name), spelled("model"),
                             fmt::join(models, " or "), model));
}

/// Returns an error if two options exclude each other.
Result<Done> check_together(const FitRequest& request, const FitTexts& texts, const Spelling& spelled) {
    if (request.spectral && !std::holds_alternative<PmRequest>(request.model))
        return wrong(fmt::format("{}: spectral only with {} pm", spelled("channels"), spelled("model")));
    if (texts.contains("target_delta_e") && texts.contains("lobes"))
        return wrong(fmt::format("{}: chooses the number of lobes; not together with {}", spelled("target_delta_e"),
                                 spelled("lobes")));
    if (texts.contains("as_measured") && texts.contains("form"))
        return wrong(fmt::format("{}: not together with {}; forms that are not reciprocal imply it",
                                 spelled("as_measured"), spelled("form")));
    return Done{};
}

}  // namespace

std::span<const FitOptionRow> fit_options() {
    static const std::vector<FitOptionRow> options = all_options();
    return options;
}

const FitOptionRow& fit_option(std::string_view name) {
    const auto options = fit_options();
    const auto option = std::ranges::find(options, name, &FitOptionRow::name);
    if (option == options.end()) misused("an unknown option of fits");
    return *option;
}

Result<FitRequest> fit_request(const FitTexts& texts, const Spelling& spelling) {
    const Spelling spelled = spelling ? spelling : [](Text name) { return std::string(name); };
    FitRequest request;
    for (const FitOptionRow& option : fit_options()) {
        const auto given = texts.find(option.name);
        const bool is_read = option.models.empty() || std::ranges::count(option.models, model_name(request)) > 0;
        if (given == texts.end() || !is_read || option.set(request, given->second)) continue;
        const bool is_first = &option == &fit_option(option.name);
        const std::string with = is_first ? "" : fmt::format(" with {} {}", spelled("model"), model_name(request));
        return wrong(spelled(option.name), option.expected + with, given->second);
    }
    for (const auto& [name, text] : texts)
        if (const auto reads = check_reads(name, model_name(request), spelled); !reads) return reads.error();
    if (const auto valid = check_together(request, texts, spelled); !valid) return valid.error();
    return request;
}

Result<Done> check_read(const Measured& measured, const FitRequest& request, const FitTexts& texts,
                        const Spelling& spelled) {
    const PatchFitter* patches = nullptr;
    if (const auto* bsdf = std::get_if<BsdfTable>(&measured.table))
        for (const auto& part : bsdf->band().part)
            if (part && patch_fit_of(*part)) patches = patch_fit_of(*part);
    if (!patches) return Done{};
    for (const FitOptionRow& option : fit_options()) {
        if (!option.needed_for_patches || !texts.contains(option.name)) continue;
        const Text needed = option.needed_for_patches(request);
        if (!needed.empty()) return wrong(spelled(option.name), std::string(needed), std::string(patches->fitted));
    }
    return Done{};
}

}  // namespace
