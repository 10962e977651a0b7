// Texels that were measured at the same pairs of directions.
#pragma once
#include <algorithm>

#include "brdf/directions.h"
#include "models.h"
#include "properties.h"
#include "srbf/fit_map.h"
#include "srbf/load.h"

namespace srbf {

/// Three axial lobes: diffuse, a broad and a narrow highlight.
inline PmModel three_lobes() {
    PmModel model = axial_gaussians(std::vector<Rgb>(3, {1, 1, 1}), {0, 10, 200});
    model.form = PmForm::horizon;
    model.exponent.assign(3, 0);
    return model;
}

inline constexpr std::size_t k_pairs = 150;

/// Pairs within 75°. Half of the lights are uniform, half are near the mirror direction.
inline SharedPairs shared_pairs(std::uint64_t seed = 1) {
    SharedPairs pairs;
    std::mt19937_64 random(seed);
    const double cap = 75 * k_degree;
    const MirrorMixture lights(cap);
    const auto in_cap = [&] {
        const double u1 = uniform(random), u2 = uniform(random);
        return spherical(std::acos(1 - (1 - std::cos(cap)) * u1), 2 * k_pi * u2);
    };
    while (pairs.wl.size() < k_pairs) {
        const Vec3d v = in_cap();
        const double u1 = uniform(random), u2 = uniform(random), u3 = uniform(random);
        const Vec3d l = pairs.wl.size() % 2 == 0 ? in_cap() : lights.sample(v, u1, u2, u3);
        if (l.z < std::cos(cap)) continue;
        pairs.wl.push_back(to_float(l));
        pairs.wv.push_back(to_float(v));
    }
    return pairs;
}

/// Texels [T, pairs]: blends of the bundled measurements with noise of 2 %.
inline std::vector<Rgb> blends(const SharedPairs& pairs, std::size_t count) {
    const auto a = load_measured(bundled_data() / "paper_white_rgb.bsdf"),
               b = load_measured(bundled_data() / "cc_ibiza_sunset_rgb.bsdf");
    EXPECT_TRUE(a && b);
    std::mt19937_64 random(2);
    std::vector<Rgb> f;
    for (std::size_t t = 0; t < count; ++t) {
        const float fraction = float(t) / float(std::max<std::size_t>(count - 1, 1));
        for (std::size_t i = 0; i < pairs.wl.size(); ++i) {
            f.push_back(mixed(value(*a, pairs.wl[i], pairs.wv[i]), value(*b, pairs.wl[i], pairs.wv[i]), fraction));
            for (int c = 0; c < 3; ++c) f.back()[c] *= float(0.96 + 0.08 * uniform(random));
        }
    }
    return f;
}

}  // namespace srbf
