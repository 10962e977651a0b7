#include "srbf/models/openpbr.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/half.h"
#include "models/openpbr/openpbr_functions.h"
#include "models/openpbr/openpbr_kind.h"
#include "models/openpbr/openpbr_parameters.h"

namespace SRBF_NAMESPACE {

std::optional<OpenPbrSurfaceKind> openpbr_surface_named(std::string_view name) {
    const auto found = std::ranges::find(k_openpbr_surfaces, name);
    if (found == k_openpbr_surfaces.end()) return std::nullopt;
    return OpenPbrSurfaceKind(found - k_openpbr_surfaces.begin());
}

Rgb value(const OpenPbrModel& model, Vec3f wl, Vec3f wv) {
    Rgb f;
    evaluate(model, {&wl, 1}, {&wv, 1}, {&f, 1});
    return f;
}

Evaluate evaluator(const OpenPbrModel& model) {
    return [&model](auto wl, auto wv, auto f) { evaluate(model, wl, wv, f); };
}

std::size_t payload_bytes(const OpenPbrModel& model) { return 2 * openpbr_number_count(model); }

OpenPbrModel rounded(const OpenPbrModel& model) { return as_stored(model); }

Safetensors Kind<OpenPbrModel>::content(const OpenPbrModel& model) {
    Safetensors content{{}, {{"exchanged_surface", model.is_exchanged ? "true" : "false"}}};
    for (const OpenPbrParameter& parameter : k_openpbr_parameters) {
        if (!is_stored(model, parameter)) continue;
        Tensor16& tensor =
            content.tensors[std::string(parameter.name)] = {Type16::half, {std::uint64_t(parameter.count())}, {}};
        for (int c = 0; c < parameter.count(); ++c)
            tensor.data.push_back(to_half(std::clamp(number(model, parameter, c), parameter.least, parameter.most)));
    }
    return content;
}

Result<OpenPbrModel> Kind<OpenPbrModel>::read(Safetensors& content, const std::string& file_name) {
    MetadataReader reader{content.metadata, file_name};
    const bool is_exchanged = reader.take("exchanged_surface", {"true", "false"}) == "true";
    if (reader.error) return *reader.error;
    const auto& tensors = content.tensors;
    OpenPbrModel example;  // has a film and anisotropy if the file has them
    example.thin_film_weight = tensors.contains("thin_film_weight") ? 1 : 0;
    example.specular_roughness_anisotropy = tensors.contains("specular_roughness_anisotropy") ? 1 : 0;
    std::map<std::string, TensorShape> expected;
    for (const OpenPbrParameter& parameter : k_openpbr_parameters)
        if (is_stored(example, parameter))
            expected[std::string(parameter.name)] = {Type16::half, {std::uint64_t(parameter.count())}};
    if (const auto valid = check_tensors(tensors, expected, file_name); !valid) return valid.error();
    OpenPbrModel model;
    model.is_exchanged = is_exchanged;
    for (const OpenPbrParameter& parameter : k_openpbr_parameters)
        for (int c = 0; is_stored(example, parameter) && c < parameter.count(); ++c) {
            const float x = from_half(tensors.at(std::string(parameter.name)).data[std::size_t(c)]);
            if (!(x >= parameter.least && x <= parameter.most))
                return Error{file_name, std::nullopt, fmt::format("tensor '{}'", parameter.name),
                             fmt::format("{} to {}", parameter.least, parameter.most), fmt::format("{}", x)};
            number(model, parameter, c) = x;
        }
    return model;
}

}  // namespace srbf
