// Pairs of directions on either side of a surface, and the BRDFs that have their values.
#pragma once
#include <cmath>
#include <optional>

#include "srbf/brdf.h"

SRBF_BEGIN

/// The part with the light on the other side.
constexpr Part counterpart(Part part) { return Part(std::size_t(part) ^ 1); }

/// A pair of directions in a part's frame, in which both are above the horizon.
struct InPartFrame {
    Part part;
    Vec3f wl, wv;
};
/// The part that has the value of a pair, and the pair in its frame; none if a direction lies in the surface (its
/// cosine is 0 or subnormal) or is not finite.
inline std::optional<InPartFrame> to_part_frame(Vec3f wl, Vec3f wv) {
    const Vec3f l{wl.x, wl.y, std::abs(wl.z)}, v{wv.x, wv.y, std::abs(wv.z)};
    if (!above_horizon(l, v)) return {};
    const bool back = wl.z < 0, across = back != (wv.z < 0);
    return InPartFrame{Part(2 * int(across) + int(back)), l, v};
}
/// The sides of the surface on which the light and the viewer of a part are: −1 (back) or 1 (front). z of a direction
/// in the frame of the part, multiplied by this, is its z.
constexpr float side_of_light(Part part) { return is_back(part) ? -1.f : 1.f; }
constexpr float side_of_viewer(Part part) { return is_back(part) != is_transmission(part) ? -1.f : 1.f; }
/// A direction to one side, from a part's frame.
constexpr Vec3f to_side(Vec3f w, float side) { return {w.x, w.y, side * w.z}; }

/// The BRDF that has the values of a part.
template <typename B> struct PartSource {
    const B* brdf = nullptr;    ///< null: 0
    bool is_exchanged = false;  ///< true if it is evaluated at (wv, wl)
};
template <typename B> PartSource<B> part_source(const Parts<B>& parts, Part part) {
    if (const B* stored = parts[std::size_t(part)].get()) return {stored, false};
    return {parts[std::size_t(counterpart(part))].get(), is_transmission(part)};
}

/// True if a part is known: it or its counterpart has f or a beam.
template <typename B> bool is_known(const Parts<B>& parts, const Beams& beams, Part part) {
    const auto has = [&](Part p) { return parts[std::size_t(p)] || !beams[std::size_t(p)].empty(); };
    return has(part) || has(counterpart(part));
}
/// The beams of all parts: a reflection that has neither f nor a beam has the beam of the other side.
template <typename B> Beams complete_beams(const Parts<B>& parts, Beams beams) {
    for (const std::size_t p : {0, 1})
        if (!parts[p] && beams[p].empty()) beams[p] = beams[1 - p];
    return beams;
}

/// f(wl, wv) [1/sr] of a BSDF of these parts.
template <typename B> Rgb value(const Parts<B>& parts, Vec3f wl, Vec3f wv) {
    const auto at = to_part_frame(wl, wv);
    if (!at) return {};
    const PartSource<B> used = part_source(parts, at->part);
    if (!used.brdf) return {};
    return used.is_exchanged ? value(*used.brdf, at->wv, at->wl) : value(*used.brdf, at->wl, at->wv);
}

/// f on arrays of pairs; `each(brdf, wl, wv, f)` evaluates one of the parts.
template <typename B, typename Each>
void evaluate(const Parts<B>& parts, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f,
              const Each& each) {
    require_equal_lengths(wl.size(), wv.size(), f.size());
    std::array<std::vector<std::size_t>, k_parts> where;
    std::array<std::vector<Vec3f>, k_parts> lights, views;
    for (std::size_t i = 0; i < f.size(); ++i) {
        f[i] = {};
        const auto at = to_part_frame(wl[i], wv[i]);
        if (!at) continue;
        const auto part = std::size_t(at->part);
        where[part].push_back(i);
        lights[part].push_back(at->wl);
        views[part].push_back(at->wv);
    }
    for (std::size_t part = 0; part < k_parts; ++part) {
        const PartSource<B> used = part_source(parts, Part(part));
        if (!used.brdf || where[part].empty()) continue;
        std::vector<Rgb> values(where[part].size());
        const std::span<const Vec3f> l(lights[part]), v(views[part]);
        each(*used.brdf, used.is_exchanged ? v : l, used.is_exchanged ? l : v, std::span<Rgb>(values));
        for (std::size_t i = 0; i < values.size(); ++i) f[where[part][i]] = values[i];
    }
}

/// The largest numbers of rings, and of nodes of a ring, in a file.
inline constexpr std::size_t k_max_beam_rings = 256, k_max_beam_nodes = 2048;
/// The names of beams in files. `transmission` is the beam of both transmissions if there is no `transmission_back`.
inline constexpr std::array<std::string_view, k_parts> k_beam_names{"reflection_front", "reflection_back",
                                                                    "transmission", "transmission_back"};

/// Exchanges light and viewer in each part, so that the transmissions change places.
template <typename B> void exchange_parts(Parts<B>& parts) {
    for (auto& part : parts) {
        if (!part) continue;
        B copy = *part;
        exchange(copy);
        part = std::make_shared<const B>(std::move(copy));
    }
    std::swap(parts[std::size_t(Part::transmission_front)], parts[std::size_t(Part::transmission_back)]);
}

SRBF_END
