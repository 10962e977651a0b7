#include "errors/picture.h"

#include <algorithm>
#include <limits>

namespace srbf {

float exposure_to(const Image& image, double value) {
    std::vector<double> lit;
    for (const Rgb& pixel : image.pixels)
        if (const float largest = std::max({pixel.r, pixel.g, pixel.b}); is_finite(pixel) && largest > 0)
            lit.push_back(largest);
    if (lit.empty()) return 1;
    const auto at = lit.begin() + std::ptrdiff_t(k_exposed * double(lit.size() - 1));
    std::nth_element(lit.begin(), at, lit.end());
    return float(std::min(value / *at, double(std::numeric_limits<float>::max())));
}

}  // namespace srbf
