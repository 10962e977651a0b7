// What the program says of measures and models, as text and as JSON.
#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <span>

#include "app/rows.h"
#include "srbf/fit.h"
#include "srbf/printable.h"

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
    const auto errors = [](const PictureErrors& of) {
        Json named;
        for (const PictureErrorName& e : k_picture_errors) named[e.name] = of.*e.member;
        return named;
    };
    Json pictures = errors(appearance.mean);
    pictures["worst_delta_e_itp"] = appearance.worst_delta_e;
    for (std::size_t k = 0; k < appearance.lighting.size(); ++k)
        pictures["lightings"][standard_lightings()[k].name] = errors(appearance.lighting[k]);
    return pictures;
}

std::optional<Appearance> repeatability(const AnyBrdf& of, int threads) {
    const auto* measured = std::get_if<Measured>(&of);
    if (!measured || std::holds_alternative<ScatteredSamples>(measured->table) ||
        std::holds_alternative<BsdfTable>(measured->table) || std::holds_alternative<MerlTable>(measured->table))
        return {};
    const Appearance exchanged = compare_exchanged(evaluator(*measured), threads);
    return exchanged.mean.delta_e > 0 ? std::optional(exchanged) : std::nullopt;
}

std::string repeats_text(const Appearance& exchanged) {
    return fmt::format("within ΔE_ITP {:.3g} (worst {:.3g}) where light and viewer are exchanged",
                       exchanged.mean.delta_e, exchanged.worst_delta_e);
}

void add_measures(Json& json, const Comparison& comparison, std::string_view prefix) {
    add_measures(json, comparison.matrix, prefix);
    for (const MeasureName& m : k_measures)
        json[fmt::format("{}heldout_{}", prefix, m.name)] = comparison.heldout.*m.member;
    json[fmt::format("{}albedo_error", prefix)] = comparison.albedo_error;
    json[fmt::format("{}pictures", prefix)] = json_of(comparison.appearance);
    if (comparison.heldout_appearance)
        json[fmt::format("{}heldout_pictures", prefix)] = json_of(*comparison.heldout_appearance);
}

std::string percent(double ratio) { return fmt::format("{:.3g} %", 100 * ratio); }

void add_row(std::string& text, std::string_view name, const std::string& what) {
    fmt::format_to(std::back_inserter(text), "  {:<18}{}\n", printable(name), printable(what));
}

std::string wavelengths_text(const std::vector<float>& nm) {
    return fmt::format("{}, {:g} to {:g} nm", nm.size(), nm.front(), nm.back());
}

void add_beams(std::string& text, const Beams& beams) {
    for (std::size_t b = 0; b < beams.size(); ++b) {
        if (beams[b].empty()) continue;
        std::string row;
        for (std::size_t ring = 0, first = 0; ring < beams[b].theta.size(); ++ring) {
            const auto nodes = std::span(beams[b].share).subspan(first, std::size_t(beams[b].nodes(ring)));
            const auto [least, most] = std::ranges::minmax(nodes, {}, &Rgb::g);
            row += fmt::format("{}{:.4g}{} at {:.3g}°", ring ? ", " : "", least.g,
                               nodes.size() > 1 ? fmt::format(" to {:.4g}", most.g) : "",
                               double(beams[b].theta[ring]) / k_degree);
            first += nodes.size();
        }
        add_row(text, "beam", fmt::format("{}: {}", k_beam_names[b], row));
    }
}

