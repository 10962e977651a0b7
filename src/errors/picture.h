// Pictures and their exposure.
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "srbf/vec.h"

SRBF_BEGIN

/// Pixels in rows, row 0 at the top.
template <typename Pixel> struct Picture {
    int width = 0, height = 0;
    std::vector<Pixel> pixels;  ///< height × width
    Picture() = default;
    Picture(int w, int h, Pixel fill = {}) : width(w), height(h), pixels(std::size_t(w) * std::size_t(h), fill) {}
    Pixel& at(int x, int y) { return pixels[std::size_t(y) * std::size_t(width) + std::size_t(x)]; }
    const Pixel& at(int x, int y) const { return pixels[std::size_t(y) * std::size_t(width) + std::size_t(x)]; }
    friend bool operator==(const Picture&, const Picture&) = default;
};

/// Linear radiance; NaN where there is no measurement.
using Image = Picture<Rgb>;
/// Display colours: sRGB, 8 bits per channel.
using Rgb8 = std::array<std::uint8_t, 3>;
using Image8 = Picture<Rgb8>;

/// The exposure that maps a quantile of the lit pixels' largest channels to `value`; 1 if no pixel is lit (finite, with
/// a channel above 0). The brightness of the brightest tenth thus does not darken the image.
float exposure_to(const Image& image, double value);
/// Radiance at this exposure, each channel in [0, 1].
inline Rgb exposed(const Rgb& radiance, float exposure) {
    const auto channel = [&](float x) { return std::clamp(exposure * x, 0.f, 1.f); };
    return {channel(radiance.r), channel(radiance.g), channel(radiance.b)};
}
inline constexpr double k_exposed_quantile = 0.9;

SRBF_END
