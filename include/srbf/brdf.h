// The interface of a BRDF.
#pragma once
#include <concepts>
#include <functional>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "srbf/srbf.h"

SRBF_BEGIN

/// A BRDF is a type with `value(brdf, wl, wv)`: f_r(wl, wv) [1/sr] for each channel, without the cosine. `wl` and
/// `wv` are unit vectors in the local frame. The value is 0 unless `above_horizon(wl, wv)`, as it is for a
/// direction with a NaN. It is NaN in every channel where a table holds no measurement, and finite and ≥ 0
/// everywhere else. (A BSDF, see bsdf.h, also accepts directions below the horizon.) Functions of a single pair use
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

/// `brdf` as an `Evaluate`. It keeps a reference to `brdf`, which must outlive it; a temporary it owns.
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

SRBF_END
