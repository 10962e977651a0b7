// Models as materials of three.js.
#include <fmt/format.h>

#include <cctype>

#include "shader/shader_text.h"
#include "srbf/shading_code.h"

namespace srbf {
namespace {

/// `text` within a template literal of JavaScript.
std::string escaped(const std::string& text) {
    std::string literal;
    for (const char c : text) {
        if (c == '`' || c == '$' || c == '\\') literal += '\\';
        literal += c;
    }
    return literal;
}

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

}  // namespace

Result<std::string> three_module(std::span<const NamedModel> models, std::string_view prefix, int threads) {
    for (const NamedModel& of : models) {
        if (std::holds_alternative<SuModel>(of.model->model))
            return Error{of.name, {}, "model", "multivariate, or Lambert and GGX", "view by view", ErrorCode::argument};
        if (std::holds_alternative<BsdfModel>(of.model->model))
            return Error{of.name, {}, "model", "a BRDF, such as a part of a BSDF", "a BSDF", ErrorCode::argument};
    }
    const auto code = shading_code(
        models, prefix,
        {.language = CodeLanguage::glsl, .albedo = true, .environment = true, .area = true, .threads = threads});
    if (!code) return code.error();
    std::string functions;  // whose environment is three's
    for (const NamedModel& of : models) functions += fmt::format("#define {}_radiance measured_radiance\n", of.name);
    std::string text = k_three_text;
    const auto replace = [&text](std::string_view place, const std::string& by) {
        text.replace(text.find(place), place.size(), by);
    };
    replace("FUNCTIONS", escaped(functions + *code));
    for (const NamedModel& of : models)
        text += fmt::format(
            "export class {}Material extends MeasuredMaterial {{\n    constructor(parameters) {{\n"
            "        super('{}', parameters);\n    }}\n}}\n",
            capitalised(of.name), of.name);
    return text;
}

}  // namespace srbf
