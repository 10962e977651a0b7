// Sums and differences of values of a BRDF.
#pragma once
#include <algorithm>

#include "brdf/colour.h"
#include "srbf/brdf.h"

SRBF_BEGIN

/// a + share (b − a).
constexpr Rgb mixed(const Rgb& a, const Rgb& b, float fraction) {
    return {a.r + fraction * (b.r - a.r), a.g + fraction * (b.g - a.g), a.b + fraction * (b.b - a.b)};
}

constexpr Rgb scaled(float factor, const Rgb& rgb) { return {factor * rgb.r, factor * rgb.g, factor * rgb.b}; }

/// f with negative channels set to 0; NaN is kept.
inline Evaluate non_negative(Evaluate values) {
    return [values = std::move(values)](std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f) {
        values(wl, wv, f);
        for (Rgb& c : f) c = non_negative(c);
    };
}

/// f(wv, wl).
inline Evaluate exchanged(Evaluate f) {
    return [f = std::move(f)](auto wl, auto wv, auto values) { f(wv, wl, values); };
}

/// Sets negative channels to 0 and keeps NaN; returns the number of changed channels.
inline int clamp_negative(std::span<float> f) {
    int clamped = 0;
    for (float& x : f) {
        clamped += x < 0;
        x = std::max(x, 0.f);
    }
    return clamped;
}
inline int clamp_negative(Rgb& f) { return clamp_negative({&f[0], 3}); }

inline double square_of(const Rgb& f) { return double(f.r) * f.r + double(f.g) * f.g + double(f.b) * f.b; }
inline double squared_distance(const Rgb& a, const Rgb& b) { return square_of({a.r - b.r, a.g - b.g, a.b - b.b}); }
inline double largest_of(const Rgb& f) { return double(std::max({f.r, f.g, f.b})); }
inline double mean_of(const Rgb& f) { return (double(f.r) + double(f.g) + double(f.b)) / 3; }

/// cosθl cosθv.
inline double cosines(Vec3f wl, Vec3f wv) { return double(wl.z) * double(wv.z); }

/// Σ w |f|².
inline double energy_of(std::span<const Rgb> f, std::span<const double> weight) {
    double energy = 0;
    for (std::size_t i = 0; i < f.size(); ++i) energy += weight[i] * square_of(f[i]);
    return energy;
}

/// f of all directions `wl` and one direction to the viewer.
inline std::vector<Rgb> values_towards(const Evaluate& f, std::span<const Vec3f> wl, Vec3f wv) {
    std::vector<Rgb> values(wl.size());
    f(wl, std::vector<Vec3f>(wl.size(), wv), values);
    return values;
}

/// The channels R, G and B of `brdf`.
inline Channels rgb_channels(Evaluate brdf) {
    return {{}, [brdf = std::move(brdf)](auto wl, auto wv, auto f) {
                require_equal_lengths(3 * wl.size(), 3 * wv.size(), f.size());
                std::vector<Rgb> colour(wl.size());
                brdf(wl, wv, colour);
                for (std::size_t i = 0; i < colour.size(); ++i) {
                    f[3 * i] = colour[i].r;
                    f[3 * i + 1] = colour[i].g;
                    f[3 * i + 2] = colour[i].b;
                }
            }};
}
inline std::vector<Channels> rgb_channels(std::span<const Evaluate> brdfs) {
    std::vector<Channels> channels;
    for (const Evaluate& brdf : brdfs) channels.push_back(rgb_channels(brdf));
    return channels;
}

SRBF_END
