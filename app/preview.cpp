#include "app/preview.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "errors/sphere.h"

namespace srbf {
namespace {

Image ten_times_difference(const Image& a, const Image& b) {
    Image out = a;
    for (std::size_t i = 0; i < out.pixels.size(); ++i)
        for (int c = 0; c < 3; ++c) out.pixels[i][c] = 10 * std::abs(a.pixels[i][c] - b.pixels[i][c]);
    return out;
}

Image8 on_grey(const Image& radiance, float exposure) {
    Image8 picture(radiance.width, radiance.height, to_srgb8({k_background, k_background, k_background}));
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) {
            const Rgb& value = radiance.at(x, y);
            if (shows_sphere(picture.width, x, y))
                picture.at(x, y) = to_srgb8({exposure * value.r, exposure * value.g, exposure * value.b});
        }
    return picture;
}

}  // namespace

Image8 preview(const Evaluate& measured, const Evaluate& fit, const PreviewOptions& options) {
    const auto studio = std::ranges::find(standard_lightings(), "studio", &Lighting::name);
    const std::array brdfs{measured, fit};
    const auto pictures = sphere_pictures(brdfs, {&*studio, 1}, options.size, options.threads)[0];
    const float exposure = exposure_to(pictures[0], k_exposed_value);
    std::vector<Image8> images;
    for (const Image& image : {pictures[0], pictures[1], ten_times_difference(pictures[0], pictures[1])})
        images.push_back(on_grey(image, exposure));
    return side_by_side(images, std::array<std::string, 3>{"measured", options.caption, "10 x difference"});
}

}  // namespace srbf
