#include "extras/render/tone.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "extras/render/shading.h"

namespace SRBF_NAMESPACE {

static_assert(k_knee == float(SRBF_KNEE) && k_whitening == float(SRBF_WHITENING));

Rgb tone_map(Rgb radiance, float exposure) {
    assert(exposure >= 0 && std::isfinite(exposure));
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    if (std::isnan(radiance.r) || std::isnan(radiance.g) || std::isnan(radiance.b)) return {nan, nan, nan};
    constexpr float largest = std::numeric_limits<float>::max();
    Rgb x;
    for (int c = 0; c < 3; ++c) x[c] = std::min(exposure * std::clamp(radiance[c], 0.0f, largest), largest);
    const Vec3f out = Shading<float>::tone_mapped({x.r, x.g, x.b});
    return {out.x, out.y, out.z};
}

Rgb8 to_srgb8(Rgb radiance, float exposure) { return to_srgb8(tone_map(radiance, exposure)); }

float automatic_exposure(const Image& image) { return exposure_to(image, double(k_knee)); }

Image8 shown(const Rendering& rendering, float exposure) {
    const Image& radiance = rendering.radiance;
    assert(rendering.coverage.size() == radiance.pixels.size());
    Image8 out(radiance.width, radiance.height);
    for (std::size_t i = 0; i < radiance.pixels.size(); ++i) {
        const Rgb object = tone_map(radiance.pixels[i], exposure);
        Rgb colour{k_background, k_background, k_background};
        for (int c = 0; c < 3; ++c) colour[c] += rendering.coverage[i] * (object[c] - colour[c]);
        out.pixels[i] = to_srgb8(colour);
    }
    return out;
}

}  // namespace
