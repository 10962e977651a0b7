// Models as materials of three.js.
#include <fmt/format.h>

#include <cctype>

#include "base/printable.h"
#include "code/defined_names.h"
#include "extras/environment/texts.h"
#include "srbf/environment_code.h"

namespace srbf {
namespace {

/// A frame takes up to twice the time of MeshStandardMaterial's, with five 2.8 times and with six more than thrice.
constexpr int k_three_lobes = 4;

/// "CcIbizaSunset" for "cc_ibiza_sunset".
std::string capitalised(const std::string& name) {
    std::string words;
    bool begins = true;
    for (const char c : name) {
        if (c != '_') words += begins ? char(std::toupper(static_cast<unsigned char>(c))) : c;
        begins = c == '_';
    }
    return words;
}

void replace_all(std::string& text, std::string_view place, const std::string& by) {
    for (auto at = text.find(place); at != text.npos; at = text.find(place, at + by.size()))
        text.replace(at, place.size(), by);
}

/// The module of these functions; `classes`: what its text names of three and what extends its class.
std::string module_of(const std::string& functions, std::string_view imports, std::string_view classes) {
    std::string text = k_three_text;
    replace_all(text, "import {", fmt::format("import {{{}", imports));
    replace_all(text, "VIEWS", std::to_string(ExtendedLight::k_views));
    replace_all(text, "FUNCTIONS", in_template_literal(functions));
    text += classes;
    return text;
}
/// `more`: arguments of the constructor of `base`.
std::string class_text(const std::string& name, std::string_view base, std::string_view more = "") {
    return fmt::format(
        "export class {}Material extends {} {{\n    constructor(parameters) {{\n"
        "        super('{}', parameters{});\n    }}\n}}\n",
        capitalised(name), base, name, more);
}
/// The lobes of a model as a texture, for its class.
std::string lobes_text(const NamedModel& of, int threads) {
    const ExtendedLight light = extended_light(
        prepare(*of.model),
        {.lobes = k_three_lobes, .isotropic = is_isotropic(*of.model), .levels = MapLevels::three, .threads = threads});
    const LightTexels texels = light_texels(light);
    std::string numbers;
    for (std::size_t i = 0; i < texels.numbers.size(); i += 3)
        numbers += fmt::format("    {}, {}, {},\n", texels.numbers[i], texels.numbers[i + 1], texels.numbers[i + 2]);
    return fmt::format("\nconst {}_lobes = lobesTexture([\n{}]);\n", of.name, numbers);
}

}  // namespace

Result<std::string> three_module(std::span<const NamedModel> models, std::string_view prefix, int threads) {
    for (const NamedModel& of : models) {
        if (std::holds_alternative<SuModel>(of.model->model))
            return Error{of.name, {}, "model", "multivariate, or Lambert and GGX", "view by view", ErrorCode::argument};
        if (std::holds_alternative<BsdfModel>(of.model->model))
            return Error{of.name, {}, "model", "a BRDF, such as a part of a BSDF", "a BSDF", ErrorCode::argument};
    }
    const auto code =
        environment_code(models, prefix, {.language = CodeLanguage::glsl, .albedo = true, .threads = threads},
                         {.environment = true, .area = true, .lobes = k_three_lobes, .texels = true});
    if (!code) return code.error();
    std::string functions;  // whose environment is three's
    std::string classes;
    DefinedNames defined;
    for (const NamedModel& of : models) {
        if (const auto distinct = defined.add(capitalised(of.name) + "Material", of.name); !distinct)
            return distinct.error();
        functions += fmt::format(
            "#define {0}_radiance measured_radiance\n#define {0}_light_texel measured_light_texel\n", of.name);
        classes += lobes_text(of, threads);
        classes += class_text(of.name, "MeasuredMaterial", fmt::format(", {{ lobes: {}_lobes }}", of.name));
    }
    return module_of(functions + *code, "", classes);
}

Result<std::string> three_map_module(const Library& map, const std::string& name, std::string_view file, int threads) {
    const auto code =
        environment_map_code(map, name, {.language = CodeLanguage::glsl, .albedo = true, .threads = threads},
                             {.environment = true, .area = true, .levels = MapLevels::three});
    if (!code) return code.error();
    std::string classes = k_three_map_text;
    replace_all(classes, "FILE", fmt::format("./{}", file));
    replace_all(classes, "LOBES", fmt::format("{}", map.basis.lobes));
    const std::string functions = fmt::format(
        "#define {0}_radiance measured_radiance\n"
        "uniform highp sampler2DArray measured_coefficients;\nvarying vec2 measured_uv;\n"
        "vec3 {0}_layer(int j, float u, float v) {{\n"
        "    return texture(measured_coefficients, vec3(u, v, float(j))).rgb;\n}}\n",
        name);
    return module_of(functions + *code + fmt::format("{}_Coefficients measured_texel;\n", name),
                     " CompressedArrayTexture, HalfFloatType, Matrix3,", classes + class_text(name, "MeasuredMap"));
}

}  // namespace srbf
