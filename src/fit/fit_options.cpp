// The table of the options of a fit. The command line, Python and pages have what stands here.
#include "fit/fit_options.h"

#include <fmt/format.h>

#include <limits>

#include "base/text.h"
#include "brdf/directions.h"
#include "fit/request_traits.h"
#include "models/openpbr/openpbr_parameters.h"
#include "models/su/su_functions.h"
#include "observe/pair_weights.h"

namespace SRBF_NAMESPACE {
namespace {

using Text = std::string_view;
using Models = std::vector<Text>;
constexpr double k_least_albedo_limit = 1e-3, k_most_albedo_limit = 1000;
const Models k_all, k_of_pm{"pm"}, k_of_su{"su"}, k_of_ggx{"ggx"};

PmRequest& pm(FitRequest& request) { return std::get<PmRequest>(request.model); }
SuRequest& su(FitRequest& request) { return std::get<SuRequest>(request.model); }

/// Stores a value if there is one.
template <typename T, typename To> bool store(const std::optional<T>& value, To& to) {
    if (value) to = *value;
    return value.has_value();
}

/// A number within [least, most], which `set` stores.
template <typename T>
FitOptionRow number(FitOptionRow option, T least, T most, std::type_identity_t<void (*)(FitRequest&, T)> set) {
    option.expected = fmt::format("{} to {}", least, most);
    option.set = [=](FitRequest& request, Text text) {
        const auto value = to_number<T>(text);
        const bool is_accepted = value && *value >= least && *value <= most;
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
template <typename Words> FitOptionRow word(FitOptionRow option, const Words& words, bool (*set)(FitRequest&, Text)) {
    option.choices.assign(std::begin(words), std::end(words));
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

FitOptionRow model() {
    return []<typename... R>(std::type_identity<std::variant<R...>>) {
        std::string about = fmt::format("{}", fmt::join({fmt::format("{}: {}", R::k_name, R::k_about)...}, ";\n"));
        about += ";\ngltf, principled: only those that glTF with its extensions or Blender's Principled BSDF has";
        std::vector<Text> names(k_model_names.begin(), k_model_names.end());
        std::ranges::remove_copy(k_openpbr_surfaces, std::back_inserter(names), OpenPbrRequest::k_name);
        return word({"model", k_all, "NAME", about, preset(model_name(k_request))}, names,
                    [](FitRequest& r, Text name) {
                        const auto surface = openpbr_surface_named(name);
                        if (surface) r.model = OpenPbrRequest{*surface};
                        return surface || ((R::k_name == name && (r.model.emplace<R>(), true)) || ...);
                    });
    }(std::type_identity<AnyRequest>());
}

/// The options of multivariate lobes.
void add_lobes(std::vector<FitOptionRow>& to) {
    std::vector<std::string_view> forms;
    std::vector<std::string> summaries;
    for (const FormRow& row : k_form_rows) {
        if (!is_fitted(row.form)) continue;
        forms.push_back(row.name);
        summaries.push_back(fmt::format("{}: {}", row.name, row.summary));
    }
    to.push_back(word({"form", k_of_pm, "NAME",
                       fmt::format("{}.\nDefault: {}; for samples {}", fmt::join(summaries, "; "), name(k_default_form),
                                   name(PmForm::extended))},
                      forms, [](FitRequest& r, Text text) { return store(form_named(text), pm(r).form); }));
    to.push_back(
        flag({.name = "as_measured",
              .models = k_of_pm,
              .about = fmt::format("Fit the table as it is, which is not reciprocal, by the form {}; not the mean "
                                   "with light\nand viewer exchanged, weighted by the cosines",
                                   name(PmForm::extended))},
             [](FitRequest& r, bool is) {
                 if (is) pm(r).form = PmForm::extended;
             }));
    FitOptionRow limit = number<double>(
        {"albedo_limit", k_of_pm, "A|none",
         "Limit on the directional albedo of every view and channel. Default: 1; none in forms that\n"
         "are not reciprocal"},
        k_least_albedo_limit, k_most_albedo_limit, [](FitRequest& r, double albedo) { pm(r).albedo_limit = albedo; });
    to.push_back(
        or_word(limit, "none", [](FitRequest& r) { pm(r).albedo_limit = std::numeric_limits<double>::infinity(); }));
    to.push_back(number<int>(
        {"variates", k_of_pm, "N",
         fmt::format("Number of variates, the factors of a lobe, 1 to {}. Default: {}; {} in forms that are not "
                     "reciprocal",
                     k_most_variates, row_of(k_default_form).variates, row_of(PmForm::extended).variates)},
        1, k_most_variates, [](FitRequest& r, int n) { pm(r).variates = n; }));
    to.push_back(flag({.name = "axial",
                       .models = k_of_pm,
                       .about = "Centres only at +z or -z; or general centres, which take 4 J N more bytes.\n"
                                "Default: general for anisotropic measurements",
                       .negation = "no_axial"},
                      [](FitRequest& r, bool is) { pm(r).axial = is; }));
}

/// The number of lobes, of each model that has one.
void add_counts(std::vector<FitOptionRow>& to) {
    FitOptionRow lobes = number<int>(
        {"lobes", k_of_pm, "J|auto",
         fmt::format("Number of lobes, 1 to {}; for su per sampled direction; for ggx 1 or 2. "
                     "auto: for a table the\n"
                     "fewest with a visible error of at most {:g}; for samples the most that "
                     "they determine. Default: {}, or {} in\nforms that are not reciprocal; for samples auto; for "
                     "ggx 1",
                     k_most_fitted_lobes, k_default_delta_e, LobeCount{}.lobes, row_of(PmForm::extended).lobes)},
        1, k_most_fitted_lobes, [](FitRequest& r, int n) { pm(r).size = LobeCount{n}; });
    to.push_back(or_word(lobes, "auto", [](FitRequest& r) { pm(r).size = AutomaticLobes{}; }));
    to.push_back(
        number<int>({"lobes", k_of_su, "J"}, 1, k_most_view_lobes, [](FitRequest& r, int n) { su(r).lobes = n; }));
    to.push_back(number<int>({"lobes", k_of_ggx, "J"}, 1, k_most_ggx_lobes,
                             [](FitRequest& r, int n) { std::get<GgxRequest>(r.model).lobes = n; }));
}

/// The rows of the loss that the fit minimises, and of its domain.
void add_objective(std::vector<FitOptionRow>& to) {
    std::string about = "What the fit minimises:";
    std::vector<std::string_view> names;
    std::vector<std::string> angles;
    for (const Objective of : objectives()) {
        names.push_back(name(of));
        about += fmt::format("\n{}: {}", name(of), summary(of));
        angles.push_back(fmt::format("{} {:g}", name(of), default_max_theta(of) / k_degree));
    }
    to.push_back(word({"objective", k_all, "NAME", about, preset(name(k_request.objective))}, names,
                      [](FitRequest& r, Text text) { return store(objective_named(text), r.objective); }));
    to.push_back(number<double>({"max_theta", k_all, "DEG",
                                 fmt::format("Largest angle from the normal in the fit and in all errors,\n"
                                             "1 to 89.9 degrees; default: {}",
                                             fmt::join(angles, ", "))},
                                1, 89.9, [](FitRequest& r, double degrees) { r.max_theta = degrees * k_degree; }));
}

/// The options of view-by-view models.
void add_views(std::vector<FitOptionRow>& to) {
    using Words = std::vector<Text>;
    to.push_back(word({"discretise", k_of_su, "view|light",
                       "The sampled direction; lobes are functions of the other one", preset(name(k_su.discretise))},
                      Words{"view", "light"},
                      [](FitRequest& r, Text text) { return store(discretise_named(text), su(r).discretise); }));
    to.push_back(number<int>(
        {"directions", k_of_su, "N", fmt::format("Number of sampled directions, {} to {}", k_least_views, k_most_views),
         preset(k_su.directions)},
        k_least_views, k_most_views, [](FitRequest& r, int n) { su(r).directions = n; }));
    to.push_back(or_word(
        number<int>({"interpolation", k_of_su, "rotated|K",
                     "Between the two samples adjacent in elevation, rotated to the azimuth of the direction,\n"
                     "for isotropic measurements; or between the K nearest samples",
                     preset(name(k_su.interpolation))},
                    1, k_most_neighbours,
                    [](FitRequest& r, int n) { su(r).interpolation = SuInterpolation::plain, su(r).neighbours = n; }),
        "rotated", [](FitRequest& r) { su(r).interpolation = SuInterpolation::rotated; }));
    to.push_back(
        word({"with_index", k_of_su, "cube|parabolic", "Store an index texture, the samples nearest to each direction"},
             Words{"cube", "parabolic"}, [](FitRequest& r, Text text) { return store(map_named(text), su(r).index); }));
}

/// The channels, and the goal of the size.
void add_goals(std::vector<FitOptionRow>& to) {
    to.push_back(
        word({"channels", k_all, "NAME",
              "rgb: colours; spectral: lobes with a coefficient for each wavelength of the measurement", "rgb"},
             std::vector<Text>{"rgb", "spectral"}, [](FitRequest& r, Text text) {
                 r.spectral = text == "spectral";
                 return r.spectral || text == "rgb";
             }));
    to.push_back(number<double>(
        {"target_delta_e", k_of_pm, "E",
         fmt::format("pm: the fewest of up to {} lobes with at most this visible error against what is fitted, the\n"
                     "mean Delta E (ITP) of pictures of a sphere, where 1 is just noticeable",
                     *std::ranges::max_element(k_tried_lobes))},
        k_finest_delta_e, k_most_delta_e, [](FitRequest& r, double e) { pm(r).size = AutomaticLobes{e}; }));
}

void add_running(std::vector<FitOptionRow>& to) {
    to.push_back(number<std::uint64_t>({"seed", k_all, "SEED", "Seed of the random numbers", preset(k_request.seed)}, 0,
                                       std::numeric_limits<std::uint64_t>::max(),
                                       [](FitRequest& r, std::uint64_t seed) { r.seed = seed; }));
    to.push_back(
        number<int>({"threads", k_all, "T", "Number of threads; 0: all of the machine. The model does not depend on it",
                     preset(k_request.threads)},
                    0, k_most_threads, [](FitRequest& r, int n) { r.threads = n; }));
}

/// To give one of `options` where `holds` does not is an error that says `where` they are read. Names of options are in
/// braces there.
struct Rule {
    std::vector<Text> options;
    Text where;
    bool (*holds)(const FitRequest&, const FitTexts&);
};
const Rule k_rules[] = {
    {{"channels"},
     "spectral only with {model} pm",
     [](const FitRequest& r, const FitTexts&) { return !r.spectral || std::holds_alternative<PmRequest>(r.model); }},
    {{"target_delta_e"},
     "chooses the number of lobes; not together with {lobes}",
     [](const FitRequest&, const FitTexts& texts) { return !texts.contains("lobes"); }},
    {{"as_measured"},
     "not together with {form}; forms that are not reciprocal imply it",
     [](const FitRequest&, const FitTexts& texts) { return !texts.contains("form"); }},
};

Error wrong(std::string what, std::string expected = {}, std::string found = {}) {
    return {{}, {}, std::move(what), std::move(expected), std::move(found), ErrorCode::argument};
}

/// An error if there is no such option, or if the model does not read it.
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

Result<Done> check_rules(const FitRequest& request, const FitTexts& texts, const Spelling& spelled) {
    for (const Rule& rule : k_rules)
        for (const Text option : rule.options) {
            if (!texts.contains(option) || rule.holds(request, texts)) continue;
            std::string where(rule.where);
            for (std::size_t at = 0; (at = where.find('{', at)) != where.npos;) {
                const std::size_t end = where.find('}', at);
                where.replace(at, end + 1 - at, spelled(where.substr(at + 1, end - at - 1)));
            }
            return wrong(fmt::format("{}: {}", spelled(option), where));
        }
    return Done{};
}

}  // namespace

std::span<const FitOptionRow> fit_options() {
    static const std::vector<FitOptionRow> options = [] {
        std::vector<FitOptionRow> all{model()};
        for (const auto add : {add_lobes, add_counts, add_objective, add_views, add_goals, add_running}) add(all);
        return all;
    }();
    return options;
}

const FitOptionRow& fit_option(std::string_view name) {
    const auto all = fit_options();
    const auto at = std::ranges::find(all, name, &FitOptionRow::name);
    if (at == all.end()) misused("an unknown option of fits");
    return *at;
}

Result<FitRequest> fit_request(const FitTexts& texts, const Spelling& spelling) {
    const Spelling spelled = spelling ? spelling : [](Text name) { return std::string(name); };
    FitRequest request;
    for (const FitOptionRow& option : fit_options()) {
        const auto at = texts.find(option.name);
        const bool is_read = option.models.empty() || std::ranges::count(option.models, model_name(request)) > 0;
        if (at == texts.end() || !is_read || option.set(request, at->second)) continue;
        const bool is_first = &option == &fit_option(option.name);
        const std::string with = is_first ? "" : fmt::format(" with {} {}", spelled("model"), model_name(request));
        return wrong(spelled(option.name), option.expected + with, at->second);
    }
    for (const auto& [name, text] : texts)
        if (const auto reads = check_reads(name, model_name(request), spelled); !reads) return reads.error();
    if (const auto valid = check_rules(request, texts, spelled); !valid) return valid.error();
    return request;
}

}  // namespace srbf
