#include "srbf/prepared_bsdf.h"

#include "brdf/parts.h"
#include "models/bsdf/bsdf_functions.h"

#include <algorithm>

namespace SRBF_NAMESPACE {
namespace {

/// Lower bound on the probability of a part that reflects or transmits anything, relative to the sum of all.
constexpr float k_min_chance = 1e-3f;

template <typename B>
PreparedBsdf prepare_parts(const Parts<B>& parts, const Beams& beams, const ProposeOptions& options) {
    PreparedBsdf::PreparedParts ready_parts;
    for (std::size_t p = 0; p < k_parts; ++p) {
        const PartSource<B> used = part_source(parts, Part(p));
        if (!used.brdf) continue;
        if (!used.is_exchanged && !parts[p]) {  // the other side's part, which is ready
            if (const auto& ready = ready_parts[std::size_t(counterpart(Part(p)))]) {
                ready_parts[p] = ready;
                continue;
            }
        }
        B brdf = *used.brdf;
        if (used.is_exchanged) exchange(brdf);
        ready_parts[p] = prepare(std::move(brdf), options);
    }
    return PreparedBsdf(std::move(ready_parts), complete_beams(parts, beams));
}

}  // namespace

PreparedBsdf::PreparedBsdf(PreparedBrdf both_sides) : is_brdf_(true) {
    parts_[std::size_t(Part::reflection_back)] = both_sides;
    parts_[std::size_t(Part::reflection_front)] = std::move(both_sides);
}

PreparedBsdf::PreparedBsdf(PreparedParts parts, Beams beams) : parts_(std::move(parts)), beams_(std::move(beams)) {}

Rgb value(const PreparedBsdf& bsdf, Vec3f wl, Vec3f wv) {
    const auto pair = to_part_frame(wl, wv);
    if (!pair) return {};
    const auto& part = bsdf.parts_[std::size_t(pair->part)];
    return part ? value(*part, pair->wl, pair->wv) : Rgb{};
}

struct PreparedBsdf::Chances {
    std::array<Part, 2> part;  ///< the part of reflection, and the part of transmission
    std::array<float, 2> part_chance;
    std::array<Rgb, 2> beam;
    std::array<float, 2> beam_chance;
};

PreparedBsdf::Chances PreparedBsdf::chances(Vec3f wv) const {
    const bool is_back = wv.z < 0;
    const Vec3f straight = mirror(wv);  // the direction from which a beam comes, in a part's frame
    // Transmitted light comes from the other side of the surface.
    Chances chances{{is_back ? Part::reflection_back : Part::reflection_front,
                     is_back ? Part::transmission_front : Part::transmission_back},
                    {},
                    {},
                    {}};
    float sum = 0;
    for (std::size_t k = 0; k < 2; ++k) {
        const auto part = std::size_t(chances.part[k]);
        if (parts_[part]) chances.part_chance[k] = float(luminance(albedo(*parts_[part], std::abs(wv.z))));
        chances.beam[k] = fraction_at(beams_, chances.part[k], straight);
        chances.beam_chance[k] = float(luminance(chances.beam[k]));
        sum += chances.part_chance[k] + chances.beam_chance[k];
    }
    if (!(sum > 0)) return chances;
    float total = 0;
    for (std::size_t k = 0; k < 2; ++k) {
        if (parts_[std::size_t(chances.part[k])])
            chances.part_chance[k] = std::max(chances.part_chance[k], k_min_chance * sum);
        total += chances.part_chance[k] + chances.beam_chance[k];
    }
    for (std::size_t k = 0; k < 2; ++k) chances.part_chance[k] /= total, chances.beam_chance[k] /= total;
    return chances;
}

float PreparedBsdf::chance(Part part, Vec3f wv) const {
    return is_brdf_ ? 1 : chances(wv).part_chance[std::size_t(is_transmission(part))];
}

BsdfSample sample(const PreparedBsdf& bsdf, Vec3f wv, Vec2f u, float selector) {
    BsdfSample result;
    const auto side = to_part_frame(wv, wv);
    if (!side) return result;
    const float viewer_side = wv.z < 0 ? -1.f : 1.f;
    if (bsdf.is_brdf_) {  // nothing to choose
        const LightSample light = sample(*bsdf.parts_[std::size_t(Part::reflection_front)], side->wv, u, selector);
        return {to_side(light.wl, viewer_side), light.weight, light.pdf};
    }
    const PreparedBsdf::Chances chances = bsdf.chances(wv);
    for (std::size_t k = 0; k < 2; ++k) {
        const float light_side = k == 0 ? viewer_side : -viewer_side;
        if (const float chance = chances.part_chance[k]; selector < chance) {
            const PreparedBrdf& part = *bsdf.parts_[std::size_t(chances.part[k])];
            const float rescaled = chance < 1 ? std::min(selector / chance, 0x1.fffffep-1f) : selector;
            const LightSample light = sample(part, side->wv, u, rescaled);
            result.wl = to_side(light.wl, light_side);
            result.pdf = chance * light.pdf;
            if (light.pdf > 0)
                result.weight = {light.weight.r / chance, light.weight.g / chance, light.weight.b / chance};
            return result;
        }
        selector -= chances.part_chance[k];
        if (const float chance = chances.beam_chance[k]; selector < chance) {
            result.wl = to_side(mirror(side->wv), light_side);
            result.is_beam = true;
            result.weight = {chances.beam[k].r / chance, chances.beam[k].g / chance, chances.beam[k].b / chance};
            return result;
        }
        selector -= chances.beam_chance[k];
    }
    return result;
}

ValuePdf value_pdf(const PreparedBsdf& bsdf, Vec3f wl, Vec3f wv) {
    const auto pair = to_part_frame(wl, wv);
    if (!pair || !bsdf.parts_[std::size_t(pair->part)]) return {};
    const ValuePdf part_value = value_pdf(*bsdf.parts_[std::size_t(pair->part)], pair->wl, pair->wv);
    return {part_value.value, bsdf.chance(pair->part, wv) * part_value.pdf};
}

float pdf(const PreparedBsdf& bsdf, Vec3f wl, Vec3f wv) {
    const auto pair = to_part_frame(wl, wv);
    if (!pair || !bsdf.parts_[std::size_t(pair->part)]) return 0;
    return bsdf.chance(pair->part, wv) * pdf(*bsdf.parts_[std::size_t(pair->part)], pair->wl, pair->wv);
}

PreparedBsdf prepare_bsdf(const Model& model, const ProposeOptions& options) {
    const auto* bsdf = std::get_if<BsdfModel>(&model.model);
    return bsdf ? prepare_parts(bsdf->part, bsdf->beam, options) : PreparedBsdf(prepare(model, options));
}

PreparedBsdf prepare_bsdf(const Measured& measured, const ProposeOptions& options) {
    const auto* bsdf = std::get_if<BsdfTable>(&measured.table);
    if (!bsdf) return PreparedBsdf(prepare(measured, options));
    Parts<Measured> parts = bsdf->band().part;
    if (measured.is_exchanged) exchange_parts(parts);
    return prepare_parts(parts, bsdf->band().beam, options);
}

}  // namespace
