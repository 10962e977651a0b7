#include "srbf/shading_code.h"

#include <cctype>
#include <ranges>

#include "base/printable.h"
#include "code/added_code.h"
#include "code/blend_code.h"
#include "code/bsdf_code.h"
#include "code/defined_names.h"
#include "code/lanes_code.h"
#include "code/model_program.h"
#include "code/offered_code.h"
#include "code/print.h"
#include "code/program_printer.h"
#include "generated/code/extra_code.h"
#include "models/kind/parameters.h"
#include "models/model_files.h"
#include "srbf/sampling.h"

namespace SRBF_NAMESPACE {
namespace {

/// The entry functions: their names in the kernel's language, and in the code.
Names entries(const CodeOptions& options, const AddedCode& added) {
    Names names = added.entries;
    names.insert({"brdf", "brdf"});
    if (options.sampling) names.insert({{"sample_light", "sample"}, {"light_pdf", "pdf"}, {"value_pdf", "value_pdf"}});
    if (options.albedo) names.insert({"directional_albedo", "albedo"});
    return names;
}

/// The entries of a map, and functions that look up its textures if the language allows it.
Names map_entries(const CodeOptions& options, const AddedCode& added) {
    Names names = entries(options, added);
    if (syntax::reads_buffers(options.language)) names.insert({{"layer", "layer"}, {"coefficients", "coefficients"}});
    return names;
}

/// Returns the definitions that native functions of models require.
std::string lanes_text(std::span<const NamedModel> models, const CodeOptions& options) {
    const auto is_pm = [](const NamedModel& named) { return std::holds_alternative<PmModel>(named.model->model); };
    if (options.language != CodeLanguage::c || !(options.sampling || std::ranges::any_of(models, is_pm))) return "";
    std::set<std::string> known;
    const std::string lobes = lobes_in_c(known);
    return options.sampling ? lobes + mixtures_in_c(known) : lobes;
}

/// The functions that a text in C defines.
std::set<std::string> functions_in_c(const std::string& text) {
    const std::string_view head = "\nSRBF_FN ";
    std::set<std::string> names;
    for (std::size_t position = text.find(head); position != text.npos; position = text.find(head, position + 1)) {
        const std::size_t end = text.find('(', position), begin = text.rfind(' ', end) + 1;
        names.insert(text.substr(begin, end - begin));
    }
    return names;
}

std::string kind_text(const Model& model) {
    if (const auto* pm = std::get_if<PmModel>(&model.model))
        return fmt::format("{} lobes of {} variates, form {}", pm->lobes, pm->variates, name(pm->form));
    if (const auto* su = std::get_if<SuModel>(&model.model)) return fmt::format("view by view, {} lobes", su->lobes);
    if (std::holds_alternative<OpenPbrModel>(model.model)) return "a surface by parameters of OpenPBR";
    return std::string(kind_words(model));
}

/// Describes a model: its name, kind, size and provenance.
std::string describe_model(const NamedModel& named) {
    const Model& model = *named.model;
    std::string text = fmt::format("{}: {}, {} bytes.", named.name, kind_text(model), payload_bytes(model));
    for (const auto& [key, value] : model.provenance) text += fmt::format("\n  {}", printable(key + " " + value));
    return text;
}

}  // namespace

std::string identifier(std::string_view text) {
    std::string name;
    for (const char c : text) {
        const bool is_letter = std::isalnum(static_cast<unsigned char>(c)) && static_cast<unsigned char>(c) < 128;
        if (is_letter)
            name += c;
        else if (!name.empty() && name.back() != '_')
            name += '_';
    }
    while (!name.empty() && name.back() == '_') name.pop_back();
    std::string letters;
    for (const char c : name)
        if (c != '_') letters += char(std::tolower(static_cast<unsigned char>(c)));
    const bool is_reserved = name.starts_with("gl_") || name.starts_with("webgl_") || letters == "measured" ||
                             letters == "meshstandard";  // names of classes in three.js and its module
    if (name.empty() || std::isdigit(static_cast<unsigned char>(name[0])) || is_reserved)
        name.insert(0, name.empty() ? "brdf" : "brdf_");
    return name;
}

std::optional<CodeLanguage> code_language_named(std::string_view name) {
    const auto row = std::ranges::find(k_code_languages, name, &CodeLanguageRow::name);
    return row == std::end(k_code_languages) ? std::nullopt : std::optional(row->language);
}

std::string code_language_names() {
    return fmt::format("{}", fmt::join(std::views::transform(k_code_languages, &CodeLanguageRow::name), ", "));
}

Result<std::string> shading_code(std::span<const NamedModel> models, std::string_view prefix,
                                 const CodeOptions& requested, const AddedCode& added) {
    CodeOptions options = requested;
    std::vector<NamedModel> brdfs;  // includes the parts of BSDFs
    std::vector<PartModels> parts;
    std::string list, bsdf_text;
    DefinedNames defined;
    const auto is_bsdf = [](const NamedModel& named) { return std::holds_alternative<BsdfModel>(named.model->model); };
    if (added.sampling) options.sampling = true;
    // Samples choose among the parts of a BSDF by their albedos.
    if (options.sampling && std::ranges::any_of(models, is_bsdf)) options.albedo = true;
    const Names names = entries(options, added);
    const auto add_name = [&](const std::string& name) { list += (list.empty() ? "" : ", ") + name; };
    for (const NamedModel& named : models) {
        if (is_bsdf(named)) {
            const PartModels& part = parts.emplace_back(part_models(named, options.sampling));
            brdfs.insert(brdfs.end(), part.named.begin(), part.named.end());
            for (const std::string& name : bsdf_functions(named, options.sampling)) add_name(name);
            const auto code = bsdf_code(named, options, defined);
            if (!code) return code.error();
            bsdf_text += syntax::comment_text(describe_model(named)) + "\n" + *code;
        } else {
            brdfs.push_back(named);
            for (const auto& [name, printed_name] : names) add_name(fmt::format("{}_{}", named.name, printed_name));
        }
    }
    std::vector<NamedProgram> programs;
    std::vector<std::string> roots;
    for (const auto& [name, printed_name] : names) roots.push_back(name);
    for (const NamedModel& named : brdfs) {
        if (const auto* su = std::get_if<SuModel>(&named.model->model)) {
            const auto refuse = [&](const char* what, const char* expected, const char* found) {
                return Error{named.name, {}, what, expected, found, ErrorCode::argument};
            };
            if (su->interpolation == SuInterpolation::plain)
                return refuse("model", "interpolation of rotated views", "plain interpolation");
            if (options.sampling) return refuse("sampling code", "a model that is not view by view", "one that is");
            if (!syntax::reads_buffers(options.language))
                return refuse("view-by-view model", "a language with global buffers", "one without");
        }
        programs.push_back({named.name, describe_model(named), program_of(*named.model, options, roots, added)});
    }
    ProgramPrinter printer(std::move(programs), prefix, options.language, names);
    if (const auto distinct = printer.add_names(defined); !distinct) return distinct.error();
    const std::string lanes = lanes_text(brdfs, options);
    for (const std::string& name : functions_in_c(lanes))
        if (const auto distinct = defined.add(name, "the functions of srbf"); !distinct) return distinct.error();
    std::string definitions = lanes + printer.text() + bsdf_text;
    if (options.blend) {
        const auto blend = blend_code(models, prefix, options, defined);
        if (!blend) return blend.error();
        definitions += *blend;
        for (const std::string& name : blend_functions(prefix, options)) add_name(name);
    }
    return syntax::whole_text(options.language, list, std::string(prefix) + "_BRDF", definitions);
}

Result<std::string> map_code(const TexelMap& map, std::string_view name, const CodeOptions& options,
                             const AddedCode& added) {
    const auto refuse = [&](const char* what, const char* expected, const char* found) {
        return Error{std::string(name), {}, what, expected, found, ErrorCode::argument};
    };
    if (options.blend) return refuse("code of a map", "values, albedos and light", "a blend");
    if (options.sampling || added.sampling) return refuse("code of a map", "values, albedos and light", "sampling");
    Names names = map_entries(options, added);
    std::vector<std::string> roots;
    std::string list;
    for (const auto& [root, printed_name] : names) {
        roots.push_back(root);
        list += fmt::format("{}{}_{}", list.empty() ? "" : ", ", name, printed_name);
    }
    const Model basis = mean_texel(map);
    std::string description = fmt::format("{}: {} lobes of {} variates, form {}, {} bytes, which all texels share.",
                                          name, map.basis.lobes, map.basis.variates, srbf::name(map.basis.form),
                                          payload_bytes(map.basis) - 6 * std::size_t(map.basis.lobes));
    description += fmt::format("\n  map {} x {}", map.width, map.height());
    for (const auto& [key, value] : map.provenance) description += fmt::format("\n  {}", printable(key + " " + value));
    NamedProgram program{std::string(name), description,
                         program_of(basis, options, roots, added, ParameterStorage::arguments)};
    names.insert({"Pm", "Coefficients"});
    return syntax::whole_text(options.language, list, std::string(name) + "_BRDF",
                              ProgramPrinter({std::move(program)}, name, options.language, names).text());
}

namespace {

/// The functions of all extras that the options name. Returns an error if no extra has one of them.
Result<AddedCode> added_code(const CodeOptions& options) {
    AddedCode all;
    for (const auto extra : k_extra_code) {
        AddedCode added = extra().functions(options);
        if (added.entries.empty()) continue;
        all.entries.merge(added.entries);
        all.sampling |= added.sampling;
        all.albedo |= added.albedo;
        all.text = [first = std::move(all.text), next = std::move(added.text)](const auto& model, bool is_basis,
                                                                               auto& program, auto& defines) {
            const std::string before = first ? first(model, is_basis, program, defines) : "";
            return before + next(model, is_basis, program, defines);
        };
    }
    for (const std::string& name : options.with)
        if (std::ranges::find(code_features(), name, &CodeFeature::name) == code_features().end())
            return Error{"code", {}, "functions", "those of this program", name, ErrorCode::argument};
    return all;
}
template <typename Row> std::vector<Row> rows_of_extras(std::vector<Row> CodeExtra::*member) {
    std::vector<Row> rows;
    for (const auto extra : k_extra_code) {
        const std::vector<Row> added = extra().*member;
        rows.insert(rows.end(), added.begin(), added.end());
    }
    return rows;
}

}  // namespace

std::span<const CodeFeature> code_features() {
    static const std::vector<CodeFeature> features = rows_of_extras(&CodeExtra::features);
    return features;
}
std::span<const CodeModule> code_modules() {
    static const std::vector<CodeModule> modules = rows_of_extras(&CodeExtra::modules);
    return modules;
}

Result<std::string> shading_code(std::span<const NamedModel> models, std::string_view prefix,
                                 const CodeOptions& options) {
    const auto added = added_code(options);
    return added ? shading_code(models, prefix, options, *added) : added.error();
}
Result<std::string> map_code(const TexelMap& map, std::string_view name, const CodeOptions& options) {
    const auto added = added_code(options);
    return added ? map_code(map, name, options, *added) : added.error();
}

}  // namespace
