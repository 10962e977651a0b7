#include "srbf/prepared_bsdf.h"

#include <algorithm>
#include <cmath>

namespace srbf {
namespace {

/// A part is drawn from at least so often, relative to the others, where it reflects or transmits anything.
constexpr float k_least_chance = 1e-3f;

template <typename B> PreparedBsdf prepared(const Parts<B>& parts, const Beams& beams, const ProposeOptions& options) {
    PreparedBsdf::PreparedParts all;
    for (std::size_t p = 0; p < k_parts; ++p) {
        const Answering<B> of = answering(parts, Part(p));
        if (!of.brdf) continue;
        if (!of.exchanged && !parts[p]) {  // the other side's, which is ready
            if (const auto& ready = all[std::size_t(counterpart(Part(p)))]) {
                all[p] = ready;
                continue;
            }
        }
        B brdf = *of.brdf;
        if (of.exchanged) exchange(brdf);
        all[p] = prepare(std::move(brdf), options);
    }
    return PreparedBsdf(std::move(all), beams);
}

}  // namespace

PreparedBsdf::PreparedBsdf(PreparedBrdf of_both_sides) : is_brdf_(true) {
    parts_[std::size_t(Part::reflection_back)] = of_both_sides;
    parts_[std::size_t(Part::reflection_front)] = std::move(of_both_sides);
}

PreparedBsdf::PreparedBsdf(PreparedParts parts, Beams beams) : parts_(std::move(parts)), beams_(std::move(beams)) {}

Rgb value(const PreparedBsdf& bsdf, Vec3f wl, Vec3f wv) {
    const auto at = to_part_frame(wl, wv);
    if (!at) return {};
    const auto& part = bsdf.parts_[std::size_t(at->part)];
    return part ? value(*part, at->wl, at->wv) : Rgb{};
}

PreparedBsdf::Chances PreparedBsdf::chances(Vec3f wv) const {
    const bool back = wv.z < 0;
    const Vec3f straight = mirror(wv);  // from where a beam comes, in a part's frame
    // The light that is transmitted to the viewer comes from the other side.
    Chances all{{back ? Part::reflection_back : Part::reflection_front,
                 back ? Part::transmission_front : Part::transmission_back},
                {},
                {},
                {}};
    float sum = 0;
    for (std::size_t k = 0; k < 2; ++k) {
        const auto part = std::size_t(all.part[k]);
        // With one choice alone its albedo, which takes time to make, does not matter.
        if (parts_[part]) all.of_part[k] = is_brdf_ ? 1 : float(luminance(albedo(*parts_[part], std::abs(wv.z))));
        all.beam[k] = share_at(beams_, all.part[k], straight);
        all.of_beam[k] = float(luminance(all.beam[k]));
        sum += all.of_part[k] + all.of_beam[k];
    }
    if (is_brdf_ || !(sum > 0)) return all;
    float again = 0;
    for (std::size_t k = 0; k < 2; ++k) {
        if (parts_[std::size_t(all.part[k])]) all.of_part[k] = std::max(all.of_part[k], k_least_chance * sum);
        again += all.of_part[k] + all.of_beam[k];
    }
    for (std::size_t k = 0; k < 2; ++k) all.of_part[k] /= again, all.of_beam[k] /= again;
    return all;
}

BsdfSample sample(const PreparedBsdf& bsdf, Vec3f wv, Vec2f u, float selector) {
    BsdfSample drawn;
    const auto side = to_part_frame(wv, wv);
    if (!side) return drawn;
    const float of_viewer = wv.z < 0 ? -1.f : 1.f;
    const PreparedBsdf::Chances chances = bsdf.chances(wv);
    for (std::size_t k = 0; k < 2; ++k) {
        const float of_light = k == 0 ? of_viewer : -of_viewer;
        if (const float chance = chances.of_part[k]; selector < chance) {
            const PreparedBrdf& part = *bsdf.parts_[std::size_t(chances.part[k])];
            const float again = chance < 1 ? std::min(selector / chance, 0x1.fffffep-1f) : selector;
            const LightSample light = sample(part, side->wv, u, again);
            drawn.wl = to_side(light.wl, of_light);
            drawn.pdf = chance * light.pdf;
            if (light.pdf > 0)
                drawn.weight = {light.weight.r / chance, light.weight.g / chance, light.weight.b / chance};
            return drawn;
        }
        selector -= chances.of_part[k];
        if (const float chance = chances.of_beam[k]; selector < chance) {
            drawn.wl = to_side(mirror(side->wv), of_light);
            drawn.is_beam = true;
            drawn.weight = {chances.beam[k].r / chance, chances.beam[k].g / chance, chances.beam[k].b / chance};
            return drawn;
        }
        selector -= chances.of_beam[k];
    }
    return drawn;
}

float pdf(const PreparedBsdf& bsdf, Vec3f wl, Vec3f wv) {
    const auto at = to_part_frame(wl, wv);
    if (!at || !bsdf.parts_[std::size_t(at->part)]) return 0;
    const auto chances = bsdf.chances(wv);
    return chances.of_part[std::size_t(is_transmission(at->part))] *
           pdf(*bsdf.parts_[std::size_t(at->part)], at->wl, at->wv);
}

PreparedBsdf prepare_bsdf(const Model& model, const ProposeOptions& options) {
    const auto* bsdf = std::get_if<BsdfModel>(&model.model);
    return bsdf ? prepared(bsdf->part, bsdf->beam, options) : PreparedBsdf(prepare(model, options));
}

PreparedBsdf prepare_bsdf(const Measured& measured, const ProposeOptions& options) {
    const auto* bsdf = std::get_if<BsdfTable>(&measured.table);
    if (!bsdf) return PreparedBsdf(prepare(measured, options));
    Parts<Measured> parts = bsdf->band().part;
    if (!measured.exchanged) return prepared(parts, bsdf->band().beam, options);
    for (auto& part : parts) {
        if (!part) continue;
        Measured copy = *part;
        exchange(copy);
        part = std::make_shared<const Measured>(std::move(copy));
    }
    std::swap(parts[std::size_t(Part::transmission_front)], parts[std::size_t(Part::transmission_back)]);
    return prepared(parts, bsdf->band().beam, options);
}

}  // namespace srbf
