// Tone mapping of linear radiance.
#pragma once
#include "app/image.h"

namespace SRBF_NAMESPACE {

/// Maps a radiance c to a display colour in [0,1]³. With x = exposure max(c, 0) and m its largest channel, the
/// result is
///   x                          if m ≤ k,
///   (1−g) x m'/m + g m'        otherwise, m' = 1 − (1−k)²/(m + 1 − 2k), g = 1 − 1/(1 + s(m − m')),
/// with k = 0.76 and s = 0.15: linear up to the knee k, above it a shoulder that keeps the order of the channels
/// and tends to white. This is the Khronos PBR Neutral tone mapper (2024) without its toe, which is nonlinear for
/// dark colours. Infinity counts as the largest float; a NaN gives NaN in every channel. exposure ≥ 0, finite.
Rgb tone_map(Rgb radiance, float exposure);
/// SRBF_KNEE and SRBF_WHITENING of shading.glsl, which has the same formula.
inline constexpr float k_knee = 0.76f, k_whitening = 0.15f;

/// tone_map(radiance, exposure) as 8-bit sRGB.
Rgb8 to_srgb8(Rgb radiance, float exposure);

/// `exposure_to` with the knee: that fraction of the pixels is displayed linearly.
float automatic_exposure(const Image& image);

/// The output of a renderer: the radiance of visible surfaces, and their coverage of each pixel.
struct Rendering {
    Image radiance;  ///< mean over the covered part; 0 where nothing is covered, NaN where nothing was measured
    std::vector<float> coverage;  ///< covered fraction of each pixel, 0 to 1
};
/// The displayed image: tone_map(radiance, exposure) over a neutral grey, k_background.
Image8 shown(const Rendering& rendering, float exposure);

}  // namespace
