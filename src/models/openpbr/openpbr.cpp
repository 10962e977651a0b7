#include "srbf/models/openpbr.h"

#include "models/openpbr/openpbr_kernel.h"
#include "models/openpbr/openpbr_kind.h"
#include "models/openpbr/openpbr_parameters.h"
#include "srbf/model.h"

namespace SRBF_NAMESPACE {

std::optional<OpenPbrSurfaceKind> openpbr_surface_named(std::string_view name) {
    const auto found = std::ranges::find(k_openpbr_surfaces, name);
    if (found == k_openpbr_surfaces.end()) return std::nullopt;
    return OpenPbrSurfaceKind(found - k_openpbr_surfaces.begin());
}

Rgb value(const OpenPbrModel& model, Vec3f wl, Vec3f wv) { return value<OpenPbrModel>(model, wl, wv); }

Evaluate evaluator(const OpenPbrModel& model) {
    return [&model](auto wl, auto wv, auto f) { evaluate(model, wl, wv, f); };
}

Safetensors Kind<OpenPbrModel>::content(const OpenPbrModel& model) {
    Safetensors content = KindOfNumbers::content(model);
    content.metadata["exchanged_surface"] = model.is_exchanged ? "true" : "false";
    return content;
}

Result<OpenPbrModel> Kind<OpenPbrModel>::read(Safetensors& content, const std::string& file_name) {
    MetadataReader reader{content.metadata, file_name};
    OpenPbrModel model;
    model.is_exchanged = reader.take("exchanged_surface", {"true", "false"}) == "true";
    if (reader.error) return *reader.error;
    // It has a film and anisotropy if the file has them.
    model.thin_film_weight = content.tensors.contains("thin_film_weight") ? 1 : 0;
    model.specular_roughness_anisotropy = content.tensors.contains("specular_roughness_anisotropy") ? 1 : 0;
    return read_into(model, content, file_name);
}

void Kind<OpenPbrModel>::add_rows(std::string& text, const OpenPbrModel& model) {
    KindOfNumbers::add_rows(text, model);
    if (model.is_exchanged) add_row(text, "exchanged", "light and viewer");
}

Parameters Kind<OpenPbrModel>::parameters(const OpenPbrModel& model) {
    Parameters all = KindOfNumbers::parameters(model);
    all.push_back({"is_exchanged", model.is_exchanged});
    return all;
}

OpenPbrModel Kind<OpenPbrModel>::from_parameters(ParameterReader& reader) {
    OpenPbrModel model = KindOfNumbers::from_parameters(reader);
    model.is_exchanged = reader.flag("is_exchanged", false);
    return model;
}

std::string Kind<OpenPbrModel>::formula_text(const OpenPbrModel& model, const NumberText& number) {
    std::string text = "    OpenPbrSurface layers;\n";
    const auto set = [&](const std::string& member, float x, std::string_view parameter) {
        text += fmt::format("    {} = {};\n", member, number(x, parameter, 0));
    };
    const Vec3f base = kernel_surface(model).base_color;  // product of base_color and base_weight
    const std::string r = number(base.x, "", 0), g = number(base.y, "", 1), b = number(base.z, "", 2);
    text += fmt::format("    layers.base_color = Vec3({}, {}, {});\n", r, g, b);
    for (const OpenPbrParameter& row : std::span(k_openpbr_parameters).subspan(2, 14))
        text += fmt::format("    layers.{} = {};\n", row.name, number_text(model, row, number));

    const std::string directions = model.is_exchanged ? "wv, wl" : "wl, wv";
    const bool is_anisotropic = model.specular_roughness_anisotropy > 0;
    if (model.thin_film_weight == 0 && !is_anisotropic)
        return text + fmt::format("    return openpbr_value(layers, {});\n", directions);
    const auto film = kernel_film(model);
    text += "    OpenPbrFilm film;\n";
    set("film.weight", film.weight, "thin_film_weight");
    set("film.thickness", film.thickness, "thin_film_thickness");
    set("film.ior", film.ior, "thin_film_ior");
    if (!is_anisotropic) return text + fmt::format("    return openpbr_film_value(layers, film, {});\n", directions);
    const auto anisotropy = kernel_anisotropy(model);
    text += "    OpenPbrAnisotropy anisotropy;\n";
    set("anisotropy.amount", anisotropy.amount, "specular_roughness_anisotropy");
    set("anisotropy.cosine", anisotropy.cosine, "");
    set("anisotropy.sine", anisotropy.sine, "");
    return text + fmt::format("    return openpbr_anisotropic_value(layers, film, anisotropy, {});\n", directions);
}

}  // namespace
