// The interface of a BRDF.
#pragma once
#include <array>
#include <concepts>
#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "srbf/handles.h"
#include "srbf/result.h"

SRBF_BEGIN

/// A BRDF is a type with `value(brdf, wl, wv)`: f_r(wl, wv) [1/sr] for each channel, without the cosine. `wl` and
/// `wv` are unit vectors in the local frame. The value is 0 unless `above_horizon(wl, wv)`, as it is for a
/// direction with a NaN. It is NaN in every channel where a table holds no measurement, and finite and ≥ 0
/// everywhere else. (A BSDF also accepts directions below the horizon.) Functions of a single pair use
/// the caller's floating-point mode: if that does not round to nearest, their last bits differ. Functions on arrays
/// use the mode of IEEE 754.
template <typename B>
concept Brdf = requires(const B& brdf, Vec3f wl, Vec3f wv) {
    { value(brdf, wl, wv) } -> std::same_as<Rgb>;
};

/// A BRDF as a function on arrays of pairs: f[i] = f_r(wl[i], wv[i]). The three spans must have the same length;
/// otherwise the program ends. It may be called from several threads at once.
using Evaluate = std::function<void(std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f)>;

/// f with negative channels set to 0; NaN is kept.
inline Rgb non_negative(Rgb f) {
    for (int c = 0; c < 3; ++c) f[c] = f[c] < 0 ? 0 : f[c];
    return f;
}

/// Ends the program unless the three lengths are equal.
inline void require_equal_lengths(std::size_t wl, std::size_t wv, std::size_t f) {
    if (wl != wv || wl != f) misused("arrays of pairs: expected as many wl, wv and values");
}

/// `brdf` as an `Evaluate`. It keeps a reference to `brdf`, which must outlive it, or owns a temporary.
template <Brdf B> Evaluate evaluator(const B& brdf) {
    return [&brdf](std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f) {
        require_equal_lengths(wl.size(), wv.size(), f.size());
        for (std::size_t i = 0; i < wl.size(); ++i) f[i] = value(brdf, wl[i], wv[i]);
    };
}

template <typename B>
requires(Brdf<B> && !std::is_reference_v<B>) Evaluate evaluator(B&& brdf) {
    auto held = std::make_shared<const B>(std::move(brdf));
    return [held, values = evaluator(*held)](std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f) {
        values(wl, wv, f);
    };
}

/// A BRDF with C channels on arrays of pairs: f[i C + c] = f_r(wl[i], wv[i]) [1/sr] in channel c; the channels of a
/// pair are contiguous. The channels are wavelengths, or R, G, B. It may be called from several threads at once.
struct Channels {
    std::vector<float> wavelengths;  ///< [nm], increasing; empty: the channels are R, G, B
    std::function<void(std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<float> f)> evaluate;
    std::size_t count() const { return wavelengths.empty() ? 3 : wavelengths.size(); }
};

// A BSDF has values for light and viewer on either side: z > 0 is the front, z < 0 the back. A BRDF is a BSDF that is 0
// unless both are at the front. A BSDF consists of four parts. In the frame of a part both directions are above the
// horizon: directions at the back are mirrored at the surface, (x, y, z) → (x, y, −z). So light that passes straight
// through, wl = −wv, comes to a part from the mirror direction, as it does in a reflection, and all that is known of
// BRDFs (models, their bounds at the horizon, fits, sampling) holds for a part.

/// The parts of a BSDF, by the side of the light.
enum class Part { reflection_front, reflection_back, transmission_front, transmission_back };
inline constexpr std::size_t k_parts = 4;
inline constexpr std::array<std::string_view, k_parts> k_part_names{"reflection_front", "reflection_back",
                                                                    "transmission_front", "transmission_back"};
constexpr std::string_view name(Part part) { return k_part_names[std::size_t(part)]; }
constexpr bool is_transmission(Part part) { return part >= Part::transmission_front; }
constexpr bool is_back(Part part) { return part == Part::reflection_back || part == Part::transmission_back; }

/// BRDFs, in the order of `Part`. An empty part has the values of its counterpart. A transmission follows from the
/// other one by reciprocity, with light and viewer exchanged. A reflection equals the reflection of the other side, as
/// if front and back were alike. If both are empty, the part is 0.
template <typename B> using Parts = std::array<std::shared_ptr<const B>, k_parts>;

/// A part of a BSDF as a function in its own frame.
Evaluate part_of(Evaluate bsdf, Part part);

/// Light that is not scattered. In the frame of a part the fraction τ(wl) [1] of the light from wl goes on in the
/// mirror direction, which is straight through in a transmission. A beam has no width, so it is not a part of f:
///   L(wv) = ∫ f(wl, wv) L(wl) |cosθl| dωl + τ(mirror(wv)) L(mirror(wv)).
/// τ has nodes on rings of one θ each. It is linear in the azimuth between the nodes of a ring, and linear in θ between
/// rings. It is constant before the first ring, and falls to 0 at 90°, where readers and fits end mirrors by a ring.
struct Beam {
    std::vector<float> theta;        ///< polar angle of each ring [rad], increasing, 0..π/2
    std::vector<Rgb> fraction;       ///< τ at the nodes, ring by ring, 0..1
    std::vector<int> azimuths = {};  ///< number n of nodes of each ring, at 2πk/n; empty: 1 each
    bool empty() const { return theta.empty(); }
    int nodes(std::size_t ring) const { return azimuths.empty() ? 1 : azimuths[ring]; }
    friend bool operator==(const Beam&, const Beam&) = default;
};
/// τ of a beam at the direction to the light, in the part's frame on either side; 0 if that is not finite.
Rgb fraction_at(const Beam& beam, Vec3f wl);

/// The beams of a BSDF, in the order of `Part`. An empty beam is 0, except in two cases. In a transmission it follows
/// from its counterpart by reciprocity, τ(mirror(wl)). In a reflection whose part is empty too, it equals the beam of
/// the other side.
using Beams = std::array<Beam, k_parts>;
/// τ of a part at the direction to the light, in the part's frame on either side.
Rgb fraction_at(const Beams& beams, Part part, Vec3f wl);

SRBF_END
