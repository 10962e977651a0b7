// Adds scripts for Blender to `srbf export`.
#include "app/export.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "app/commands.h"
#include "app/extra_exports.h"
#include "app/output.h"
#include "base/printable.h"
#include "blender/script_text.h"
#include "errors/picture_errors.h"
#include "extras/blender/closures.h"
#include "measured/isotropy.h"
#include "srbf/file.h"
#include "srbf/objective.h"
#include "srbf/shading_code.h"

namespace srbf {
namespace {

/// The subject of a material; an error if its reflection is not a BRDF as a function of any two directions.
Result<Subject> load_reflection(const std::string& file) {
    auto subject = load_subject(file);
    if (!subject) return subject;
    const auto refused = [&](const char* expected, const char* found) {
        return Error{file, {}, "input for blender", expected, found, ErrorCode::argument};
    };
    if (is_two_sided(subject->content)) return refused("a BRDF", "reflection and transmission");
    if (const auto* model = std::get_if<Model>(&subject->content)) {
        if (std::holds_alternative<OpenPbrModel>(model->model))
            return refused("a measurement or another model", "a surface, which --to principled writes");
    } else if (std::holds_alternative<ScatteredSamples>(std::get<Measured>(subject->content).table)) {
        return refused("a table or a model", "scattered samples, which srbf fit fits first");
    }
    return subject;
}

/// Unique names of materials by their files.
std::vector<std::string> material_names(const std::vector<std::string>& files) {
    std::vector<std::string> names;
    for (const std::string& file : files) {
        const std::string stem = identifier(stem_of(file));
        std::string name = stem;
        for (int i = 2; std::ranges::count(names, name) > 0; ++i) name = fmt::format("{}_{}", stem, i);
        names.push_back(name);
    }
    return names;
}

/// A row of the script's list: name, columns and terms of the tables, and their texels. A term has a row of texels
/// with its shape and one with its weights; the last row is the diffuse colour.
std::string table_text(const std::string& name, const ClosureSum& sum) {
    std::string text = fmt::format("    (\"{}\", {}, {}, [", name, sum.knots(), sum.terms);
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
    add_row([&](std::size_t i) { return sum.diffuse[i]; });
    return text + "\n    ]),\n";
}

Result<std::string> material_text(const Subject& subject, const std::string& name, int terms) {
    const Evaluate f = evaluator(subject);
    const bool isotropic = is_isotropic(f, default_max_theta(k_default_objective));
    ProgressLine line;
    const auto sum = fit_closures(f, {.terms = terms}, ProgressToken([&](const Progress& progress) {
                                      line.show(progress.stage, progress.fraction);
                                      return true;
                                  }));
    line.clear();
    if (!sum) return sum.error();
    if (!isotropic)
        fmt::print(stderr, "srbf: {}: the material is isotropic, {} is not\n", name, printable(subject.path));
    const Evaluate fitted = evaluator(*sum);
    const Appearance errors = compare_pictures(f, {&fitted, 1}, 0, {}, k_sphere_pixels, isotropic)[0];
    fmt::print("{}: ΔE_ITP {:.3g} against {} (worst {:.3g})\n", name, errors.mean.delta_e, printable(subject.path),
               errors.worst_delta_e);
    return table_text(name, *sum);
}

int write_script(const ExportCommand& command, int terms) {
    std::vector<Subject> subjects;
    for (const std::string& file : command.files) {
        auto subject = load_reflection(file);
        if (!subject) return complain(subject.error());
        subjects.push_back(*std::move(subject));
    }
    if (const auto writable = check_outputs(command.files, {command.output}); !writable)
        return complain(writable.error());
    const std::vector<std::string> names = material_names(command.files);
    std::string text =
        "# Written by srbf " SRBF_VERSION
        ": materials for Cycles, Blender 4.5 or later. Run it in Blender: the selected objects get\n"
        "# the materials. With the name of a .blend file after \"--\" it writes that file. A script that imports it "
        "calls\n"
        "# measured_materials().\n"
        "# Name, angles of the viewer from 0 to 90 degrees, terms, and the tables over these angles: for each term a "
        "row of\n"
        "# slope, roughness and anisotropy, and one of weights in linear Rec.709; then the diffuse colour.\n"
        "_MEASURED = [\n";
    for (std::size_t i = 0; i < subjects.size(); ++i) {
        const auto material = material_text(subjects[i], names[i], terms);
        if (!material) return complain(material.error());
        text += *material;
    }
    const auto written = write_file(command.output, as_bytes(text + "]\n" + k_nodes_text));
    return written ? int(k_done) : complain(written.error());
}

}  // namespace

void add_blender_exports(const Subcommand& sub, const ExportCommand& command, Exports& exports) {
    const auto terms = std::make_shared<int>(ClosureFitOptions{}.terms);
    const Option option = sub.add_option("--terms", *terms, "blender: glossy closures in the sum")
                              .type_name("K")
                              .check(within(1, k_most_closures))
                              .capture_default_str();
    exports.kinds.push_back({"blender", [terms](const ExportCommand& asked) { return write_script(asked, *terms); }});
    exports.about +=
        "\nblender: a script that makes materials of Blender's nodes for Cycles, from models or measurements, which\n"
        "MODEL may be here";
    exports.readings.push_back({{option}, "is for --to blender", [&command] { return command.to == "blender"; }});
}

}  // namespace srbf
