#include "observe/reciprocal_mean.h"

#include <algorithm>
#include <cmath>

namespace SRBF_NAMESPACE {
namespace {

/// Cosines below this count as this.
constexpr float k_least_weight_cosine = 1e-6f;

/// Replaces `count` values of each pair by their mean with those of the exchanged pair.
void average(std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::size_t count, float* f,
             const float* exchanged) {
    for (std::size_t i = 0; i < wl.size(); ++i) {
        const float cosine_l = std::max(wl[i].z, k_least_weight_cosine),
                    cosine_v = std::max(wv[i].z, k_least_weight_cosine), share = cosine_v / (cosine_v + cosine_l);
        for (std::size_t c = i * count; c < (i + 1) * count; ++c) {
            if (std::isnan(exchanged[c])) continue;
            f[c] = std::isnan(f[c]) ? exchanged[c] : share * f[c] + (1 - share) * exchanged[c];
        }
    }
}

}  // namespace

Evaluate reciprocal_mean(Evaluate f) {
    return [f = std::move(f)](std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> values) {
        std::vector<Rgb> exchanged(values.size());
        f(wl, wv, values);
        f(wv, wl, exchanged);
        if (!values.empty()) average(wl, wv, 3, &values[0].r, &exchanged[0].r);
    };
}

Channels reciprocal_mean(Channels f) {
    const std::size_t count = f.count();
    return {f.wavelengths, [count, f = std::move(f.evaluate)](std::span<const Vec3f> wl, std::span<const Vec3f> wv,
                                                              std::span<float> values) {
                std::vector<float> exchanged(values.size());
                f(wl, wv, values);
                f(wv, wl, exchanged);
                average(wl, wv, count, values.data(), exchanged.data());
            }};
}

}  // namespace srbf
