// The library for a page or a script: C functions of one WebAssembly module, called by web/binding.js. Subjects,
// which are measurements and models, have numbers from 1. A function that may fail returns 0 on failure; `content`
// is then the error in one line. Otherwise it returns a number above 0, and `content` is its result.
// Keys of JSON are in camel case, as web/package/srbf.d.ts documents them; names of JavaScript are in snake case.
#include <fmt/format.h>

#include <cctype>
#include <cmath>
#include <cstdlib>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <ranges>
#include <vector>

#include "api/table_file.h"
#include "app/output.h"
#include "base/files.h"
#include "base/text.h"
#include "code/offered_code.h"
#include "edit/lobes.h"
#include "errors/picture_errors.h"
#include "extras/blender/script.h"
#include "extras/render/app/page_of.h"
#include "extras/render/environment.h"
#include "extras/render/material.h"
#include "extras/render/slices.h"
#include "fit/fit_options.h"
#include "measured/tables.h"
#include "models/bsdf/bsdf_functions.h"
#include "observe/pair_weights.h"
#include "srbf/edit.h"
#include "srbf/file.h"
#include "srbf/fit.h"
#include "srbf/metrics.h"
#include "srbf/shading_code.h"

#define SRBF_EXPORT(name) __attribute__((export_name("srbf_" #name)))

/// The host's progress callback; it returns 0 to cancel.
extern "C" __attribute__((import_module("srbf"), import_name("progress"))) int srbf_host_progress(const char* stage,
                                                                                                  std::size_t size,
                                                                                                  double fraction);

