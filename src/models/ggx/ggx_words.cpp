// Describes Lambert and GGX to programs and people.
#include <fmt/format.h>

#include "brdf/rows.h"
#include "models/ggx/ggx_functions.h"
#include "models/ggx/ggx_kind.h"
#include "models/kind/parameters.h"
#include "srbf/model.h"

namespace SRBF_NAMESPACE {
namespace {

std::string number_of_lobes(const GgxModel& model) { return model.lobes.size() == 1 ? "one lobe" : "two lobes"; }

}  // namespace

std::string Kind<GgxModel>::summary(const GgxModel& model) {
    return fmt::format("ggx, {} and Lambert", number_of_lobes(model));
}

void Kind<GgxModel>::add_rows(std::string& text, const GgxModel& model) {
    add_row(text, "model", "ggx: Lambert and GGX");
    add_row(text, "size", fmt::format("{} of GGX, {} bytes", number_of_lobes(model), payload_bytes(model)));
    add_row(text, "diffuse RGB",
            fmt::format("{:.4g}  {:.4g}  {:.4g}", model.diffuse.r, model.diffuse.g, model.diffuse.b));
    for (const GgxModel::Lobe& lobe : model.lobes) {
        add_row(text, "roughness α", fmt::format("{:.4g}", lobe.roughness));
        add_row(text, "F0 RGB", fmt::format("{:.4g}  {:.4g}  {:.4g}", lobe.f0.r, lobe.f0.g, lobe.f0.b));
        add_row(text, "F90", fmt::format("{:.4g}", lobe.f90));
    }
}

Parameters Kind<GgxModel>::members(const GgxModel& model) {
    return {{"form", std::string("ggx")}, {"lobes", int(model.lobes.size())}, {"variates", 1}, {"axial", true}};
}

Parameters Kind<GgxModel>::parameters(const GgxModel& model) {
    std::vector<float> roughness, f90;
    std::vector<Rgb> f0;
    for (const GgxModel::Lobe& lobe : model.lobes)
        roughness.push_back(lobe.roughness), f0.push_back(lobe.f0), f90.push_back(lobe.f90);
    const std::size_t L = model.lobes.size();
    return {{"diffuse", array_of({3}, std::vector{model.diffuse})},
            {"roughness", array_of({L}, roughness)},
            {"f0", array_of({L, 3}, f0)},
            {"f90", array_of({L}, f90)}};
}

bool Kind<GgxModel>::is_of(const ParameterReader& reader) { return reader.has("f0"); }

GgxModel Kind<GgxModel>::made_of(ParameterReader& reader) {
    const auto roughness = reader.numbers("roughness", "L"), f90 = reader.numbers("f90", "L");
    const auto diffuse = reader.vectors<Rgb>("diffuse", "3"), f0 = reader.vectors<Rgb>("f0", "L3");
    GgxModel model;
    if (reader.error()) return model;
    model.diffuse = diffuse[0];
    for (std::size_t i = 0; i < roughness.size(); ++i) model.lobes.push_back({roughness[i], f0[i], f90[i]});
    return model;
}

std::vector<Model> Kind<GgxModel>::terms(const GgxModel& model, std::size_t) {
    GgxModel black = model;
    black.diffuse = {};
    for (GgxModel::Lobe& lobe : black.lobes) lobe.f0 = {}, lobe.f90 = 0;
    std::vector<Model> all;
    GgxModel diffuse = black;
    diffuse.diffuse = model.diffuse;
    all.push_back({diffuse, {}});
    for (std::size_t i = 0; i < model.lobes.size(); ++i) {
        GgxModel lobe = black;
        lobe.lobes[i] = model.lobes[i];
        all.push_back({lobe, {}});
    }
    return all;
}

std::string Kind<GgxModel>::formula_text(const GgxModel& model, const NumberText& number) {
    const auto colour = [&](const Rgb& rgb, const char* parameter, std::size_t i) {
        const std::string r = number(rgb.r, parameter, 3 * i), g = number(rgb.g, parameter, 3 * i + 1),
                          b = number(rgb.b, parameter, 3 * i + 2);
        return fmt::format("Vec3({}, {}, {})", r, g, b);
    };
    constexpr std::array<const char*, k_most_ggx_lobes> names{"first", "second"};
    std::string text, sum = "Real(2.0 / SRBF_TWO_PI) * " + colour(model.diffuse, "diffuse", 0);
    for (std::size_t i = 0; i < model.lobes.size(); ++i) {
        const GgxModel::Lobe& lobe = model.lobes[i];
        const std::string roughness = number(lobe.roughness, "roughness", i), f0 = colour(lobe.f0, "f0", i),
                          f90 = number(lobe.f90, "f90", i);
        text += fmt::format("    GgxLobe {0};\n    {0}.roughness = {1};\n    {0}.f0 = {2};\n    {0}.f90 = {3};\n",
                            names[i], roughness, f0, f90);
        sum += fmt::format(" + ggx_lobe_value({}, wl, wv)", names[i]);
    }
    return text + "    return " + sum + ";\n";
}

}  // namespace srbf
