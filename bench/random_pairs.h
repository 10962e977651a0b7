// Random pairs of directions for benchmarks.
#pragma once
#include <random>
#include <vector>

#include "brdf/directions.h"

namespace srbf {

struct Pairs {
    std::vector<Vec3f> wl, wv;
};

/// Pairs of directions, each uniform over the hemisphere to 89°. They are the same at every call.
inline Pairs random_pairs(std::size_t count) {
    std::mt19937_64 random(1);
    const MirrorMixture cap(89 * k_degree);
    Pairs pairs;
    for (std::size_t i = 0; i < count; ++i)
        for (auto* directions : {&pairs.wl, &pairs.wv}) {
            const double u1 = uniform(random), u2 = uniform(random);
            directions->push_back(to_float(cap.sample_cap(u1, u2)));
        }
    return pairs;
}

}  // namespace srbf
