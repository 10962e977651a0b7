// Errors of displayed images.
#pragma once
#include "errors/image_errors.h"

SRBF_BEGIN

/// Errors of a displayed image (8-bit sRGB) against a reference of the same size, with at least one pixel.
struct Likeness {
    double psnr = 0;  ///< 10 log10(1 / mean squared error of the channels) [dB]; infinite for equal images
    double ssim = 0;  ///< mean structural similarity of the luma 0.299 R + 0.587 G + 0.114 B; 1 for equal images
    double flip = 0;  ///< mean of `flip_map`; 0 for equal images
};
Likeness likeness(const Image8& reference, const Image8& other);

/// SSIM of each pixel (Wang, Bovik, Sheikh & Simoncelli 2004): Gaussian windows with σ = 1.5, K1 = 0.01, K2 = 0.03, L =
/// 1; the border pixels are repeated beyond the border.
std::vector<double> ssim_map(const Image8& reference, const Image8& other);
/// ꟻLIP of each pixel.
std::vector<double> flip_map(const Image8& reference, const Image8& other,
                             double pixels_per_degree = k_pixels_per_degree);

/// A map in [0, 1] as colours from black over violet and orange to pale yellow.
Image8 in_false_colours(const std::vector<double>& map, int width, int height);

SRBF_END