namespace SRBF_NAMESPACE {
namespace {

std::vector<std::unique_ptr<LoadedFile>> g_subjects;
/// Fitters of the open measurements, kept because later fits reuse the observations.
std::map<int, Fitter> g_fitters;
std::vector<std::byte> g_content;
Image g_studio(1, 1);   // until the host sets the bundled environment
ClosureSum g_closures;  // of the last script for Blender

int set_content(std::span<const std::byte> bytes) {
    g_content.assign(bytes.begin(), bytes.end());
    return 1;
}
int set_content(std::string_view text) { return set_content(as_bytes(text)); }
int set_json(const Json& json) {
    return set_content(std::string_view(json.dump(-1, ' ', false, Json::error_handler_t::replace)));
}
int fail(const Error& error) { return set_content(std::string_view(message(error))), 0; }
/// Sets the content to a result or to its error.
template <typename T> int set_result(const Result<T>& result) {
    return result ? set_content(*result) : fail(result.error());
}

const LoadedFile* subject_of(int number) {
    const bool known = number > 0 && std::size_t(number) <= g_subjects.size();
    return known ? g_subjects[std::size_t(number) - 1].get() : nullptr;
}
int keep(LoadedFile subject) {
    g_subjects.push_back(std::make_unique<LoadedFile>(std::move(subject)));
    return int(g_subjects.size());
}
/// The error of an argument of a host's call.
Error invalid(std::string source, std::string field, std::string expected, std::string found) {
    return {std::move(source), {}, std::move(field), std::move(expected), std::move(found), ErrorCode::argument};
}
Error unknown(std::string expected) { return invalid("subject", "number", std::move(expected), "none"); }

const Model* model_of(const LoadedFile* subject) { return subject ? std::get_if<Model>(&subject->content) : nullptr; }
const Measured* measured_of(const LoadedFile* subject) {
    return subject ? std::get_if<Measured>(&subject->content) : nullptr;
}

/// "max_theta" in camel case: "maxTheta".
std::string in_camel_case(std::string_view name) {
    std::string text;
    bool begins_word = false;
    for (const char c : name) {
        if (c != '_') text += begins_word ? char(std::toupper(c)) : c;
        begins_word = c == '_';
    }
    return text;
}

/// The request that a JSON object of fit options describes.
Result<FitRequest> request_of(std::string_view text) {
    const Json json = Json::parse(text.begin(), text.end(), nullptr, false);
    if (!json.is_object()) return invalid("options", {}, "an object of JSON", std::string(text.substr(0, 40)));
    FitTexts texts;
    for (const auto& [key, value] : json.items()) {
        std::string name;
        for (const char c : key) name += std::isupper(c) ? std::string{'_', char(std::tolower(c))} : std::string{c};
        texts[name] = value.is_string() ? value.get<std::string>() : value.dump();
    }
    auto request = fit_request(texts, in_camel_case);
    if (request) return request;
    Error error = request.error();
    error.source = "options";
    return error;
}

// ---- Fits --------------------------------------------------------------------------------------------------------

/// The approximate fraction of a fit's time before its errors are evaluated.
constexpr double k_fit_fraction = 0.75;

Fitter& fitter_of(int number, const Measured& measured) {
    return g_fitters.try_emplace(number, measured).first->second;
}

/// The format and the sizes of a fit, as JSON.
Json summary_of(const Measured& measured, const Model& model) {
    return {{"format", measured.format}, {"sourceBytes", measured.bytes}, {"bytes", payload_bytes(model)}};
}
void add_appearance(Json& json, const char* name, const Appearance& appearance) {
    json[name] = {{"deltaE", appearance.mean.delta_e},
                  {"worst", appearance.worst_delta_e},
                  {"flip", appearance.mean.flip},
                  {"verdict", srbf::name(verdict(appearance.mean))},
                  {"level", int(verdict(appearance.mean))}};
}

struct ReportedFit {
    Model model;
    Json report;
};
Result<ReportedFit> fit_and_report(int number, const Measured& measured, const FitRequest& request,
                                   const ProgressToken& progress) {
    if (std::holds_alternative<BsdfTable>(measured.table)) {
        auto sides = fit_bsdf(measured, request, progress);
        if (!sides) return sides.error();
        Json report = summary_of(measured, sides->model);
        double worst = 0;
        for (const PartFit& part : sides->parts)
            for (const Hemispherical& sum : part.hemispherical)
                worst = std::max(worst, std::abs(sum.fitted - sum.measured));
        report["twoSided"] = true;
        report["energyError"] = worst;
        report["seconds"] = sides->fit_seconds;
        return ReportedFit{std::move(sides->model), std::move(report)};
    }
    Fitter& fitter = fitter_of(number, measured);
    auto outcome = fitter.fit(request, progress.subrange(0, k_fit_fraction));
    if (!outcome) return outcome.error();
    if (const auto done = fitter.measure(*outcome, request, progress.subrange(k_fit_fraction, 1)); !done)
        return done.error();
    Json report = summary_of(measured, outcome->model);
    report["twoSided"] = false;
    report["seconds"] = outcome->fit_seconds;
    add_appearance(report, "seen", headline_errors(*outcome->errors));
    report["heldout"] = outcome->errors->heldout.*measure_of(request.objective);
    report["headline"] = headline(*outcome->errors);
    if (outcome->noise && outcome->against_smoothed) add_appearance(report, "smoothed", *outcome->against_smoothed);
    return ReportedFit{std::move(outcome->model), std::move(report)};
}

ProgressToken host_progress() {
    return
        [](const Progress& now) { return srbf_host_progress(now.stage.data(), now.stage.size(), now.fraction) != 0; };
}

std::string text_of(const char* text, std::size_t size) { return std::string(text, size); }

/// The model as its file stores it, so that everything derived from it is what the program derives from the file.
Result<Model> reread(const Model& model, const std::string& name) { return read_model(write_model(model), name); }

}  // namespace

/// The environment of pages, which the host has set.
Image page_environment() { return g_studio; }

SRBF_EXPORT(allocate) void* allocate(std::size_t size) { return std::malloc(size); }
SRBF_EXPORT(free) void release(void* bytes) { std::free(bytes); }
SRBF_EXPORT(content) const std::byte* content() { return g_content.data(); }
SRBF_EXPORT(content_size) std::size_t content_size() { return g_content.size(); }

/// Reads a measurement or a model from the bytes of a file with this name. The content describes it as JSON.
SRBF_EXPORT(open) int open(const char* name, std::size_t name_size, const std::byte* bytes, std::size_t size) {
    const std::string path = text_of(name, name_size);
    const std::span<const std::byte> file(bytes, size);
    if (is_safetensors(file)) {
        auto model = read_model(file, path);
        if (!model) return fail(model.error());
        set_json(Json{{"model", true}, {"bytes", payload_bytes(*model)}});
        return keep({path, *std::move(model)});
    }
    auto measured = read_measured(file, path);
    if (!measured) return fail(measured.error());
    const auto* samples = std::get_if<ScatteredSamples>(&measured->table);
    set_json(Json{{"model", false},
                  {"format", measured->format},
                  {"bytes", measured->bytes},
                  {"isotropic", is_isotropic(*measured)},
                  {"samples", samples ? Json(samples->wl.size()) : Json()},
                  {"notes", notes(*measured)},
                  {"twoSided", std::holds_alternative<BsdfTable>(measured->table)}});
    return keep({path, *std::move(measured)});
}
SRBF_EXPORT(close) void close(int number) {
    g_fitters.erase(number);
    if (subject_of(number)) g_subjects[std::size_t(number) - 1].reset();
}

/// A quick first model of a one-sided measurement. The content is its report as JSON.
SRBF_EXPORT(draft) int draft(int number, const char* options, std::size_t size) {
    const LoadedFile* subject = subject_of(number);
    const Measured* measured = measured_of(subject);
    if (!measured) return fail(unknown("that of a measurement"));
    auto request = request_of({options, size});
    if (!request) return fail(request.error());
    auto outcome = fitter_of(number, *measured).draft(*request, host_progress());
    if (!outcome) return fail(outcome.error());
    Json report = summary_of(*measured, outcome->model);
    report["last"] = std::holds_alternative<ScatteredSamples>(measured->table);  // the fit, whose errors take five more
    set_json(report);
    return keep({stem_of(subject->path) + ".srbf", std::move(outcome->model)});
}

/// Fits a measurement with options in JSON. The content is a report as JSON.
SRBF_EXPORT(fit) int fit_subject(int number, const char* options, std::size_t size) {
    const LoadedFile* subject = subject_of(number);
    const Measured* measured = measured_of(subject);
    if (!measured) return fail(unknown("that of a measurement"));
    const auto request = request_of({options, size});
    if (!request) return fail(request.error());
    auto fit = fit_and_report(number, *measured, *request, host_progress());
    if (!fit) {
        Error error = fit.error();
        if (error.code != ErrorCode::cancelled) error.source = subject->path;
        return fail(error);
    }
    const std::string path = stem_of(subject->path) + ".srbf";
    auto model = reread(fit->model, path);
    if (!model) return fail(model.error());
    set_json(fit->report);
    return keep({path, *std::move(model)});
}

// ---- Edits -------------------------------------------------------------------------------------------------------

/// Sets the content to the numbers that pictures of edits need before their fit, as JSON: the fractions of the body,
/// and the roughness of the highlight (`PM_EDITED` of srbf/shader.h). It is null for a model that cannot be edited.
SRBF_EXPORT(highlight) int highlight(int number) {
    const Model* model = model_of(subject_of(number));
    const auto* pm = model ? std::get_if<PmModel>(&model->model) : nullptr;
    if (!pm || !pm->wavelength.empty()) return set_json(Json());
    const double roughness = roughness_of(evaluator(separate_highlight(*pm).highlight));
    return set_json(Json{{"shares", body_fractions(*pm)}, {"roughness", roughness > 0 ? roughness : 1}});
}

/// Applies edits to a model: a JSON object with numbers `roughen`, `saturate` and `hue` [degrees] and colours
/// `highlight` and `body`, all optional. The content describes the result as JSON.
SRBF_EXPORT(edit) int edit(int number, const char* text, std::size_t size) {
    const LoadedFile* subject = subject_of(number);
    const Model* model = model_of(subject);
    if (!model) return fail(unknown("that of a model"));
    std::map<std::string, double> amount{{"roughen", 1}, {"saturate", 1}, {"hue", 0}};
    std::optional<Tint> tint;
    const Json json = Json::parse(text, text + size, nullptr, false);
    bool is_read = json.is_object();
    for (const auto& [key, value] : json.items()) {
        if (amount.contains(key) && value.is_number()) {
            amount[key] = value.get<double>();
        } else if ((key == "highlight" || key == "body") && value.is_array() && value.size() == 3 &&
                   std::ranges::all_of(value, [](const Json& channel) { return channel.is_number(); })) {
            if (!tint) tint.emplace();
            (key == "highlight" ? tint->highlight : tint->body) = {value[0].get<float>(), value[1].get<float>(),
                                                                   value[2].get<float>()};
        } else {
            is_read = false;
        }
    }
    if (!is_read)
        return fail(
            invalid("edits", "JSON", "an object with roughen, highlight, body, saturate, hue", text_of(text, size)));
    std::vector<Edit> edits;
    if (amount["roughen"] != 1) edits.emplace_back(Roughen{amount["roughen"]});
    if (tint) edits.emplace_back(*tint);
    if (amount["saturate"] != 1) edits.emplace_back(Saturate{amount["saturate"]});
    if (amount["hue"] != 0) edits.emplace_back(TurnHue{amount["hue"]});
    auto result = edit_model(*model, edits, {.progress = host_progress()});
    if (!result) return fail(result.error());
    const std::string path = stem_of(subject->path) + "_edited.srbf";
    auto stored = reread(*result, path);
    if (!stored) return fail(stored.error());
    set_json(Json{{"bytes", payload_bytes(*stored)}, {"edits", result->provenance["edits"]}});
    return keep({path, *std::move(stored)});
}

/// Sets the content to the bytes of a model's file.
SRBF_EXPORT(model_file) int model_file(int number) {
    const Model* model = model_of(subject_of(number));
    return model ? set_content(std::span<const std::byte>(write_model(*model))) : fail(unknown("that of a model"));
}

/// Sets the content to the names that `code` takes, as JSON.
SRBF_EXPORT(code_languages) int code_languages() {
    Json names;
    for (const CodeLanguageRow& row : k_code_languages) names.push_back(row.name);
    for (const CodeModule& module : code_modules()) names.push_back(module.name);
    return set_json(names);
}

/// Sets the content to shading code of a model, with `sampling` and with `environment` as srbf.d.ts says.
SRBF_EXPORT(code) int code(int number, const char* language, std::size_t size, int sampling, int environment) {
    const LoadedFile* subject = subject_of(number);
    const Model* model = model_of(subject);
    if (!model) return fail(unknown("that of a model"));
    const std::string to = text_of(language, size), name = identifier(stem_of(subject->path));
    std::vector<NamedModel> named{{name, model}};
    for (const CodeModule& module : code_modules()) {
        if (to != module.name) continue;
        if (const auto* bsdf = std::get_if<BsdfModel>(&model->model)) {
            named.clear();
            for (std::size_t p = 0; p < k_parts; ++p)
                if (bsdf->part[p]) named.push_back({fmt::format("{}_{}", name, k_part_names[p]), bsdf->part[p].get()});
        }
        return set_result(module.text(named, named.size() == 1 ? named[0].name : name, 0));
    }
    if (const auto known = code_language_named(to)) {
        CodeOptions options{.language = *known, .sampling = sampling != 0};
        if (environment != 0) options.with = {"environment"};
        return set_result(shading_code(named, name, options));
    }
    const auto modules = std::views::transform(code_modules(), &CodeModule::name);
    return fail(
        invalid("code", "language", fmt::format("{} or {}", fmt::join(modules, ", "), code_language_names()), to));
}

/// Sets the content to a script that makes a material for Blender from a measurement or a model.
SRBF_EXPORT(blender) int blender_material(int number) {
    const LoadedFile* subject = subject_of(number);
    if (!subject) return fail(unknown("that of a measurement or a model"));
    if (const auto valid = check_reflection(*subject, "blender"); !valid) return fail(valid.error());
    auto sum = fit_closures(evaluator(*subject), {}, host_progress());
    if (!sum) return fail(sum.error());
    g_closures = *std::move(sum);
    const NamedClosures material{identifier(stem_of(subject->path)), g_closures};
    return set_content(std::string_view(blender_script({&material, 1})));
}
/// Sets the content to the mean ΔE_ITP of pictures of the last of these scripts against its subject, as JSON.
SRBF_EXPORT(blender_error) int blender_error(int number) {
    const LoadedFile* subject = subject_of(number);
    if (!subject || g_closures.knots() == 0) return fail(unknown("that of a script's measurement or model"));
    const Evaluate f = evaluator(*subject), fitted = evaluator(g_closures);
    const bool isotropic = is_isotropic(f, default_max_theta(k_default_objective));
    return set_json(compare_pictures(f, {&fitted, 1}, {.is_isotropic = isotropic})[0].mean.delta_e);
}

/// Sets the content to the subject as a table, for a file with this name.
SRBF_EXPORT(table) int table(int number, const char* file, std::size_t size) {
    const LoadedFile* subject = subject_of(number);
    if (!subject) return fail(unknown("that of a measurement or a model"));
    const Format* format = format_written_to(text_of(file, size));
    if (!format)
        return fail(invalid("table", "name", "one that ends in " + extensions_of_formats(), text_of(file, size)));
    auto bytes = table_file(subject->content, *format, {.description = stem_of(subject->path)});
    if (bytes) return set_result(bytes);
    Error error = bytes.error();
    error.source = subject->path;
    error.expected += fmt::format(", as {} tables are", format->name);
    return fail(error);
}

/// Evaluates f [1/sr] of the subject for `count` pairs: `wl`, `wv` and `f` have three floats each.
SRBF_EXPORT(evaluate) int evaluate(int number, const Vec3f* wl, const Vec3f* wv, Rgb* f, std::size_t count) {
    const LoadedFile* subject = subject_of(number);
    if (!subject) return fail(unknown("that of a measurement or a model"));
    evaluator (*subject)({wl, count}, {wv, count}, {f, count});
    return 1;
}

/// Sets the environment `studio`, a Radiance file.
SRBF_EXPORT(set_studio) int set_studio(const std::byte* bytes, std::size_t size) {
    const auto image = read_hdr({bytes, size}, "studio.hdr");
    if (!image) return fail(image.error());
    g_studio = halved(*image);
    return 1;
}
/// Sets the content to data for web/viewer.js: that which all pictures share, and that of one subject.
SRBF_EXPORT(viewer_data) int set_viewer_data() { return set_content(std::string_view(viewer_data())); }
SRBF_EXPORT(viewer_material) int set_viewer_material(int number) {
    const LoadedFile* subject = subject_of(number);
    if (!subject) return fail(unknown("that of a measurement or a model"));
    PageMaterial page_material = shown(*subject);
    if (const Measured* measured = measured_of(subject)) {
        if (!is_isotropic(*measured)) return set_json(Json());
        const bool two_sided = std::holds_alternative<BsdfTable>(measured->table);
        auto material = two_sided ? material_of(subject->content, subject->path)
                                  : Result<Material>(tabulate_merl(evaluator(*subject), k_page_table));
        if (!material) return fail(material.error());
        page_material.material = *std::move(material);
    }
    return set_content(std::string_view(viewer_material(page_material)));
}

/// Sets the content to SVG plots of a measurement and of its model (0: none), concatenated.
SRBF_EXPORT(slices) int slices(int measured, int model) {
    std::vector<SliceCurve> curves;
    bool both_sides = false;
    for (const auto& [number, colour] : {std::pair(measured, "var(--ink)"), std::pair(model, "#0072b2")})
        if (const LoadedFile* subject = subject_of(number)) {
            const bool two_sided = is_two_sided(subject->content);
            both_sides = both_sides || two_sided;
            curves.push_back({number == measured ? "measured" : "fitted", colour, evaluator(*subject), two_sided});
        }
    if (curves.empty()) return fail(unknown("that of a measurement or a model"));
    std::string drawings;
    for (const double theta : k_slice_theta)
        drawings += both_sides ? lobe_drawing(curves, theta * k_degree, LobeScale::logarithmic)
                               : slice_drawing(curves, theta * k_degree);
    return set_content(std::string_view(drawings));
}

/// Sets the content to the page of a model with its measurement, as `srbf export --to html --reference` writes it.
SRBF_EXPORT(page) int page(int model, int measured) {
    const LoadedFile *subject = subject_of(model), *reference = subject_of(measured);
    if (!model_of(subject)) return fail(unknown("that of a model"));
    const bool usable = measured_of(reference) && !is_two_sided(reference->content);
    return set_content(std::string_view(page_html(page_of({*subject}, usable ? reference : nullptr))));
}

}  // namespace
