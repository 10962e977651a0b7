// Errors of images: ꟻLIP.
#pragma once
#include "errors/picture.h"

SRBF_BEGIN

/// A number for each pixel.
using Plane = Picture<double>;
/// Weights at −r..r.
using Filter = std::vector<double>;
Filter gaussian_filter(int radius, double sigma);
/// Correlates rows with `horizontal` and columns with `vertical`; border pixels are repeated beyond the border.
Plane correlate(const Plane& plane, const Filter& horizontal, const Filter& vertical);

inline constexpr double k_pixels_per_degree = 3840 * k_degree;
/// ꟻLIP of each pixel of linear colours in [0,1]³, in [0, 1] (Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström &
/// Fairchild, "FLIP: A Difference Evaluator for Alternating Images", 2020), for a display with `pixels_per_degree`; the
/// default is a viewing distance of 0.7 m from a display 0.7 m wide with 3840 pixels.
std::vector<double> flip_map(const Image& reference, const Image& other,
                             double pixels_per_degree = k_pixels_per_degree);

SRBF_END
