// BRDFs in colours as BRDFs with channels.
#pragma once
#include "srbf/brdf.h"

SRBF_BEGIN

/// The channels R, G and B of `brdf`.
inline Channels rgb_channels(Evaluate brdf) {
    return {{}, [brdf = std::move(brdf)](auto wl, auto wv, auto f) {
                require_equal_lengths(3 * wl.size(), 3 * wv.size(), f.size());
                std::vector<Rgb> colour(wl.size());
                brdf(wl, wv, colour);
                for (std::size_t i = 0; i < colour.size(); ++i)
                    f[3 * i] = colour[i].r, f[3 * i + 1] = colour[i].g, f[3 * i + 2] = colour[i].b;
            }};
}
inline std::vector<Channels> rgb_channels(std::span<const Evaluate> brdfs) {
    std::vector<Channels> channels;
    for (const Evaluate& brdf : brdfs) channels.push_back(rgb_channels(brdf));
    return channels;
}

SRBF_END
