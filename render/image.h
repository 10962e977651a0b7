// Pictures: linear colours, what a screen shows of them, captions and PNG: level 5.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "srbf/result.h"
#include "srbf/vec.h"

namespace srbf {

/// Pixels in rows, row 0 on top.
template <typename Pixel> struct Picture {
    int width = 0, height = 0;
    std::vector<Pixel> pixels;  ///< height × width
    Picture() = default;
    Picture(int w, int h, Pixel fill = {}) : width(w), height(h), pixels(std::size_t(w) * std::size_t(h), fill) {}
    Pixel& at(int x, int y) { return pixels[std::size_t(y) * std::size_t(width) + std::size_t(x)]; }
    const Pixel& at(int x, int y) const { return pixels[std::size_t(y) * std::size_t(width) + std::size_t(x)]; }
    friend bool operator==(const Picture&, const Picture&) = default;
};

/// Linear radiance; NaN where there is none to show.
using Image = Picture<Rgb>;
/// R, G, B as a screen takes them: sRGB, 8 bits each.
using Rgb8 = std::array<std::uint8_t, 3>;
using Image8 = Picture<Rgb8>;

/// What is not a number shows in this colour (magenta).
inline constexpr Rgb8 k_not_measured{255, 0, 255};

/// The colour in [0,1]³ that a screen is to emit for a radiance c: with x = exposure max(c, 0), m its largest channel,
///   x                          where m ≤ k,
///   (1−g) x m'/m + g m'        elsewhere, m' = 1 − (1−k)²/(m + 1 − 2k), g = 1 − 1/(1 + s(m − m')),
/// k = 0.76, s = 0.15: linear to the knee k, above it a shoulder that keeps the order of the channels and turns to white.
/// It is the Khronos PBR Neutral tone mapper (2024) without its toe, which would bend the dark part. Infinity counts as
/// the largest float; a NaN gives NaN in every channel. exposure ≥ 0, finite.
Rgb tone_map(Rgb radiance, float exposure);
inline constexpr float k_knee = 0.76f,
                       k_whitening = 0.15f;  ///< SRBF_KNEE and SRBF_WHITENING of shading.glsl, whose formula it is

/// sRGB's transfer function (IEC 61966-2-1) on [0,1]: 12.92 x where x ≤ 0.0031308, elsewhere 1.055 x^(1/2.4) − 0.055.
float srgb_encoded(float x);

/// A colour in [0,1]³ as sRGB, 255 times rounded to the nearest; k_not_measured where it holds a NaN.
Rgb8 to_srgb8(Rgb shown);
/// The same of tone_map(radiance, exposure).
Rgb8 to_srgb8(Rgb radiance, float exposure);

/// The exposure that takes the `k_exposed` quantile of the pixels' largest channels to the knee, counting lit pixels alone
/// (finite, some channel above 0): so many of them show as they are, and a highlight that covers less than the rest
/// darkens nothing, however bright. 1 where no pixel is lit.
float automatic_exposure(const Image& image);
inline constexpr double k_exposed = 0.9;

/// What a renderer makes: the radiance of what is seen, and how much of a pixel it covers.
struct Rendering {
    Image radiance;  ///< the mean over what is covered; 0 where nothing is, NaN where there is none to show
    std::vector<float> coverage;  ///< of each pixel, 0 to 1
};
/// As a screen shows it: tone_map(radiance, exposure) over a neutral grey, k_background.
Image8 shown(const Rendering& rendering, float exposure);
inline constexpr float k_background = 0.16f;

/// Writes one line of text, its upper left corner at (x, y), in a bitmap font of 12 `scale` rows; what lies outside of the
/// image is left out. A byte that is no printable ASCII shows as '?'. scale ≥ 1.
void draw_text(Image8& image, int x, int y, std::string_view text, Rgb8 colour, int scale = 1);
/// Columns that `text` takes at scale 1.
int text_width(std::string_view text);

/// Images of one size side by side, below each a strip of max(12, width/8) rows with its caption as large as fits. As many captions
/// as images, one at least.
Image8 side_by_side(std::span<const Image8> images, std::span<const std::string> captions);

/// Writes a PNG of 8-bit RGB. Errors: an empty image, or one of more than 2²⁹ bytes; those of write_file.
Result<Done> write_png(const Image8& image, const std::string& path);
/// The image as a JPEG of `quality` 1..100, not larger than k_largest_jpeg a side: what a page takes of a picture.
std::vector<std::byte> jpeg(const Image8& image, int quality);
inline constexpr int k_largest_jpeg = 65535;

}  // namespace srbf
