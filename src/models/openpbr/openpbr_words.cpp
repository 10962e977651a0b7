// Describes a surface to programs and people.
#include <fmt/ranges.h>

#include "brdf/rows.h"
#include "models/kind/parameters.h"
#include "models/openpbr/openpbr_functions.h"
#include "models/openpbr/openpbr_kernel.h"
#include "models/openpbr/openpbr_kind.h"
#include "models/openpbr/openpbr_parameters.h"
#include "srbf/model.h"

namespace SRBF_NAMESPACE {
namespace {

std::vector<float> numbers_of(const OpenPbrModel& model, const OpenPbrParameter& parameter) {
    std::vector<float> numbers;
    for (int c = 0; c < parameter.count(); ++c) numbers.push_back(number(model, parameter, c));
    return numbers;
}

}  // namespace

std::string Kind<OpenPbrModel>::summary(const OpenPbrModel&) { return "openpbr, a surface by parameters of OpenPBR"; }

void Kind<OpenPbrModel>::add_rows(std::string& text, const OpenPbrModel& model) {
    add_row(text, "model", "openpbr: a surface by parameters of OpenPBR 1.1");
    add_row(text, "size", fmt::format("{} numbers, {} bytes", openpbr_number_count(model), payload_bytes(model)));
    for (const OpenPbrParameter& parameter : k_openpbr_parameters)
        text += fmt::format("  {:<30}{:.4g}\n", parameter.name, fmt::join(numbers_of(model, parameter), "  "));
    if (model.is_exchanged) add_row(text, "exchanged", "light and viewer");
}

Parameters Kind<OpenPbrModel>::members(const OpenPbrModel& model) {
    Parameters numbers;
    for (const OpenPbrParameter& parameter : k_openpbr_parameters) {
        const std::vector<std::size_t> shape(parameter.colour ? 1 : 0, 3);
        numbers.push_back({std::string(parameter.name), NumberArray{shape, numbers_of(model, parameter)}});
    }
    return {{"form", std::string("openpbr")},
            {"lobes", 1},
            {"variates", 1},
            {"axial", model.specular_roughness_anisotropy == 0},
            {"parameters", numbers}};
}

Parameters Kind<OpenPbrModel>::parameters(const OpenPbrModel& model) {
    Parameters all;
    for (const OpenPbrParameter& parameter : k_openpbr_parameters)
        all.push_back(
            {std::string(parameter.name), array_of({std::size_t(parameter.count())}, numbers_of(model, parameter))});
    all.push_back({"is_exchanged", model.is_exchanged});
    return all;
}

bool Kind<OpenPbrModel>::is_of(const ParameterReader& reader) { return reader.has("base_color"); }

OpenPbrModel Kind<OpenPbrModel>::made_of(ParameterReader& reader) {
    OpenPbrModel model;
    for (const OpenPbrParameter& parameter : k_openpbr_parameters) {
        const auto numbers = reader.numbers(parameter.name, std::to_string(parameter.count()));
        for (std::size_t c = 0; c < numbers.size(); ++c) number(model, parameter, int(c)) = numbers[c];
    }
    model.is_exchanged = reader.flag("is_exchanged", false);
    return model;
}

std::vector<Model> Kind<OpenPbrModel>::terms(const OpenPbrModel& model, std::size_t) {
    std::vector<Model> all{{model, {}}};
    for (float OpenPbrModel::*const weight : {&OpenPbrModel::fuzz_weight, &OpenPbrModel::coat_weight}) {
        OpenPbrModel less = std::get<OpenPbrModel>(all.back().model);
        if (less.*weight == 0) continue;
        less.*weight = 0;
        all.push_back({less, {}});
    }
    return all;
}

std::string Kind<OpenPbrModel>::formula_text(const OpenPbrModel& model, const NumberText& number) {
    const auto surface = kernel_surface(model);
    std::string text = "    OpenPbrSurface of;\n";
    const auto set = [&](const char* member, float x) {
        text += fmt::format("    of.{} = {};\n", member, number(x, member, 0));
    };
    const auto set_colour = [&](const char* member, const Vec3f& x, std::string_view parameter) {
        const std::string r = number(x.x, parameter, 0), g = number(x.y, parameter, 1), b = number(x.z, parameter, 2);
        text += fmt::format("    of.{} = Vec3({}, {}, {});\n", member, r, g, b);
    };
    set_colour("base_color", surface.base_color, "");  // product of base_color and base_weight
    set("base_metalness", surface.base_metalness);
    set("base_diffuse_roughness", surface.base_diffuse_roughness);
    set("specular_weight", surface.specular_weight);
    set_colour("specular_color", surface.specular_color, "specular_color");
    set("specular_roughness", surface.specular_roughness);
    set("specular_ior", surface.specular_ior);
    set("coat_weight", surface.coat_weight);
    set_colour("coat_color", surface.coat_color, "coat_color");
    set("coat_roughness", surface.coat_roughness);
    set("coat_ior", surface.coat_ior);
    set("coat_darkening", surface.coat_darkening);
    set("fuzz_weight", surface.fuzz_weight);
    set_colour("fuzz_color", surface.fuzz_color, "fuzz_color");
    set("fuzz_roughness", surface.fuzz_roughness);

    const std::string directions = model.is_exchanged ? "wv, wl" : "wl, wv";
    const bool is_anisotropic = model.specular_roughness_anisotropy > 0;
    if (model.thin_film_weight == 0 && !is_anisotropic)
        return text + fmt::format("    return openpbr_value(of, {});\n", directions);
    const auto film = kernel_film(model);
    text += "    OpenPbrFilm film;\n";
    text += fmt::format("    film.weight = {};\n", number(film.weight, "thin_film_weight", 0));
    text += fmt::format("    film.thickness = {};\n", number(film.thickness, "thin_film_thickness", 0));
    text += fmt::format("    film.ior = {};\n", number(film.ior, "thin_film_ior", 0));
    if (!is_anisotropic) return text + fmt::format("    return openpbr_film_value(of, film, {});\n", directions);
    const auto anisotropy = kernel_anisotropy(model);
    text += "    OpenPbrAnisotropy anisotropy;\n";
    text += fmt::format("    anisotropy.amount = {};\n", number(anisotropy.amount, "specular_roughness_anisotropy", 0));
    text += fmt::format("    anisotropy.cosine = {};\n", number(anisotropy.cosine, "", 0));
    text += fmt::format("    anisotropy.sine = {};\n", number(anisotropy.sine, "", 0));
    return text + fmt::format("    return openpbr_anisotropic_value(of, film, anisotropy, {});\n", directions);
}

}  // namespace srbf
