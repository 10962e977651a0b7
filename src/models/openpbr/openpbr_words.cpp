// Describes a surface to programs and people.
#include <fmt/format.h>

#include "base/parameters.h"
#include "base/rows.h"
#include "models/openpbr/openpbr_kind.h"

namespace srbf {
namespace {

std::vector<float> numbers_of(const OpenPbrModel& model, const OpenPbrParameter& of) {
    std::vector<float> numbers;
    for (int c = 0; c < of.count(); ++c) numbers.push_back(number(model, of, c));
    return numbers;
}

}  // namespace

std::string Kind<OpenPbrModel>::summary(const OpenPbrModel&) { return "openpbr, a surface by parameters of OpenPBR"; }

void Kind<OpenPbrModel>::add_rows(std::string& text, const OpenPbrModel& model) {
    add_row(text, "model", "openpbr: a surface by parameters of OpenPBR 1.1");
    add_row(text, "size", fmt::format("{} numbers, {} bytes", openpbr_number_count(model), payload_bytes(model)));
    for (const OpenPbrParameter& of : k_openpbr_parameters) {
        std::string numbers;
        for (int c = 0; c < of.count(); ++c) numbers += fmt::format("{}{:.4g}", c ? "  " : "", number(model, of, c));
        text += fmt::format("  {:<30}{}\n", of.name, numbers);
    }
    if (model.is_exchanged) add_row(text, "exchanged", "light and viewer");
}

Parameters Kind<OpenPbrModel>::members(const OpenPbrModel& model) {
    Parameters numbers;
    for (const OpenPbrParameter& of : k_openpbr_parameters) {
        const std::vector<std::size_t> shape(of.colour ? 1 : 0, 3);
        numbers.push_back({std::string(of.name), NumberArray{shape, numbers_of(model, of)}});
    }
    return {{"form", std::string("openpbr")},
            {"lobes", 1},
            {"variates", 1},
            {"axial", model.specular_roughness_anisotropy == 0},
            {"parameters", numbers}};
}

Parameters Kind<OpenPbrModel>::parameters(const OpenPbrModel& model) {
    Parameters all;
    for (const OpenPbrParameter& of : k_openpbr_parameters)
        all.push_back({std::string(of.name), array_of({std::size_t(of.count())}, numbers_of(model, of))});
    all.push_back({"is_exchanged", model.is_exchanged});
    return all;
}

bool Kind<OpenPbrModel>::is_of(const ParameterReader& of) { return of.has("base_color"); }

OpenPbrModel Kind<OpenPbrModel>::made_of(ParameterReader& of) {
    OpenPbrModel model;
    for (const OpenPbrParameter& parameter : k_openpbr_parameters) {
        const auto numbers = of.numbers(parameter.name, std::to_string(parameter.count()));
        for (std::size_t c = 0; c < numbers.size(); ++c) number(model, parameter, int(c)) = numbers[c];
    }
    model.is_exchanged = of.flag("is_exchanged", false);
    return model;
}

}  // namespace srbf
