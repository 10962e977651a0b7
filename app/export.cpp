#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>

#include "app/commands.h"
#include "app/output.h"
#include "extras/render/app/page_of.h"
#include "extras/render/app/path.h"
#include "app/surface_files.h"
#include "extras/environment/filtered_environment.h"
#include "app/map_layers.h"
#include "extras/render/page.h"
#include "srbf/file.h"
#include "srbf/printable.h"
#include "srbf/shading_code.h"

namespace srbf {
namespace {

/// The kind of a filtered environment.
constexpr const char* k_filtered = "dds";
constexpr const char* k_three = "three";
/// The kinds of a map's textures.
constexpr const char *k_ktx2 = "ktx2", *k_exr = "exr";

std::vector<std::string> names_of_languages() {
    std::vector<std::string> names;
    for (const CodeLanguageRow& row : k_code_languages) names.emplace_back(row.name);
    return names;
}
std::vector<std::string> names_of_kinds() {
    std::vector<std::string> kinds = names_of_languages();
    kinds.insert(kinds.begin(), "html");
    kinds.insert(kinds.end(), {k_three, "radiance", k_filtered, k_ktx2, k_exr});
    kinds.insert(kinds.end(), k_surface_files.begin(), k_surface_files.end());
    return kinds;
}

struct ExportCommand {
    std::vector<std::string> files, with;
    std::string to, reference, mesh, up = "y", output;

