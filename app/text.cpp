// Text and JSON of measures and models.
#include <fmt/format.h>

#include <iterator>

#include "app/output.h"
#include "base/printable.h"
#include "errors/measures.h"
#include "errors/picture_errors.h"
#include "errors/sphere.h"
#include "fit/request_traits.h"
#include "observe/pair_weights.h"
#include "srbf/fit.h"

namespace srbf {

const MeasureName& measure_named_for(Objective objective) {
    return *std::ranges::find(k_measures, measure_of(objective), &MeasureName::member);
}

std::string text(const MeasureName& name, const Measures& measures) {
    return name.is_ratio ? percent(measures.*name.member) : fmt::format("{:.4g}", measures.*name.member);
}

void add_measures(Json& json, const Measures& measures, std::string_view prefix) {
    for (const MeasureName& m : k_measures) json[fmt::format("{}{}", prefix, m.name)] = measures.*m.member;
}

Json json_of(const Appearance& appearance) {
    const auto errors = [](const PictureErrors& picture_errors) {
        Json named;
        for (const PictureErrorName& e : k_picture_errors) named[e.name] = picture_errors.*e.member;
        return named;
    };
    Json pictures = errors(appearance.mean);
    pictures["worst_delta_e_itp"] = appearance.worst_delta_e;
    for (std::size_t k = 0; k < appearance.lighting.size(); ++k)
        pictures["lightings"][standard_lightings()[k].name] = errors(appearance.lighting[k]);
    return pictures;
}

Json json_of(const Parameter& parameter) {
    return std::visit(
        []<typename T>(const T& value) {
            Json json;
            if constexpr (std::is_same_v<T, Parameters>) {
                for (const Parameter& nested : value) json[nested.name] = json_of(nested);
            } else if constexpr (std::is_same_v<T, NumberArray>) {
                json = value.shape.empty() ? Json(value.numbers[0]) : Json(value.numbers);
            } else if constexpr (!std::is_same_v<T, std::monostate>) {
                json = value;
            }
            return json;
        },
        parameter.value);
}

std::optional<Appearance> repeatability(const AnyBrdf& brdf, int threads) {
    const auto* measured = std::get_if<Measured>(&brdf);
    if (!measured || std::holds_alternative<ScatteredSamples>(measured->table) ||
        std::holds_alternative<BsdfTable>(measured->table) || std::holds_alternative<MerlTable>(measured->table))
        return {};
    const Appearance exchanged = compare_exchanged(evaluator(*measured), threads);
    return exchanged.mean.delta_e > 0 ? std::optional(exchanged) : std::nullopt;
}

std::string repeats_text(const Appearance& exchanged) {
    return fmt::format("pictures change by ΔE_ITP {:.3g} (worst {:.3g}) if light and viewer are exchanged",
                       exchanged.mean.delta_e, exchanged.worst_delta_e);
}

void add_measures(Json& json, const Comparison& comparison, std::string_view prefix) {
    for_measures(comparison, [&](const std::string& name, double value) { json[std::string(prefix) + name] = value; });
    json[fmt::format("{}pictures", prefix)] = json_of(comparison.appearance);
    if (comparison.heldout_appearance)
        json[fmt::format("{}heldout_pictures", prefix)] = json_of(*comparison.heldout_appearance);
    if (comparison.measure) json[fmt::format("{}samples_delta_e_itp", prefix)] = comparison.samples_delta_e;
}

std::string percent(double ratio) { return fmt::format("{:.3g} %", 100 * ratio); }

}  // namespace srbf