namespace {

void add_model(std::string& text, const PmModel& model) {
    add_row(text, "model",
            fmt::format("pm: parameterized multivariate SRBFs, form {}, {} centres", name(model.form),
                        model.axial ? "axial" : "general"));
    add_row(text, "size",
            fmt::format("{} lobes × {} variates, {} bytes", model.lobes, model.variates, payload_bytes(model)));
    if (!model.wavelength.empty()) add_row(text, "wavelengths", wavelengths_text(model.wavelength));
    for (int n = 0; n < model.variates; ++n) {
        const Parameterization p = model.parameterization[std::size_t(n)];
        add_row(text, fmt::format("ψ{}", n + 1), fmt::format("normalize({:.5g} wl + {:.5g} wv)", p.a, p.b));
    }
    fmt::format_to(std::back_inserter(text), "\n  {:>4}  {:>31}  {:>10}", "lobe", "coefficient R, G, B", "log scale");
    for (int n = 0; n < model.variates; ++n)
        fmt::format_to(std::back_inserter(text), "  {:>{}}", fmt::format("λ{}", n + 1), model.axial ? 10 : 26);
    const std::span<const ExponentTerm> terms = std::span(k_terms).first(row_of(model.form).terms);
    for (const ExponentTerm& term : terms) fmt::format_to(std::back_inserter(text), "  {:>9}", term.symbol);
    fmt::format_to(std::back_inserter(text), "\n");
    for (int j = 0; j < model.lobes; ++j) {
        const Rgb beta = model.coefficient[std::size_t(j)];
        fmt::format_to(std::back_inserter(text), "  {:>4}  {:>9.4g}  {:>9.4g}  {:>9.4g}  {:>10.4g}", j + 1, beta.r,
                       beta.g, beta.b, model.log_scale[std::size_t(j)]);
        for (int n = 0; n < model.variates; ++n) {
            const auto i = std::size_t(j * model.variates + n);
            const Vec3f xi = model.centre[i];
            if (model.axial)
                fmt::format_to(std::back_inserter(text), "  {:>10.5g}",
                               xi.z < 0 ? -model.bandwidth[i] : model.bandwidth[i]);
            else
                fmt::format_to(std::back_inserter(text), "  {:>26}",
                               fmt::format("{:.4g} at ({:.2f}, {:.2f}, {:.2f})", model.bandwidth[i], xi.x, xi.y, xi.z));
        }
        for (int k = 0; k < features(model.form); ++k)
            fmt::format_to(std::back_inserter(text), "  {:>9.4g}",
                           model.exponent[std::size_t(j * features(model.form) + k)]);
        fmt::format_to(std::back_inserter(text), "\n");
    }
    if (model.axial) fmt::format_to(std::back_inserter(text), "  A bandwidth λ below 0 is that of a lobe about -z.\n");
    if (terms.empty()) return;
    text += "  A lobe is also multiplied by";
    for (const ExponentTerm& term : terms) fmt::format_to(std::back_inserter(text), " {}", term.factor);
    for (const ExponentTerm& term : terms)
        if (!term.definition.empty()) fmt::format_to(std::back_inserter(text), ",\n  {}", term.definition);
    text += ".\n";
}

void add_model(std::string& text, const SuModel& model) {
    const auto J = std::size_t(model.lobes);
    const bool by_view = model.discretise == Discretise::view;
    add_row(text, "model", "su: scattered univariate SRBFs, a sum of lobes for each sampled direction");
    add_row(text, "size",
            fmt::format("{} lobes × {} sampled directions to the {}, {} bytes", J, model.direction.size(),
                        by_view ? "viewer" : "light", grouped(payload_bytes(model))));
    add_row(text, "between samples",
            model.interpolation == SuInterpolation::rotated
                ? "the two adjacent in elevation, rotated to the azimuth of the direction"
                : fmt::format("the {} nearest, not rotated", model.neighbours));
    add_row(text, "index texture",
            fmt::format("{}, {} bytes with the direction table",
                        model.index ? fmt::format("{} of {} texels a side", name(model.index->map), model.index->size)
                                    : "built on load, a cube",
                        grouped(auxiliary_bytes(model))));
    ValueRange bandwidth, shape;
    std::size_t empty = 0;
    for (std::size_t i = 0; i < model.direction.size(); ++i) {
        const auto first = model.coefficient.begin() + std::ptrdiff_t(i * J);
        empty += std::all_of(first, first + std::ptrdiff_t(J), [](const Rgb& beta) { return beta == Rgb{}; });
    }
    for (std::size_t k = 0; k < model.bandwidth.size(); ++k)
        if (!(model.coefficient[k] == Rgb{})) bandwidth.add(model.bandwidth[k]);
    for (std::size_t k = 0; k < model.shape.size(); ++k)
        if (!(model.coefficient[k] == Rgb{})) shape.add(model.shape[k]);
    add_row(text, "empty samples", empty ? grouped(empty) : "none");
    add_row(text, "bandwidth", bandwidth.text());
    if (!model.shape.empty()) add_row(text, "shape", shape.text());
    add_channel_ranges(text, "coefficient", model.coefficient);
}

void add_model(std::string& text, const BsdfModel& model) {
    add_row(text, "model", fmt::format("bsdf: models of reflection and transmission, {} bytes", payload_bytes(model)));
    add_beams(text, model.beam);
    for (std::size_t p = 0; p < k_parts; ++p) {
        const Answering<Model> of = answering(model.part, Part(p));
        if (model.part[p])
            text += fmt::format("\n  {}\n{}", k_part_names[p], parameters_text(*model.part[p]));
        else
            text += fmt::format("\n  {}: {}\n", k_part_names[p],
                                !of.brdf       ? "0"
                                : of.exchanged ? "by reciprocity"
                                               : "that of the other side");
    }
}

void add_model(std::string& text, const GgxModel& model) {
    add_row(text, "model", "ggx: Lambert and GGX");
    add_row(
        text, "size",
        fmt::format("{} of GGX, {} bytes", model.lobes.size() == 1 ? "one lobe" : "two lobes", payload_bytes(model)));
    add_row(text, "diffuse RGB",
            fmt::format("{:.4g}  {:.4g}  {:.4g}", model.diffuse.r, model.diffuse.g, model.diffuse.b));
    for (const GgxModel::Lobe& lobe : model.lobes) {
        add_row(text, "roughness α", fmt::format("{:.4g}", lobe.roughness));
        add_row(text, "F0 RGB", fmt::format("{:.4g}  {:.4g}  {:.4g}", lobe.f0.r, lobe.f0.g, lobe.f0.b));
        add_row(text, "F90", fmt::format("{:.4g}", lobe.f90));
    }
}

void add_model(std::string& text, const OpenPbrModel& model) {
    add_row(text, "model", "openpbr: a surface by parameters of OpenPBR 1.1");
    add_row(text, "size", fmt::format("{} numbers, {} bytes", openpbr_number_count(model), payload_bytes(model)));
    for (const OpenPbrParameter& of : k_openpbr_parameters) {
        std::string numbers;
        for (int c = 0; c < of.count(); ++c) numbers += fmt::format("{}{:.4g}", c ? "  " : "", number(model, of, c));
        text += fmt::format("  {:<30}{}\n", of.name, numbers);
    }
    if (model.is_exchanged) add_row(text, "exchanged", "light and viewer");
}

}  // namespace

std::string parameters_text(const Model& model) {
    std::string text;
    std::visit([&](const auto& m) { add_model(text, m); }, model.model);
    return text;
}

}  // namespace srbf
