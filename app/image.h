// Images for display: sRGB, captions, PNG, and the preview of a fit.
#pragma once
#include "brdf/colour.h"
#include "errors/picture.h"
#include "srbf/brdf.h"
#include "srbf/result.h"
#include "srbf/vec.h"

namespace srbf {

/// The colour of values that were not measured, which are NaN (magenta).
inline constexpr Rgb8 k_not_measured{255, 0, 255};

/// A colour in [0,1]³ as 8-bit sRGB, rounded to nearest; k_not_measured if it contains a NaN.
Rgb8 to_srgb8(Rgb colour);

/// Draws a line of text with its upper left corner at (x, y). The bitmap font has 12 `scale` rows, scale ≥ 1. Text
/// is clipped to the image; bytes that are not printable ASCII are drawn as '?'.
void draw_text(Image8& image, int x, int y, std::string_view text, Rgb8 colour, int scale = 1);
/// Width of `text` at scale 1 in pixels.
int text_width(std::string_view text);

/// Images of equal size side by side. Below each is a strip of max(12, width/8) rows with its caption in the
/// largest size that fits. There must be at least one image and as many captions as images.
Image8 side_by_side(std::span<const Image8> images, std::span<const std::string> captions);

/// The bytes of a PNG with 8-bit RGB. Returns an error if the image is empty or has more than 2²⁹ bytes.
Result<std::vector<std::byte>> png(const Image8& image, const std::string& path);
/// Writes the picture as PNG. Returns an error if `png` or write_file does.
Result<Done> write_png(const Image8& image, const std::string& path);
/// The image as a JPEG of `quality` 1..100. Each side has 1 to k_largest_jpeg pixels.
std::vector<std::byte> jpeg(const Image8& image, int quality);
inline constexpr int k_largest_jpeg = 65535;

struct PreviewOptions {
    int size = 256;   ///< pixels per side of each sphere's square, at least 16
    int threads = 0;  ///< number of threads; 0: all of the machine. The result does not depend on it
    std::string caption = "fit";
};

/// Three squares side by side, each with a caption in a strip of max(12, size/8) rows below it: `sphere_pictures`
/// of `measured` and of `fit` under the standard lighting `studio`, and 10 |L − L̂| of their radiances per channel,
/// on `k_background`. As in `picture_errors`, all have the exposure of the first and are clipped at white.
Image8 preview(const Evaluate& measured, const Evaluate& fit, const PreviewOptions& options = {});

}  // namespace srbf
