// Adds to `srbf export` the page, and the coefficients of maps as OpenEXR.
#include "app/export.h"

#include <fmt/format.h>

#include <memory>

#include "app/commands.h"
#include "app/extra_exports.h"
#include "app/map_layers.h"
#include "app/output.h"
#include "base/half.h"
#include "extras/render/app/mesh_options.h"
#include "extras/render/app/page_of.h"
#include "extras/render/exr.h"
#include "srbf/file.h"

namespace srbf {
namespace {

struct PageOptions {
    std::string reference, mesh, up = "y";
};

/// A mesh whose z axis is up, with its y axis up.
Mesh turned_upright(Mesh mesh) {
    for (auto* vectors : {&mesh.positions, &mesh.normals})
        for (Vec3f& v : *vectors) v = {v.x, v.z, -v.y};
    return mesh;
}

Result<Subject> load_reference(const std::string& file) {
    auto subject = load_subject(file);
    if (!subject) return subject;
    if (subject->is_model()) return Error{file, {}, "reference", "a measurement", "a model"};
    if (is_two_sided(subject->content))
        return Error{file, {}, "reference", "a measurement of a BRDF", "one with transmission"};
    return subject;
}

Result<Done> write_page(const ExportCommand& asked, const PageOptions& options) {
    std::vector<std::string> inputs = asked.files;
    const auto models = load_models(asked.files);
    if (!models) return models.error();
    if (!options.mesh.empty()) inputs.push_back(options.mesh);
    std::optional<Subject> measured;
    if (!options.reference.empty()) {
        inputs.push_back(options.reference);
        auto reference = load_reference(options.reference);
        if (!reference) return reference.error();
        measured = *std::move(reference);
    }
    if (const auto writable = check_outputs(inputs, {asked.output}); !writable) return writable.error();
    Page page = page_of(*models, measured ? &*measured : nullptr);
    if (!options.mesh.empty()) {
        auto loaded = load_mesh(options.mesh);
        if (!loaded) return loaded.error();
        page.mesh = options.up == "y" ? *std::move(loaded) : turned_upright(*std::move(loaded));
        page.mesh_name = stem_of(options.mesh);
    }
    return write_file(asked.output, as_bytes(page_html(page)));
}

/// Lobe 7 of 16 has the channels lobe07.R, lobe07.G, lobe07.B, as 16-bit floats.
Result<Done> write_map_exr(const ExportCommand& asked) {
    const auto map = load_map(asked);
    if (!map) return map.error();
    const auto J = std::size_t(map->basis.lobes);
    const std::size_t digits = fmt::formatted_size("{}", J - 1);
    std::vector<std::string> names;
    for (std::size_t j = 0; j < J; ++j)
        for (const char c : {'R', 'G', 'B'}) names.push_back(fmt::format("lobe{:0{}}.{}", j, digits, c));
    std::vector<std::uint16_t> halves;
    for (const Rgb& of : map->coefficient)
        for (int c = 0; c < 3; ++c) halves.push_back(to_half(of[c]));
    return write_half_exr(int(map->width), int(map->count() / map->width), names, halves, asked.output);
}

int status_of(const Result<Done>& written) { return written ? int(k_done) : complain(written.error()); }

}  // namespace

void add_render_exports(const Subcommand& sub, const ExportCommand& asked, Exports& to) {
    const auto options = std::make_shared<PageOptions>();
    const Option reference =
        sub.add_option("--reference", options->reference, "html: the measurement, shown and plotted beside the models")
            .type_name("MEASURED");
    const Option mesh =
        sub.add_option("--mesh", options->mesh, "html: a .ply or .obj file, the object that is shown at first")
            .type_name("FILE");
    const Option up = add_up_option(sub, options->up, "html: axis of that mesh that points upwards, y or z");
    to.kinds.push_back({"html", [options](const ExportCommand& of) { return status_of(write_page(of, *options)); }});
    to.kinds.push_back({"exr", [](const ExportCommand& of) {
                            return status_of(within_memory(of.output, [&] { return write_map_exr(of); }));
                        }});
    to.about +=
        "\nhtml: a single file for any browser, without network access\n"
        "exr: the coefficients of a map, as channels of OpenEXR";
    to.readings.push_back({{reference, mesh, up}, "is for --to html", [&asked] { return asked.to == "html"; }});
    to.readings.push_back({{up}, "only with --mesh", [options] { return !options->mesh.empty(); }});
}

}  // namespace srbf
