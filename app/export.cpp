#include <memory>
#include <set>

#include "app/commands.h"
#include "app/export.h"
#include "app/map_layers.h"
#include "app/output.h"
#include "app/surface_files.h"
#include "base/errors.h"
#include "base/files.h"
#include "base/paths.h"
#include "base/printable.h"
#include "code/offered_code.h"
#include "generated/app/extra_exports.h"
#include "models/model_files.h"
#include "srbf/file.h"

namespace srbf {
namespace {

/// A kind of source text for models, and for a map if `map` is set.
struct TextKind {
    std::string name, about = {};
    bool by_part = false;  ///< each part of a BSDF becomes a material of its own
    std::function<Result<std::string>(const ExportCommand&, const std::vector<NamedModel>&, const std::string& prefix)>
        models;
    /// `texture`: the file beside the text that holds the coefficients; empty: the host supplies them.
    std::function<Result<std::string>(const ExportCommand&, const TexelMap&, const std::string& name)> map = {};
    bool has_texture = false;
};

/// The names of a model and of its parts, reduced to what distinguishes class names: lower case without underscores.
std::vector<std::string> keys_of(const std::string& name, const Model& model) {
    std::vector<std::string> keys{name};
    if (std::holds_alternative<BsdfModel>(model.model))
        for (const std::string_view part : k_part_names) keys.push_back(fmt::format("{}_{}", name, part));
    for (std::string& key : keys) {
        std::erase(key, '_');
        for (char& c : key) c = char(std::tolower(static_cast<unsigned char>(c)));
    }
    return keys;
}

/// Names models after their files. Files whose names differ only in capitals and underscores get numbers; a
/// numbered name never equals the name of another file.
std::vector<NamedModel> names_of(const std::vector<LoadedFile>& models) {
    std::vector<NamedModel> named;
    std::set<std::string> taken, file_keys;
    const auto are_in = [](const std::set<std::string>& names, const std::vector<std::string>& keys) {
        return std::ranges::any_of(keys, [&](const std::string& key) { return names.contains(key); });
    };
    for (const LoadedFile& subject : models)
        for (const auto& key : keys_of(identifier(stem_of(subject.path)), std::get<Model>(subject.content)))
            file_keys.insert(key);
    for (const LoadedFile& subject : models) {
        const Model& model = std::get<Model>(subject.content);
        const std::string name = identifier(stem_of(subject.path));
        std::string unique = name;
        for (int i = 2;
             are_in(taken, keys_of(unique, model)) || (unique != name && are_in(file_keys, keys_of(unique, model)));
             ++i)
            unique = fmt::format("{}_{}", name, i);
        for (const std::string& key : keys_of(unique, model)) taken.insert(key);
        named.push_back({unique, &model});
    }
    return named;
}

/// The models, with each BSDF replaced by its parts, as in the exported code.
std::vector<NamedModel> with_parts(const std::vector<NamedModel>& named) {
    std::vector<NamedModel> parts;
    for (const NamedModel& item : named) {
        const auto* bsdf = std::get_if<BsdfModel>(&item.model->model);
        if (!bsdf) parts.push_back(item);
        for (std::size_t p = 0; bsdf && p < k_parts; ++p)
            if (bsdf->part[p]) parts.push_back({fmt::format("{}_{}", item.name, k_part_names[p]), bsdf->part[p].get()});
    }
    return parts;
}

/// The file for the numbers of a view-by-view model.
std::string data_path(const ExportCommand& command, const NamedModel& model) {
    return command.beside(model.name + ".data");
}

NewFile file_of(const std::string& path, std::span<const std::byte> bytes) {
    return {path, {bytes.begin(), bytes.end()}};
}

std::vector<std::byte> texture_of(const ExportCommand& command, const TexelMap& map) {
    return map_ktx2(map, command.coefficients == "byte" ? LayerNumbers::bytes : LayerNumbers::halves);
}

Result<Done> write_text(const ExportCommand& command, const TextKind& kind, const TexelMap& map) {
    const std::string name = identifier(stem_of(command.files[0])), texture = command.beside(name + ".ktx2");
    std::vector<std::string> outputs{command.output};
    if (kind.has_texture) outputs.insert(outputs.begin(), texture);
    if (const auto writable = check_outputs(command.files, outputs); !writable) return writable;
    return within_memory(texture, [&]() -> Result<Done> {
        std::vector<NewFile> files;
        if (kind.has_texture) files.push_back({texture, texture_of(command, map)});
        const auto text = kind.map(command, map, name);
        if (!text) return text.error();
        files.push_back(file_of(command.output, as_bytes(*text)));
        return write_files(files);
    });
}

Result<Done> write_text(const ExportCommand& command, const TextKind& kind, const std::vector<LoadedFile>& models) {
    if (!command.coefficients.empty())
        return argument_error(command.files[0], "input", "a map (--coefficients)", "a model");
    const std::vector<NamedModel> models_by_name = names_of(models), brdfs = with_parts(models_by_name);
    std::vector<std::string> outputs{command.output};
    std::vector<NewFile> files;
    for (const NamedModel& brdf : brdfs)
        if (const auto* su = std::get_if<SuModel>(&brdf.model->model)) {
            outputs.push_back(data_path(command, brdf));
            files.push_back(file_of(outputs.back(), std::as_bytes(std::span<const float>(shading_data(*su)))));
        }
    if (const auto writable = check_outputs(command.files, outputs); !writable) return writable;
    const std::vector<NamedModel>& named = kind.by_part ? brdfs : models_by_name;
    const auto text =
        kind.models(command, named, named.size() == 1 ? named[0].name : identifier(stem_of(command.output)));
    if (!text) return text.error();
    files.push_back(file_of(command.output, as_bytes(*text)));
    return write_files(files);
}

int write_text(const ExportCommand& command, const TextKind& kind) {
    const auto loaded = load_models_or_map(command.files);
    if (!loaded) return complain(loaded.error());
    const auto* map = std::get_if<TexelMap>(&*loaded);
    if (!map) return status_of(write_text(command, kind, std::get<std::vector<LoadedFile>>(*loaded)));
    return kind.map ? status_of(write_text(command, kind, *map)) : complain(map_error(command.files[0]));
}

int write_texture(const ExportCommand& command) {
    const auto map = load_map(command);
    if (!map) return complain(map.error());
    return status_of(
        within_memory(command.output, [&] { return write_file(command.output, texture_of(command, *map)); }));
}

/// The text of one surface; prints its visible error.
Result<std::string> surface(const ExportCommand& command, const SurfaceFile& row,
                            const std::vector<NamedModel>& named) {
    if (named.size() != 1) return argument_error(command.output, "models", "one surface", std::to_string(named.size()));
    auto text = surface_text(row, named[0]);
    const auto& provenance = named[0].model->provenance;
    const auto heldout = provenance.find("heldout_delta_e_itp");
    if (const auto entry = provenance.find("delta_e_itp"); text && entry != provenance.end())
        fmt::print(
            "{}: ΔE_ITP {} against the measurement, as srbf draws it{}\n", printable(command.output),
            printable(entry->second),
            heldout != provenance.end() ? fmt::format(", {} in cross-validation", printable(heldout->second)) : "");
    const std::string_view parameters = row.name == "glb" ? "gltf" : row.name;
    const auto fitted = provenance.find("surface");
    const bool lacks_some = parameters == "gltf" || parameters == "principled";
    if (text && lacks_some && fitted != provenance.end() && fitted->second != parameters)
        fmt::print("{0}: the program lacks some parameters of {1}; a fit with --model {0} has only its own\n",
                   parameters, printable(fitted->second));
    return text;
}

CodeOptions code_options(const ExportCommand& command, CodeLanguage language) {
    CodeOptions options{.language = language, .with = command.with};
    options.sampling = std::erase(options.with, "sampling") > 0;
    options.albedo = std::erase(options.with, "albedo") > 0;
    options.blend = std::erase(options.with, "blend") > 0;
    return options;
}

bool has_texture(const std::string& kind) {
    return kind == "ktx2" || std::ranges::any_of(code_modules(), [&](const CodeModule& module) {
               return module.name == kind && module.map_text != nullptr;
           });
}
bool is_code(const std::string& kind) { return code_language_named(kind).has_value(); }

std::vector<TextKind> text_kinds() {
    std::vector<TextKind> kinds;
    for (const CodeLanguageRow& row : k_code_languages) {
        const auto options = [language = row.language](const auto& command) { return code_options(command, language); };
        kinds.push_back({.name = std::string(row.name),
                         .models = [=](const auto& command, const auto& models,
                                       auto& prefix) { return shading_code(models, prefix, options(command)); },
                         .map = [=](const auto& command, const auto& map,
                                    auto& name) { return map_code(map, name, options(command)); }});
    }
    for (const CodeModule& row : code_modules()) {
        TextKind kind{std::string(row.name), std::string(row.summary), row.by_part,
                      [=](const auto&, const auto& models, auto& prefix) { return row.text(models, prefix, 0); }};
        kind.has_texture = row.map_text != nullptr;
        if (kind.has_texture)
            kind.map = [=](const auto&, const auto& map, auto& name) {
                return row.map_text(map, name, name + ".ktx2", 0);
            };
        kinds.push_back(std::move(kind));
    }
    for (const SurfaceFile& row : surface_files())
        kinds.push_back({.name = std::string(row.name),
                         .about = std::string(row.about),
                         .models = [&row](const auto& command, const auto& models, auto&) {
                             return surface(command, row, models);
                         }});
    return kinds;
}

/// The help's description of source code.
std::string about_code() {
    return fmt::format(
        "{}: source code with functions NAME_brdf of each model, named by its file, and\n"
        "the numbers as constants, for a shader or a program (c: a header for C99, C++ and CUDA)",
        code_language_names());
}
constexpr const char* k_about_textures =
    "\nktx2: the coefficients of a map (srbf map), as layers of a texture of KTX 2 with its levels; its code has\n"
    "NAME_brdf(wl, wv, NAME_coefficients(u, v))";
constexpr const char* k_about_models =
    "\nThe numbers of a view-by-view model go into NAME.data beside the code. The functions of a BSDF are\n"
    "NAME_bsdf, for directions on either side, and NAME_beam, the fraction of light that passes unscattered";

/// The kinds of files that the core writes.
Exports core_exports() {
    Exports exports{{}, about_code(), {}};
    for (TextKind& kind : text_kinds()) {
        if (!kind.about.empty()) exports.about += "\n" + kind.name + ": " + kind.about;
        exports.kinds.push_back(
            {kind.name, [kind](const ExportCommand& command) { return write_text(command, kind); }});
    }
    exports.kinds.push_back({"ktx2", write_texture});
    exports.about += k_about_textures;
    return exports;
}

}  // namespace

std::string ExportCommand::beside(const std::string& name) const {
    return system_files::path_text(system_files::path_of(output).parent_path() / system_files::path_of(name));
}

Result<ModelsOrMap> load_models_or_map(const std::vector<std::string>& files) {
    std::vector<LoadedFile> models;
    for (const std::string& file : files) {
        auto loaded = load_file_or_map(file);
        if (!loaded) return loaded.error();
        if (auto* map = std::get_if<TexelMap>(&*loaded)) {
            if (files.size() > 1) return map_error(file);
            if (const auto valid = check_layers(*map, file); !valid) return valid.error();
            return ModelsOrMap(std::move(*map));
        }
        models.push_back(std::get<LoadedFile>(*std::move(loaded)));
        if (!models.back().is_model()) return Error{file, {}, "input", "a model", "a measurement (see --reference)"};
    }
    return ModelsOrMap(std::move(models));
}

Result<std::vector<LoadedFile>> load_models(const std::vector<std::string>& files) {
    auto loaded = load_models_or_map(files);
    if (!loaded) return loaded.error();
    if (auto* models = std::get_if<std::vector<LoadedFile>>(&*loaded)) return std::move(*models);
    return map_error(files[0]);
}

Result<TexelMap> load_map(const ExportCommand& command) {
    auto loaded = load_models_or_map(command.files);
    if (!loaded) return loaded.error();
    auto* map = std::get_if<TexelMap>(&*loaded);
    if (!map) return argument_error(command.files[0], "input", "a map of shared lobes", "a model");
    if (const auto writable = check_outputs(command.files, {command.output}); !writable) return writable.error();
    return std::move(*map);
}

void add_export(CommandLine& app, int& status) {
    const auto command = std::make_shared<ExportCommand>();
    const Subcommand sub = app.add_subcommand("export", "Export models as shading code, or as an interactive page");
    sub.add_option("MODEL", command->files, "Fitted models, or a map of shared lobes").type_name("").required();
    Exports exports = core_exports();
    for (const auto add : k_extra_exports) add(sub, *command, exports);
    std::vector<std::string> names, features{"sampling", "albedo", "blend"};
    for (const ExportKind& kind : exports.kinds) names.push_back(kind.name);
    sub.add_option("--to", command->to, exports.about + k_about_models).type_name("KIND").required().one_of(names);
    std::string about =
        "sampling: also NAME_sample, NAME_pdf and NAME_value_pdf; albedo: also NAME_albedo, the fraction of light\n"
        "that is reflected to a view; blend: also OUTPUT_brdf(wl, wv, weights) of two or three models, mixed by a mask";
    for (const CodeFeature& feature : code_features()) {
        about += fmt::format(";\n{}: {}", feature.name, feature.summary);
        features.emplace_back(feature.name);
    }
    const Option with = sub.add_option("--with", command->with, about + "; may be repeated")
                            .type_name("WHAT")
                            .one_at_a_time()
                            .one_of(features);
    const Option coefficients =
        sub.add_option("--coefficients", command->coefficients,
                       "Numbers in the texture of a map: half, 16-bit floats; byte, 8 bits coded as sRGB, with scales")
            .type_name("NUMBERS")
            .default_text("half")
            .one_of({"half", "byte"});
    sub.add_option("-o,--output", command->output, "The file to write").type_name("FILE").required();
    sub.footer(
        "Examples:\n  srbf export paper_white_rgb.srbf --to glsl -o paper_white.glsl\n"
        "  srbf export map.srbf --to ktx2 -o map.ktx2");
    exports.allowed.push_back({{with}, "is for source code", [command] { return is_code(command->to); }});
    exports.allowed.push_back(
        {{coefficients}, "is for the textures of maps", [command] { return has_texture(command->to); }});
    sub.callback([command, kinds = exports.kinds,
                  &status] { status = std::ranges::find(kinds, command->to, &ExportKind::name)->run(*command); },
                 exports.allowed);
}

}  // namespace srbf
