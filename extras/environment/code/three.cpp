// Models as materials of three.js.

#include "base/printable.h"
#include "code/defined_names.h"
#include "code/print.h"
#include "extras/environment/code/materials.h"
#include "generated/extras/environment/texts.h"
#include "models/bsdf/bsdf_functions.h"
#include "models/su/su_functions.h"
#include "srbf/environment_code.h"

namespace SRBF_NAMESPACE {
namespace {

/// With five a frame under an environment takes up to twice the time of MeshStandardMaterial's, with six longer.
constexpr int k_three_lobes = 5;

/// The module with these functions. `imports` are further names from three, `classes` the text that extends its
/// class.
std::string module_of(const std::string& functions, std::string_view imports, std::string_view classes) {
    std::string text = k_three_text;
    replace_all(text, "import {", fmt::format("import {{{}", imports));
    replace_all(text, "VIEWS", std::to_string(ExtendedLight::k_views));
    replace_all(text, "FUNCTIONS", in_template_literal(functions));
    text += classes;
    return text;
}
/// Macros that name the functions and data that the module supplies to a model.
std::string defines_of(const std::string& name) {
    return fmt::format("#define {0}_radiance measured_radiance\n#define {0}_reflected measured_reflected\n", name);
}
/// A class that extends `base`; `more` is appended to the arguments of the constructor of `base`.
std::string class_text(const std::string& name, std::string_view base, std::string_view more = "") {
    return fmt::format(
        "export class {}Material extends {} {{\n    constructor(parameters) {{\n"
        "        super('{}', parameters{});\n    }}\n}}\n",
        capitalised(name), base, name, more);
}
ExtendedLight light_of(const NamedModel& named, int threads) {
    return extended_light(prepare(*named.model), {.lobes = k_three_lobes,
                                                  .isotropic = is_isotropic(*named.model),
                                                  .levels = MapLevels::three,
                                                  .fixed = true,
                                                  .threads = threads});
}
/// The lobes of a model as a texture, for its class.
std::string lobes_text(const std::string& name, const ExtendedLight& light) {
    const LightTexels texels = light_texels(light);
    std::string numbers;
    for (std::size_t i = 0; i < texels.numbers.size(); i += 3)
        numbers += fmt::format("    {}, {}, {},\n", texels.numbers[i], texels.numbers[i + 1], texels.numbers[i + 2]);
    return fmt::format("\nconst {}_lobes = lobesTexture([\n{}]);\n", name, numbers);
}
/// A macro of the roughnesses of a model's lobes. They are constant expressions, because some samplers of textures take
/// several times as long if the level depends on the pixel.
std::string roughnesses_text(const std::string& name, const ExtendedLight& light) {
    std::string roughness = "1.0";
    for (int k = light.lobes; --k > 0;)
        roughness =
            fmt::format("(k) == {} ? {} : {}", k, syntax::digits(light.lobe[std::size_t(k)].roughness), roughness);
    return fmt::format("#define {}_lobe_roughness(k) ({})\n", name, roughness);
}

}  // namespace

Result<std::string> three_module(std::span<const NamedModel> models, std::string_view prefix, int threads) {
    if (const auto valid = check_materials(models); !valid) return valid.error();
    const auto code =
        environment_code(models, prefix, {.language = CodeLanguage::glsl, .albedo = true, .threads = threads},
                         {.environment = true,
                          .area = true,
                          .lobes = k_three_lobes,
                          .fixed = true,
                          .texels = true,
                          .colours = true,
                          .unrolled = true});
    if (!code) return code.error();
    std::string functions, texels;  // they use the environment of three.js
    std::string classes;
    DefinedNames defined;
    for (const char* type : {"MeasuredMaterial", "BlendMaterial"}) (void)defined.add(type, "the module");
    for (const NamedModel& named : models) {
        if (const auto distinct = defined.add(capitalised(named.name) + "Material", named.name); !distinct)
            return distinct.error();
        const ExtendedLight light = light_of(named, threads);
        functions += defines_of(named.name) + roughnesses_text(named.name, light);
        texels += fmt::format(
            "uniform highp sampler2D {0}_texels;\nvec3 {0}_light_texel(int i, int view) {{ return "
            "texelFetch({0}_texels, ivec2(i, view), 0).rgb; }}\n",
            named.name);
        classes += lobes_text(named.name, light);
        classes += class_text(named.name, "MeasuredMaterial", fmt::format(", {{ lobes: {}_lobes }}", named.name));
        classes += fmt::format("savedAs('{0}Material', {0}Material);\n", capitalised(named.name));
    }
    return module_of(functions + *code + texels, "", classes + k_three_blend_text);
}

Result<std::string> three_webgpu_module(std::span<const NamedModel> models, std::string_view prefix, int threads) {
    if (const auto valid = check_materials(models); !valid) return valid.error();
    const auto code =
        environment_code(models, prefix, {.language = CodeLanguage::wgsl, .albedo = true, .threads = threads},
                         {.area = true, .views = true, .lobes = k_three_lobes, .fixed = true, .unrolled = true});
    if (!code) return code.error();
    std::string text = k_three_webgpu_text;
    replace_all(text, "LOBES", std::to_string(k_three_lobes));
    replace_all(text, "FUNCTIONS", in_template_literal(*code));
    DefinedNames defined;
    for (const char* type : {"MeasuredMaterial", "MeshStandardNodeMaterial"}) (void)defined.add(type, "the module");
    for (const NamedModel& named : models) {
        if (const auto distinct = defined.add(capitalised(named.name) + "Material", named.name); !distinct)
            return distinct.error();
        text += fmt::format(
            "\nconst {0}_nodes = nodesOf('{0}');\nexport class {1}Material extends MeasuredMaterial {{\n"
            "    static get type() {{\n        return '{1}Material';\n    }}\n"
            "    constructor(parameters) {{\n        super({0}_nodes, parameters);\n    }}\n}}\n",
            named.name, capitalised(named.name));
    }
    return text;
}

Result<std::string> three_map_module(const TexelMap& map, const std::string& name, std::string_view file, int threads) {
    const auto code =
        environment_map_code(map, name, {.language = CodeLanguage::glsl, .albedo = true, .threads = threads},
                             {.environment = true,
                              .area = true,
                              .lobes = k_three_lobes,
                              .levels = MapLevels::three,
                              .fixed = true,
                              .colours = true,
                              .unrolled = true});
    if (!code) return code.error();
    std::string classes = k_three_map_text;
    replace_all(classes, "FILE", fmt::format("./{}", file));
    replace_all(classes, "LOBES", fmt::format("{}", map.basis.lobes));
    const std::string functions =
        defines_of(name) +
        fmt::format(
            "uniform highp sampler2DArray measured_coefficients;\nuniform vec3 measured_scales[{1}];\n"
            "varying vec2 measured_uv;\nvec3 {0}_layer(int j, float u, float v) {{\n"
            "    return measured_scales[j] * texture(measured_coefficients, vec3(u, v, float(j))).rgb;\n}}\n",
            name, map.basis.lobes);
    return module_of(functions + *code + fmt::format("{}_Coefficients measured_texel;\n", name),
                     " CompressedArrayTexture, HalfFloatType, SRGBColorSpace, UnsignedByteType,",
                     classes + class_text(name, "MeasuredMap"));
}

}  // namespace
