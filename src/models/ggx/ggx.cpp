#include "srbf/models/ggx.h"

#include "base/errors.h"
#include "models/ggx/ggx_kind.h"
#include "srbf/model.h"

namespace SRBF_NAMESPACE {

Rgb value(const GgxModel& model, Vec3f wl, Vec3f wv) { return value<GgxModel>(model, wl, wv); }

Evaluate evaluator(const GgxModel& model) {
    return [&model](auto wl, auto wv, auto f) { evaluate(model, wl, wv, f); };
}

Result<GgxModel> Kind<GgxModel>::read(Safetensors& content, const std::string& file_name) {
    const auto tensor = content.tensors.find("roughness");
    const auto shape = tensor == content.tensors.end() ? std::vector<std::uint64_t>{1} : tensor->second.shape;
    if (shape.size() != 1 || shape[0] < 1 || shape[0] > k_max_ggx_lobes)
        return input_error(file_name, "tensor 'roughness': shape", fmt::format("[1] or [{}]", k_max_ggx_lobes),
                           shape_text(shape));
    return read_into({{}, std::vector<GgxModel::Lobe>(shape[0])}, content, file_name);
}

std::string Kind<GgxModel>::summary(const GgxModel& model) {
    return fmt::format("ggx, {} and Lambert", model.lobes.size() == 1 ? "one lobe" : "two lobes");
}

std::string Kind<GgxModel>::formula_text(const GgxModel& model, const NumberText& number) {
    const auto& [diffuse, roughness, f0, f90] = numbers;
    constexpr std::array<const char*, k_max_ggx_lobes> names{"first", "second"};
    std::string text, sum = "Real(2.0 / SRBF_TWO_PI) * " + number_text(model, diffuse, number);
    for (std::size_t i = 0; i < model.lobes.size(); ++i) {
        text += fmt::format("    GgxLobe {};\n", names[i]);
        for (const auto& parameter : {roughness, f0, f90})
            text +=
                fmt::format("    {}.{} = {};\n", names[i], parameter.name, number_text(model, parameter, number, i));
        sum += fmt::format(" + ggx_lobe_value({}, wl, wv)", names[i]);
    }
    return text + "    return " + sum + ";\n";
}

}  // namespace
