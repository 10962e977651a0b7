// Adds scripts for Blender and shaders in OSL to `srbf export`.
#include "app/export.h"

#include <memory>

#include "app/commands.h"
#include "app/output.h"
#include "base/errors.h"
#include "base/printable.h"
#include "errors/picture_errors.h"
#include "extras/blender/closures.h"
#include "extras/blender/script.h"
#include "generated/app/extra_exports.h"
#include "generated/blender/script_text.h"
#include "measured/tables.h"
#include "srbf/file.h"
#include "srbf/metrics.h"
#include "srbf/shading_code.h"

namespace SRBF_NAMESPACE {
namespace {

/// Loads the subject of a material, which must have a reflection that closures can be fitted to.
Result<LoadedFile> load_reflection(const std::string& file, const std::string& to) {
    auto subject = load_file(file);
    if (!subject) return subject;
    if (const auto valid = check_reflection(*subject, to); !valid) return valid.error();
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

/// Fits the subject and prints the visible error.
Result<ClosureSum> fit_and_report(const LoadedFile& subject, const std::string& name,
                                  const ClosureFitOptions& options) {
    const Evaluate f = evaluator(subject);
    const bool isotropic = is_isotropic(f, default_max_theta(k_default_objective));
    ProgressLine line;
    auto sum = fit_closures(f, options, ProgressToken(line.shown_progress()));
    line.clear();
    if (!sum) return sum;
    if (!isotropic)
        fmt::print(stderr, "srbf: {}: the material is isotropic, {} is not\n", name, printable(subject.path));
    const Evaluate fitted = evaluator(*sum);
    const Appearance errors = compare_pictures(f, {&fitted, 1}, {.is_isotropic = isotropic})[0];
    fmt::print("{}: ΔE_ITP {:.3g} against {} (worst {:.3g})\n", name, errors.mean.delta_e, printable(subject.path),
               errors.worst_delta_e);
    return sum;
}

Result<std::vector<NamedClosures>> fitted_closures(const ExportCommand& command, const ClosureFitOptions& options) {
    std::vector<LoadedFile> subjects;
    for (const std::string& file : command.files) {
        auto subject = load_reflection(file, command.to);
        if (!subject) return subject.error();
        subjects.push_back(*std::move(subject));
    }
    if (const auto writable = check_outputs(command.files, {command.output}); !writable) return writable.error();
    const std::vector<std::string> names = material_names(command.files);
    std::vector<NamedClosures> all;
    for (std::size_t i = 0; i < subjects.size(); ++i) {
        auto sum = fit_and_report(subjects[i], names[i], options);
        if (!sum) return sum.error();
        all.push_back({names[i], *std::move(sum)});
    }
    return all;
}

int write_text(const ExportCommand& command, const std::string& text) {
    return status_of(write_file(command.output, as_bytes(text)));
}

int write_script(const ExportCommand& command, int terms) {
    const auto materials = fitted_closures(command, {.terms = terms});
    if (!materials) return complain(materials.error());
    return write_text(command, blender_script(*materials));
}

int write_shader(const ExportCommand& command, int terms) {
    if (command.files.size() > 1)
        return complain(argument_error(command.output, "models", "one, as a file of OSL has one shader",
                                       std::to_string(command.files.size())));
    const auto materials = fitted_closures(command, {.terms = terms, .ramp = k_ramp_of_osl});
    if (!materials) return complain(materials.error());
    const auto& [name, sum] = materials->front();
    const std::string table = table_text(sum);
    return write_text(
        command,
        "// Written by srbf " SRBF_VERSION
        ": a material for Cycles, Blender 4.5 or later, in Open Shading Language.\n"
        "// The material's Bump Map Correction must be disabled, as it bends tilted normals back.\n"
        "// Tables over angles of the viewer from 0 to 90 degrees: for each term a row of slope, roughness and\n"
        "// anisotropy, and one of weights in linear Rec.709; then the colours of a ramp over the cosine of the "
        "light.\n"
        "#include \"stdcycles.h\"\n\n" +
            std::string(k_closures_text) +
            fmt::format(
                "\nshader {}_material(\n    float tables[{}] = {{{}\n    }},\n"
                "    color Tint = 1,\n    float RoughnessScale = 1 [[string label = \"Roughness Scale\", float min = "
                "0]],\n    normal Normal = N,\n    output closure color BSDF = 0)\n{{\n"
                "    BSDF = sum_of_closures(tables, {}, {}, Normal, Tint, RoughnessScale);\n}}\n",
                name, 3 * sum.knots() * (2 * sum.terms + sum.ramp), table, sum.knots(), sum.terms));
}

}  // namespace

void add_blender_exports(const Subcommand& sub, const ExportCommand& command, Exports& exports) {
    const auto terms = std::make_shared<int>(ClosureFitOptions{}.terms);
    const Option option = sub.add_option("--terms", *terms, "blender, osl: glossy closures in the sum")
                              .type_name("K")
                              .check(within(1, k_max_closures))
                              .capture_default_str();
    exports.kinds.push_back({"blender", [terms](const ExportCommand& given) { return write_script(given, *terms); }});
    exports.kinds.push_back({"osl", [terms](const ExportCommand& given) { return write_shader(given, *terms); }});
    exports.about +=
        "\nblender: a script that makes materials of Blender's nodes for Cycles, from models or measurements, which\n"
        "MODEL may be here\n"
        "osl: the same as a shader for Cycles in Open Shading Language, nearer to the measurement";
    exports.allowed.push_back({{option}, "is for --to blender and osl", [&command] {
                                   return command.to == "blender" || command.to == "osl";
                               }});
}

}  // namespace
