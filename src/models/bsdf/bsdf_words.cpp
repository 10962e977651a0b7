// Describes a BSDF to programs and people.

#include "brdf/info_rows.h"
#include "brdf/parts.h"
#include "models/bsdf/bsdf_functions.h"
#include "models/bsdf/bsdf_kind.h"
#include "models/kind/parameters.h"

namespace SRBF_NAMESPACE {

std::string Kind<BsdfModel>::summary(const BsdfModel&) { return "bsdf"; }

void Kind<BsdfModel>::add_rows(std::string& text, const BsdfModel& model) {
    add_row(text, "model", fmt::format("bsdf: models of reflection and transmission, {} bytes", payload_bytes(model)));
    add_beams(text, model.beam);
    for (std::size_t p = 0; p < k_parts; ++p) {
        const PartSource<Model> used = part_source(model.part, Part(p));
        if (model.part[p])
            text += fmt::format("\n  {}\n{}", k_part_names[p], rows_text(*model.part[p]));
        else
            text += fmt::format("\n  {}: {}\n", k_part_names[p],
                                !used.brdf          ? is_known(model.part, model.beam, Part(p)) ? "a beam alone" : "0"
                                : used.is_exchanged ? "by reciprocity"
                                                    : "that of the other side");
    }
}

Parameters Kind<BsdfModel>::members(const BsdfModel&) { return {{"form", std::string("bsdf")}}; }

Parameters Kind<BsdfModel>::parameters(const BsdfModel& model) {
    Parameters all;
    for (std::size_t p = 0; p < k_parts; ++p)
        if (model.part[p]) all.push_back({std::string(k_part_names[p]), srbf::parameters(*model.part[p])});
    for (std::size_t b = 0; b < model.beam.size(); ++b) {
        const Beam& beam = model.beam[b];
        if (beam.empty()) continue;
        const std::string name = fmt::format("beam_{}_", k_beam_names[b]);
        all.push_back({name + "angle", array_of({beam.theta.size()}, beam.theta)});
        all.push_back({name + "share", array_of({beam.fraction.size(), 3}, beam.fraction)});
        const std::vector<float> azimuths(beam.azimuths.begin(), beam.azimuths.end());
        if (!azimuths.empty()) all.push_back({name + "azimuths", array_of({azimuths.size()}, azimuths)});
    }
    return all;
}

bool Kind<BsdfModel>::matches(const ParameterReader& reader) {
    const auto has = [&](std::string_view name) { return reader.has(name); };
    return std::ranges::any_of(k_part_names, has) || std::ranges::any_of(k_beam_names, [&](std::string_view name) {
               return reader.has(fmt::format("beam_{}_angle", name));
           });
}

BsdfModel Kind<BsdfModel>::from_parameters(ParameterReader& reader) {
    BsdfModel model;
    for (std::size_t p = 0; p < k_parts; ++p) {
        const Parameters* parameters = reader.part(k_part_names[p]);
        if (!parameters) continue;
        auto part = model_from(*parameters);
        if (!part) reader.refuse(part.error());
        if (part) model.part[p] = std::make_shared<const Model>(*std::move(part));
    }
    for (std::size_t b = 0; b < model.beam.size(); ++b) {
        const std::string name = fmt::format("beam_{}_", k_beam_names[b]);
        const std::string angle = name + "angle", fraction = name + "share", azimuths = name + "azimuths";
        if (!reader.has(angle) && !reader.has(fraction) && !reader.has(azimuths)) continue;
        const char ring = char('a' + 2 * b), node = char(ring + 1);  // each beam has its own letters of shapes
        Beam& beam = model.beam[b];
        beam.theta = reader.numbers(angle, {&ring, 1});
        beam.fraction = reader.vectors<Rgb>(fraction, std::string{reader.has(azimuths) ? node : ring, '3'});
        if (!reader.has(azimuths)) continue;
        // An invalid number of nodes becomes 0, which is refused later.
        for (const float n : reader.numbers(azimuths, {&ring, 1}))
            beam.azimuths.push_back(n >= 1 && n <= float(k_max_beam_nodes) ? int(n) : 0);
    }
    return model;
}

std::string Kind<BsdfModel>::formula_text(const BsdfModel&, const NumberText&) { return {}; }

}  // namespace