    int run() const;
    int filter_environment() const;
    bool is_code() const {
        return std::ranges::find(k_code_languages, std::string_view(to), &CodeLanguageRow::name) !=
               std::end(k_code_languages);
    }
    bool is_layers() const { return to == k_ktx2 || to == k_exr; }
    CodeOptions code_options() const;
    int write_map(const Library& map) const;
    Result<std::string> page(const std::vector<Subject>& models, const std::optional<Subject>& measured) const;
    std::vector<NamedModel> named(const std::vector<Subject>& models) const;
    static std::vector<NamedModel> with_parts(const std::vector<NamedModel>& named);
    Result<std::string> surface(const std::vector<NamedModel>& named) const;
    Result<std::string> code(const std::vector<NamedModel>& named) const;
    std::string beside(const std::string& name) const;
    /// Where the numbers of a view-by-view model go.
    std::string data_path(const NamedModel& of) const { return beside(of.name + ".data"); }
};

/// A mesh whose z axis is up, with its y axis up.
Mesh turned_upright(Mesh mesh) {
    for (auto* vectors : {&mesh.positions, &mesh.normals})
        for (Vec3f& v : *vectors) v = {v.x, v.z, -v.y};
    return mesh;
}

int ExportCommand::run() const {
    if (to == k_filtered) return filter_environment();
    if (files.size() == 1 && (is_code() || is_layers() || to == k_three)) {
        const auto map = library_in(files[0]);
        if (!map) return complain(map.error());
        if (*map) return write_map(**map);
    }
    std::vector<std::string> inputs = files;
    std::vector<Subject> models;
    for (const std::string& file : files) {
        auto subject = load_subject(file);
        if (!subject) return complain(subject.error());
        if (!subject->is_model()) return complain({file, {}, "input", "a model", "a measurement (see --reference)"});
        models.push_back(*std::move(subject));
    }
    if (is_layers()) return complain({files[0], {}, "input", "a map of shared lobes", "a model", ErrorCode::argument});
    if (!mesh.empty()) inputs.push_back(mesh);
    std::optional<Subject> measured;
    if (!reference.empty()) {
        inputs.push_back(reference);
        auto subject = load_subject(reference);
        if (!subject) return complain(subject.error());
        if (subject->is_model()) return complain({reference, {}, "reference", "a measurement", "a model"});
        if (is_two_sided(subject->content))
            return complain({reference, {}, "reference", "a measurement of a BRDF", "one with transmission"});
        measured = *std::move(subject);
    }
    const bool is_page = to == "html";
    const std::vector<NamedModel> all = named(models), brdfs = with_parts(all);
    std::vector<std::string> outputs{output};
    for (const NamedModel& of : brdfs)
        if (!is_page && to != "radiance" && std::holds_alternative<SuModel>(of.model->model))
            outputs.push_back(data_path(of));
    if (const auto writable = check_outputs(inputs, outputs); !writable) return complain(writable.error());

    // three.js has no light behind a surface: each part is a material.
    const auto text = is_page ? page(models, measured) : code(to == k_three ? brdfs : all);
    if (!text) return complain(text.error());
    std::vector<NewFile> written_files;
    const auto add = [&](const std::string& path, std::span<const std::byte> bytes) {
        written_files.push_back({path, {bytes.begin(), bytes.end()}});
    };
    for (const NamedModel& of : brdfs)
        if (const auto* su = std::get_if<SuModel>(&of.model->model); su && !is_page)
            add(data_path(of), std::as_bytes(std::span<const float>(shading_data(*su))));
    add(output, as_bytes(*text));
    const auto written = write_files(written_files);
    return written ? int(k_done) : complain(written.error());
}

/// Its lobes as code, or its coefficients as textures, or for three.js both.
int ExportCommand::write_map(const Library& map) const {
    if (const auto valid = check_layers(map, files[0]); !valid) return complain(valid.error());
    const std::string name = identifier(stem_of(files[0])), texture = is_layers() ? output : beside(name + ".ktx2");
    std::vector<std::string> outputs{output};
    if (to == k_three) outputs.push_back(texture);
    if (const auto writable = check_outputs(files, outputs); !writable) return complain(writable.error());
    const auto write = [&]() -> Result<Done> {
        if (to == k_exr) return write_map_exr(map, texture);
        std::vector<NewFile> all;
        if (!is_code()) all.push_back({texture, map_ktx2(map)});
        if (!is_layers()) {
            const auto text =
                to == k_three ? three_map_module(map, name, name + ".ktx2") : map_code(map, name, code_options());
            if (!text) return text.error();
            const auto bytes = as_bytes(*text);
            all.push_back({output, {bytes.begin(), bytes.end()}});
        }
        return write_files(all);
    };
    const auto written = within_memory(texture, write);
    return written ? int(k_done) : complain(written.error());
}

int ExportCommand::filter_environment() const {
    if (files.size() != 1)
        return complain({output, {}, "inputs", "one environment", std::to_string(files.size()), ErrorCode::argument});
    if (const auto writable = check_outputs(files, {output}); !writable) return complain(writable.error());
    const auto environment = load_light(files[0]);
    if (!environment) return complain(environment.error());
    if (!*environment) return complain({files[0], {}, "input", "an environment", "none", ErrorCode::argument});
    ProgressLine line;
    const FilteredEnvironment filtered(**environment, FilteredEnvironment::k_usual_size, 0,
                                       [&](double part) { line.show("filtering", part); });
    line.clear();
    const CubeFile file = to_dds(filtered);
    if (file.clamped > 0)
        fmt::print(stderr, "srbf: {}: {} texels are brighter than 65504, the largest 16-bit float, and are set to it\n",
                   printable(output), grouped(file.clamped));
    const auto written = write_file(output, file.bytes);
    return written ? int(k_done) : complain(written.error());
}

Result<std::string> ExportCommand::page(const std::vector<Subject>& models,
                                        const std::optional<Subject>& measured) const {
    Page page = page_of(models, measured ? &*measured : nullptr);
    if (!mesh.empty()) {
        auto loaded = load_mesh(mesh);
        if (!loaded) return loaded.error();
        page.mesh = up == "y" ? *std::move(loaded) : turned_upright(*std::move(loaded));
        page.mesh_name = stem_of(mesh);
    }
    return page_html(page);
}

/// The names of a model and of its parts, without what names of classes leave out.
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

/// Models by the names of their files, numbered where those of two differ by capitals and underscores alone. What is
/// numbered is called as no file is.
std::vector<NamedModel> ExportCommand::named(const std::vector<Subject>& models) const {
    std::vector<NamedModel> named;
    std::set<std::string> taken, of_files;
    const auto are_in = [](const std::set<std::string>& names, const std::vector<std::string>& keys) {
        return std::ranges::any_of(keys, [&](const std::string& key) { return names.contains(key); });
    };
    for (const Subject& of : models)
        for (const auto& key : keys_of(identifier(stem_of(of.path)), std::get<Model>(of.content))) of_files.insert(key);
    for (const Subject& of : models) {
        const Model& model = std::get<Model>(of.content);
        const std::string name = identifier(stem_of(of.path));
        std::string own = name;
        for (int i = 2; are_in(taken, keys_of(own, model)) || (own != name && are_in(of_files, keys_of(own, model)));
             ++i)
            own = fmt::format("{}_{}", name, i);
        for (const std::string& key : keys_of(own, model)) taken.insert(key);
        named.push_back({own, &model});
    }
    return named;
}

/// The same with a BSDF's parts in its place, as in its code.
std::vector<NamedModel> ExportCommand::with_parts(const std::vector<NamedModel>& named) {
    std::vector<NamedModel> all;
    for (const NamedModel& of : named) {
        const auto* bsdf = std::get_if<BsdfModel>(&of.model->model);
        if (!bsdf) all.push_back(of);
        for (std::size_t p = 0; bsdf && p < k_parts; ++p)
            if (bsdf->part[p]) all.push_back({fmt::format("{}_{}", of.name, k_part_names[p]), bsdf->part[p].get()});
    }
    return all;
}

/// Of that name, beside the code.
std::string ExportCommand::beside(const std::string& name) const {
    return (std::filesystem::path(output).parent_path() / name).string();
}

Result<std::string> ExportCommand::code(const std::vector<NamedModel>& named) const {
    const std::string prefix = named.size() == 1 ? named[0].name : identifier(stem_of(output));
    if (is_surface_file(to)) return surface(named);
    if (to == k_three) return three_module(named, prefix);
    if (to == "radiance") return radiance_text(named);
    return shading_code(named, prefix, code_options());
}

CodeOptions ExportCommand::code_options() const {
    CodeOptions options{
        .language = std::ranges::find(k_code_languages, std::string_view(to), &CodeLanguageRow::name)->language};
    const std::map<std::string, bool*> extras{{"sampling", &options.sampling},
                                              {"albedo", &options.albedo},
                                              {"environment", &options.environment},
                                              {"environment-draws", &options.environment_draws},
                                              {"area", &options.area}};
    for (const std::string& extra : with) *extras.at(extra) = true;
    return options;
}

/// The file of one surface; prints what it loses.
Result<std::string> ExportCommand::surface(const std::vector<NamedModel>& named) const {
    if (named.size() != 1)
        return Error{output, {}, "models", "one surface", std::to_string(named.size()), ErrorCode::argument};
    auto text = surface_file(to, named[0]);
    const auto& provenance = named[0].model->provenance;
    const auto heldout = provenance.find("heldout_delta_e_itp");
    if (const auto at = provenance.find("delta_e_itp"); text && at != provenance.end())
        fmt::print(
            "{}: ΔE_ITP {} against the measurement{}\n", printable(output), printable(at->second),
            heldout != provenance.end() ? fmt::format(", {} in cross-validation", printable(heldout->second)) : "");
    return text;
}

/// What each kind is, for the help.
std::string about_kinds(const std::vector<std::string>& languages) {
    return fmt::format(
        "html: a single file for any browser, without network access\n"
        "{}: source code with functions NAME_brdf of each model, named by its file, and\n"
        "the numbers as constants, for a shader or a program (c: a header for C99, C++ and CUDA)\n"
        "three: a module for three.js with a class NAMEMaterial of each model; of a map, which goes into\n"
        "NAME.ktx2 beside it, one with coefficients from textures\n"
        "radiance: a .cal with functions NAME(ix,iy,iz,ox,oy,oz) of each model, as bsdf2ttree -f takes them\n"
        "mtlx, standard-surface, gltf, glb, usd, blender: a surface (fit --model openpbr) as a document of\n"
        "MaterialX with OpenPBR or Standard Surface, as glTF 2.0, as a stage of USD, as a script that makes\n"
        "Blender's material\n"
        "dds: an environment (.hdr, .exr or studio) filtered for NAME_environment, a cube map of 16-bit floats\n"
        "ktx2, exr: the coefficients of a map (srbf map --basis N --width W), as layers of a KTX 2 texture with its\n"
        "levels, or as channels of OpenEXR; its code has NAME_brdf(wl, wv, NAME_coefficients(u, v))\n"
        "The numbers of a view-by-view model go into NAME.data beside the code. Of a BSDF the functions are\n"
        "NAME_bsdf, of directions on either side, and NAME_beam, the share of light that passes unscattered;\n"
        "for three.js each of its parts is a material",
        fmt::join(languages, ", "));
}

}  // namespace

void add_export(CommandLine& app, int& status) {
    const auto command = std::make_shared<ExportCommand>();
    const Subcommand sub =
        app.add_subcommand("export", "Export models as shading code, or as a page to look at and to share");
    sub.add_option("MODEL", command->files,
                   "Fitted models, side by side, or a map of shared lobes; for dds an environment")
        .type_name("")
        .required();
    const std::vector<std::string> languages = names_of_languages();
    sub.add_option("--to", command->to, about_kinds(languages)).type_name("KIND").required().one_of(names_of_kinds());
    const Option with =
        sub.add_option(
               "--with", command->with,
               "sampling: code with NAME_sample and NAME_pdf too; albedo: with NAME_albedo, the share of light that\n"
               "is reflected to a view; environment: with NAME_environment, the radiance under an environment that "
               "the\n"
               "host has filtered as for GGX; environment-draws: with NAME_environment_sampled, the same by draws, of "
               "one that\n"
               "is not filtered; area: with NAME_area, the radiance under a quadrilateral; may be "
               "repeated")
            .type_name("WHAT")
            .one_at_a_time()
            .one_of({"sampling", "albedo", "environment", "environment-draws", "area"});
    const Option reference =
        sub.add_option("--reference", command->reference, "html: the measurement, shown and plotted beside the models")
            .type_name("MEASURED");
    const Option mesh =
        sub.add_option("--mesh", command->mesh, "html: a .ply or .obj file, the object that is shown at first")
            .type_name("FILE");
    const Option up = add_up_option(sub, command->up, "html: axis of that mesh that points upwards, y or z");
    sub.add_option("-o,--output", command->output, "The file to write").type_name("FILE").required();
    sub.footer(
        "Examples:\n  srbf export paper_white_rgb.srbf --to glsl -o paper_white.glsl\n"
        "  srbf export studio.hdr --to dds -o studio.dds\n"
        "  srbf export map.srbf --to ktx2 -o map.ktx2\n"
        "  srbf export paper_white_rgb.srbf --to html --reference paper_white_rgb.bsdf -o paper.html");
    const auto is_page = [command] { return command->to == "html"; };
    const auto is_code = [command] { return command->is_code(); };
    sub.callback([command, &status] { status = command->run(); },
                 {{{with}, "is for source code", is_code},
                  {{reference, mesh, up}, "is for --to html", is_page},
                  {{up}, "only with --mesh", [command] { return !command->mesh.empty(); }}});
}

}  // namespace srbf
