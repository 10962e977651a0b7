#include "errors/picture.h"

#include <limits>

namespace SRBF_NAMESPACE {

float exposure_to(const Image& image, double value) {
    std::vector<double> largest_channels;
    for (const Rgb& pixel : image.pixels)
        if (const float largest = std::max({pixel.r, pixel.g, pixel.b}); is_finite(pixel) && largest > 0)
            largest_channels.push_back(largest);
    if (largest_channels.empty()) return 1;
    const auto quantile =
        largest_channels.begin() + std::ptrdiff_t(k_exposed_quantile * double(largest_channels.size() - 1));
    std::nth_element(largest_channels.begin(), quantile, largest_channels.end());
    return float(std::min(value / *quantile, double(std::numeric_limits<float>::max())));
}

}  // namespace
