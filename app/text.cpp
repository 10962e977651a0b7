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

std::optional<Appearance> reciprocity_errors(const AnyBrdf& brdf, int threads) {
    const auto* measured = std::get_if<Measured>(&brdf);
    if (!measured || std::holds_alternative<ScatteredSamples>(measured->table) ||
        std::holds_alternative<BsdfTable>(measured->table) || std::holds_alternative<MerlTable>(measured->table))
        return {};
    const Evaluate f = evaluator(*measured), other = exchanged(f);
    const Appearance errors =
        compare_pictures(f, {&other, 1}, {.threads = threads, .is_isotropic = is_isotropic(*measured)})[0];
    return errors.mean.delta_e > 0 ? std::optional(errors) : std::nullopt;
}

std::string reciprocity_text(const Appearance& exchanged) {
    return fmt::format("within ΔE_ITP {:.3g} (worst {:.3g}) where light and viewer are exchanged",
                       exchanged.mean.delta_e, exchanged.worst_delta_e);
}

void add_measures(Json& json, const Comparison& comparison) {
    for_measures(comparison, [&](const std::string& name, double value) { json[name] = value; });
    json["pictures"] = json_of(comparison.appearance);
    if (comparison.heldout_appearance) json["heldout_pictures"] = json_of(*comparison.heldout_appearance);
    if (comparison.measure) json["samples_delta_e_itp"] = comparison.samples_delta_e;
}

std::string percent(double ratio) { return fmt::format("{:.3g} %", 100 * ratio); }

}  // namespace srbf
