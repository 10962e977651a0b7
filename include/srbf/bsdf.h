// Both sides of a surface, as parts that each are like a BRDF.
#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "srbf/brdf.h"
#include "srbf/elementary.h"

namespace [[gnu::visibility("default")]] srbf {

// A BSDF answers for light and viewer on either side: z > 0 is the front, z < 0 the back. A BRDF is a BSDF that is 0
// unless both are at the front. A BSDF consists of four parts. To a part both directions are above the horizon: those
// at the back are mirrored at the surface, (x, y, z) → (x, y, −z). So light that passes straight through, wl = −wv,
// comes to a part from the mirror direction, as it does in a reflection, and all that is known of BRDFs (models, their
// bounds at the horizon, fits, sampling) holds for a part.

/// The parts of a BSDF, by the side of the light.
enum class Part { reflection_front, reflection_back, transmission_front, transmission_back };
inline constexpr std::size_t k_parts = 4;
inline constexpr std::array<std::string_view, k_parts> k_part_names{"reflection_front", "reflection_back",
                                                                    "transmission_front", "transmission_back"};
constexpr std::string_view name(Part part) { return k_part_names[std::size_t(part)]; }
constexpr bool is_transmission(Part part) { return part >= Part::transmission_front; }
constexpr bool is_back(Part part) { return part == Part::reflection_back || part == Part::transmission_back; }
/// The part with the light on the other side.
constexpr Part counterpart(Part part) { return Part(std::size_t(part) ^ 1); }

/// A pair of directions in a part's frame, in which both are above the horizon.
struct InPartFrame {
    Part part;
    Vec3f wl, wv;
};
/// The part that answers for a pair, and the pair in its frame; none if a direction lies in the surface (its cosine is 0
/// or subnormal) or is not finite.
inline std::optional<InPartFrame> to_part_frame(Vec3f wl, Vec3f wv) {
    const Vec3f l{wl.x, wl.y, std::abs(wl.z)}, v{wv.x, wv.y, std::abs(wv.z)};
    if (!above_horizon(l, v)) return {};
    const bool back = wl.z < 0, across = back != (wv.z < 0);
    return InPartFrame{Part(2 * int(across) + int(back)), l, v};
}
/// The sides of the surface on which the light and the viewer of a part are: −1 (back) or 1 (front). z of a direction in the
/// frame of the part, multiplied by this, is its z.
constexpr float side_of_light(Part part) { return is_back(part) ? -1.f : 1.f; }
constexpr float side_of_viewer(Part part) { return is_back(part) != is_transmission(part) ? -1.f : 1.f; }
/// A direction to one side, from a part's frame.
constexpr Vec3f to_side(Vec3f w, float side) { return {w.x, w.y, side * w.z}; }

/// BRDFs, in the order of `Part`. An empty part is answered by its counterpart: transmission by reciprocity, with light
/// and viewer exchanged; reflection as if front and back were alike. Without either the part is 0.
template <typename B> using Parts = std::array<std::shared_ptr<const B>, k_parts>;

/// The BRDF that answers for a part.
template <typename B> struct Answering {
    const B* brdf = nullptr;  ///< null: 0
    bool exchanged = false;   ///< whether it is evaluated at (wv, wl)
};
template <typename B> Answering<B> answering(const Parts<B>& parts, Part part) {
    if (const B* own = parts[std::size_t(part)].get()) return {own, false};
    return {parts[std::size_t(counterpart(part))].get(), is_transmission(part)};
}

/// f(wl, wv) [1/sr] of a BSDF of these parts.
template <typename B> Rgb value(const Parts<B>& parts, Vec3f wl, Vec3f wv) {
    const auto at = to_part_frame(wl, wv);
    if (!at) return {};
    const Answering<B> of = answering(parts, at->part);
    if (!of.brdf) return {};
    return of.exchanged ? value(*of.brdf, at->wv, at->wl) : value(*of.brdf, at->wl, at->wv);
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
        where[part].push_back(i), lights[part].push_back(at->wl), views[part].push_back(at->wv);
    }
    for (std::size_t part = 0; part < k_parts; ++part) {
        const Answering<B> of = answering(parts, Part(part));
        if (!of.brdf || where[part].empty()) continue;
        std::vector<Rgb> values(where[part].size());
        const std::span<const Vec3f> l(lights[part]), v(views[part]);
        each(*of.brdf, of.exchanged ? v : l, of.exchanged ? l : v, std::span<Rgb>(values));
        for (std::size_t i = 0; i < values.size(); ++i) f[where[part][i]] = values[i];
    }
}

/// A part of a BSDF as a function in its own frame.
inline Evaluate part_of(Evaluate bsdf, Part part) {
    return [bsdf = std::move(bsdf), part](std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f) {
        require_equal_lengths(wl.size(), wv.size(), f.size());
        std::vector<Vec3f> lights, views;
        for (std::size_t i = 0; i < f.size(); ++i) {
            lights.push_back(to_side(wl[i], side_of_light(part)));
            views.push_back(to_side(wv[i], side_of_viewer(part)));
        }
        bsdf(lights, views, f);
        for (std::size_t i = 0; i < f.size(); ++i)
            if (!above_horizon(wl[i], wv[i])) f[i] = {};
    };
}

/// Light that is not scattered: in a part's frame the share τ(wl) [1] of the light from wl goes on in the mirror
/// direction, which is straight through in a transmission. It is not a part of f, whose peak it would be without width:
///   L(wv) = ∫ f(wl, wv) L(wl) |cosθl| dωl + τ(mirror(wv)) L(mirror(wv)).
/// τ has nodes on rings of one θ each. It is linear in the azimuth between the nodes of a ring, and in θ between rings;
/// constant before the first ring, 0 beyond 90°.
struct Beam {
    std::vector<float> theta;        ///< of each ring [rad], increasing, 0..π/2
    std::vector<Rgb> share;          ///< of the nodes, ring by ring, 0..1 each
    std::vector<int> azimuths = {};  ///< of each ring the number n of its nodes, at 2πk/n; empty: 1 each
    bool empty() const { return theta.empty(); }
    int nodes(std::size_t ring) const { return azimuths.empty() ? 1 : azimuths[ring]; }
    friend bool operator==(const Beam&, const Beam&) = default;
};
/// In files, of rings, and of nodes of a ring.
inline constexpr std::size_t k_most_beam_rings = 256, k_most_beam_nodes = 2048;
/// τ of a beam at the direction to the light, in the part's frame on either side; 0 if that is not finite.
Rgb share_at(const Beam& beam, Vec3f wl);

/// The beams of a BSDF, in the order of `Part`. An empty one is 0, but that of a transmission is its counterpart's by
/// reciprocity, τ(mirror(wl)).
using Beams = std::array<Beam, k_parts>;
/// In files: `transmission` is of both transmissions if there is no `transmission_back`.
inline constexpr std::array<std::string_view, k_parts> k_beam_names{"reflection_front", "reflection_back",
                                                                    "transmission", "transmission_back"};
/// τ of a part at the direction to the light, in the part's frame on either side.
inline Rgb share_at(const Beams& beams, Part part, Vec3f wl) {
    const Beam& own = beams[std::size_t(part)];
    if (own.empty() && is_transmission(part)) return share_at(beams[std::size_t(counterpart(part))], mirror(wl));
    return share_at(own, wl);
}

}  // namespace srbf
