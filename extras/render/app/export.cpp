// Adds the page and maps of coefficients as OpenEXR to `srbf export`.
#include "app/export.h"

#include <memory>

#include "app/commands.h"
#include "app/map_layers.h"
#include "app/output.h"
#include "base/files.h"
#include "base/half.h"
#include "extras/render/app/mesh_options.h"
#include "extras/render/app/page_of.h"
#include "extras/render/exr.h"
#include "generated/app/extra_exports.h"
#include "srbf/file.h"

namespace SRBF_NAMESPACE {
namespace {

struct PageOptions {
    std::string reference, mesh, up = "y";
};

/// Rotates a mesh whose z axis is up so that its y axis is up.
Mesh rotate_upright(Mesh mesh) {
    for (auto* vectors : {&mesh.positions, &mesh.normals})
        for (Vec3f& v : *vectors) v = {v.x, v.z, -v.y};
    return mesh;
}

Result<LoadedFile> load_reference(const std::string& file) {
    auto subject = load_file(file);
    if (!subject) return subject;
    if (subject->is_model()) return Error{file, {}, "reference", "a measurement", "a model"};
    if (is_two_sided(subject->content))
        return Error{file, {}, "reference", "a measurement of a BRDF", "one with transmission"};
    return subject;
}

Result<Done> write_page(const ExportCommand& command, const PageOptions& options) {
    std::vector<std::string> inputs = command.files;
    const auto models = load_models(command.files);
    if (!models) return models.error();
    if (!options.mesh.empty()) inputs.push_back(options.mesh);
    std::optional<LoadedFile> measured;
    if (!options.reference.empty()) {
        inputs.push_back(options.reference);
        auto reference = load_reference(options.reference);
        if (!reference) return reference.error();
        measured = *std::move(reference);
    }
    if (const auto writable = check_outputs(inputs, {command.output}); !writable) return writable.error();
    Page page = page_of(*models, measured ? &*measured : nullptr);
    if (!options.mesh.empty()) {
        auto loaded = load_mesh(options.mesh);
        if (!loaded) return loaded.error();
        page.mesh = options.up == "y" ? *std::move(loaded) : rotate_upright(*std::move(loaded));
        page.mesh_name = stem_of(options.mesh);
    }
    return write_file(command.output, as_bytes(page_html(page)));
}

/// Writes a map of coefficients. Lobe 7 of 16 has the channels lobe07.R, lobe07.G, lobe07.B, as 16-bit floats.
Result<Done> write_map_exr(const ExportCommand& command) {
    const auto map = load_map(command);
    if (!map) return map.error();
    const auto J = std::size_t(map->basis.lobes);
    const std::size_t digits = fmt::formatted_size("{}", J - 1);
    std::vector<std::string> names;
    for (std::size_t j = 0; j < J; ++j)
        for (const char c : {'R', 'G', 'B'}) names.push_back(fmt::format("lobe{:0{}}.{}", j, digits, c));
    std::vector<std::uint16_t> halves;
    for (const Rgb& coefficient : map->coefficient)
        for (int c = 0; c < 3; ++c) halves.push_back(to_half(coefficient[c]));
    return write_half_exr(int(map->width), int(map->height()), names, halves, command.output);
}

}  // namespace

void add_render_exports(const Subcommand& sub, const ExportCommand& command, Exports& exports) {
    const auto options = std::make_shared<PageOptions>();
    const Option reference =
        sub.add_option("--reference", options->reference, "html: the measurement, shown and plotted beside the models")
            .type_name("MEASURED");
    const Option mesh =
        sub.add_option("--mesh", options->mesh, "html: a .ply or .obj file, the object that is shown at first")
            .type_name("FILE");
    const Option up = add_up_option(sub, options->up, "html: axis of that mesh that points upwards, y or z");
    exports.kinds.push_back({"html", [options](const ExportCommand& export_command) {
                                 return status_of(write_page(export_command, *options));
                             }});
    exports.kinds.push_back(
        {"exr", [](const ExportCommand& export_command) {
             return status_of(within_memory(export_command.output, [&] { return write_map_exr(export_command); }));
         }});
    exports.about +=
        "\nhtml: a single file for any browser, without network access\n"
        "exr: the coefficients of a map, as channels of OpenEXR";
    exports.allowed.push_back({{reference, mesh, up}, "is for --to html", [&command] { return command.to == "html"; }});
    exports.allowed.push_back({{up}, "only with --mesh", [options] { return !options->mesh.empty(); }});
}

}  // namespace
