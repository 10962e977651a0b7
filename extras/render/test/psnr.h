// The peak signal-to-noise ratio of pictures of 8 bits.
#pragma once
#include <algorithm>
#include <cmath>
#include <string>

#include "extras/render/tone.h"

namespace srbf {

/// The ratio over the pixels that are added.
struct Psnr {
    double squares = 0, count = 0;  ///< of the differences of channels

    void add(const Rgb8& a, const Rgb8& b) {
        for (std::size_t c = 0; c < 3; ++c) squares += std::pow(double(a[c]) - double(b[c]), 2);
        count += 3;
    }
    double decibels() const { return 10 * std::log10(255 * 255 * count / std::max(squares, 1e-9)); }
};

/// Pixel i of a picture of four bytes a pixel.
inline Rgb8 pixel_of(const std::string& rgba, std::size_t i) {
    return {std::uint8_t(rgba[4 * i]), std::uint8_t(rgba[4 * i + 1]), std::uint8_t(rgba[4 * i + 2])};
}

}  // namespace srbf
