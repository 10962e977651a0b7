#include "code/blend_code.h"

#include <fmt/format.h>

#include "code/bsdf_code.h"
#include "code/syntax.h"

namespace SRBF_NAMESPACE {
namespace {

constexpr const char* k_weights[k_max_blended] = {"weights.x", "weights.y", "weights.z"};

/// Σ weight · NAME_`call` as statements; materials of weight 0 are not evaluated.
std::string sum_text(std::span<const NamedModel> models, const char* type, const char* zero, const char* call) {
    std::string text = fmt::format("    {} sum = {};\n", type, zero);
    for (std::size_t k = 0; k < models.size(); ++k)
        text +=
            fmt::format("    if ({0} > Real(0.0)) sum = sum + {0} * {1}_{2};\n", k_weights[k], models[k].name, call);
    return text;
}

/// Material k is drawn with probability weights[k] / Σ weights, and the rest of `selector` chooses its lobe.
std::string sample_text(std::span<const NamedModel> models, const std::string& total) {
    std::string text = fmt::format("    Real rest = selector * ({});\n", total);
    for (std::size_t k = 0; k < models.size(); ++k)
        text += fmt::format(
            "    if (rest < {0}) return {1}_sample(wv, u1, u2, min(rest / {0}, Real(0.99999994)));\n"
            "    rest = max(rest - {0}, Real(0.0));\n",
            k_weights[k], models[k].name);
    return text + "    return Vec3(Real(0.0), Real(0.0), Real(0.0));\n";
}

std::string print_blend(std::span<const NamedModel> models, const CodeOptions& options) {
    constexpr const char* black = "Vec3(Real(0.0), Real(0.0), Real(0.0))";
    std::string fractions, total;
    for (std::size_t k = 0; k < models.size(); ++k) {
        fractions += fmt::format("{}{} ({})", k ? ", " : "", models[k].name, k_weights[k]);
        total += fmt::format("{}{}", k ? " + " : "", k_weights[k]);
    }
    std::string text =
        fmt::format("// Materials mixed by a mask, which the host looks up: the shares of {}.\n", fractions) +
        "Vec3 brdf(Vec3 wl, Vec3 wv, Vec3 weights) {\n" + sum_text(models, "Vec3", black, "brdf(wl, wv)") +
        "    return sum;\n}\n";
    if (options.albedo)
        text += "Vec3 directional_albedo(Real cosine, Vec3 weights) {\n" +
                sum_text(models, "Vec3", black, "albedo(cosine)") + "    return sum;\n}\n";
    if (options.sampling)
        text += "Vec3 sample_light(Vec3 wv, Real u1, Real u2, Real selector, Vec3 weights) {\n" +
                sample_text(models, total) +
                "}\n"
                "Real light_pdf(Vec3 wl, Vec3 wv, Vec3 weights) {\n" +
                sum_text(models, "Real", "Real(0.0)", "pdf(wl, wv)") +
                fmt::format("    return sum / max({}, Real(1.0e-30));\n}}\n", total);
    return text;
}

}  // namespace

Result<std::string> blend_code(std::span<const NamedModel> models, std::string_view prefix, const CodeOptions& options,
                               DefinedNames& defined) {
    const auto refuse = [](const char* what, const char* expected, std::string found) {
        return Error{"blend code", {}, what, expected, std::move(found), ErrorCode::argument};
    };
    if (models.size() < 2 || models.size() > k_max_blended)
        return refuse("models", "two or three", std::to_string(models.size()));
    std::string stubs;
    for (const NamedModel& named : models) {
        if (std::holds_alternative<BsdfModel>(named.model->model)) return refuse("models", "BRDFs", "a BSDF");
        stubs += brdf_stubs(named.name);
    }
    return print_functions({.name = std::string(prefix), .stubs = stubs}, {}, print_blend(models, options),
                           options.language, defined);
}

std::vector<std::string> blend_functions(std::string_view prefix, const CodeOptions& options) {
    std::vector<std::string> names{"brdf"};
    if (options.albedo) names.push_back("albedo");
    if (options.sampling) names.insert(names.end(), {"sample", "pdf"});
    for (std::string& name : names) name = fmt::format("{}_{}", prefix, name);
    return names;
}

}  // namespace
