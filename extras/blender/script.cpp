#include "extras/blender/script.h"

#include <fmt/format.h>

#include "generated/blender/script_text.h"
#include "srbf/model.h"

namespace SRBF_NAMESPACE {

Result<Done> check_reflection(const LoadedFile& subject, std::string_view to) {
    const auto refused = [&](const char* expected, const char* found) {
        return Error{subject.path, {}, "input for " + std::string(to), expected, found, ErrorCode::argument};
    };
    if (is_two_sided(subject.content)) return refused("a BRDF", "reflection and transmission");
    if (const auto* model = std::get_if<Model>(&subject.content)) {
        if (std::holds_alternative<OpenPbrModel>(model->model))
            return refused("a measurement or another model", "a surface, which --to principled writes");
    } else if (std::holds_alternative<ScatteredSamples>(std::get<Measured>(subject.content).table)) {
        return refused("a table or a model", "scattered samples, which srbf fit fits first");
    }
    return Done{};
}

std::string table_text(const ClosureSum& sum) {
    std::string text;
    const auto add_row = [&](const auto& texel_of) {
        text += "\n        ";
        for (std::size_t i = 0; i < sum.knots(); ++i) {
            const Rgb texel = texel_of(i);
            text += fmt::format("{:.5g}, {:.5g}, {:.5g}, ", texel.r, texel.g, texel.b);
        }
        text.pop_back();
    };
    for (std::size_t k = 0; k < sum.terms; ++k) {
        const auto closure = [&](std::size_t i) { return sum.closures[i * sum.terms + k]; };
        add_row([&](std::size_t i) { return Rgb{closure(i).slope, closure(i).roughness, closure(i).anisotropy}; });
        add_row([&](std::size_t i) { return closure(i).weight; });
    }
    for (std::size_t j = 0; j < sum.ramp; ++j) add_row([&](std::size_t i) { return sum.diffuse[i * sum.ramp + j]; });
    text.pop_back();
    return text;
}

std::string blender_script(std::span<const NamedClosures> materials) {
    std::string text =
        "# Written by srbf " SRBF_VERSION
        ": materials for Cycles, Blender 4.5 or later. Run it in Blender: the selected objects get\n"
        "# the materials. With the name of a .blend file after \"--\" it writes that file, where they are assets with\n"
        "# previews, and with that of a CSV file after it, of the names and descriptions there. A script that imports "
        "it calls measured_materials().\n"
        "# Name, angles of the viewer from 0 to 90 degrees, terms, and the tables over these angles: for each term a "
        "row of\n"
        "# slope, roughness and anisotropy, and one of weights in linear Rec.709; then the diffuse colour.\n"
        "_MEASURED = [\n";
    for (const auto& [name, sum] : materials)
        text += fmt::format("    (\"{}\", {}, {}, [{}\n    ]),\n", name, sum.knots(), sum.terms, table_text(sum));
    return text + "]\n" + k_nodes_text;
}

}  // namespace
