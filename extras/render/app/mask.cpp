#include "extras/render/app/mask.h"

#include <algorithm>
#include <memory>

#include "base/files.h"
#include "base/parallel.h"
#include "base/text.h"
#include "brdf/values.h"
#include "extras/render/exr.h"
#include "extras/render/path.h"
#include "extras/render/rays.h"

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_NO_STDIO
#define STBI_MAX_DIMENSIONS 8192
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wsign-compare"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

namespace SRBF_NAMESPACE {

Result<Image> load_mask(const std::string& path) {
    constexpr std::uint64_t k_most_bytes = std::uint64_t(1) << 29;
    const auto bytes = read_file(path, [](auto) { return k_most_bytes; });
    if (!bytes) return bytes.error();
    if (is_exr(*bytes)) {
        auto image = read_exr(*bytes, path);
        if (!image) return image.error();
        for (Rgb& pixel : image->pixels)
            for (int c = 0; c < 3; ++c) pixel[c] = pixel[c] > 0 ? std::min(pixel[c], 1.f) : 0;  // NaN as 0
        return image;
    }
    int width = 0, height = 0, channels = 0;
    const std::unique_ptr<stbi_uc, decltype(&stbi_image_free)> texels(
        stbi_load_from_memory(reinterpret_cast<const stbi_uc*>(bytes->data()), int(bytes->size()), &width, &height,
                              &channels, 3),
        stbi_image_free);
    if (!texels) return Error{path, {}, "mask", "a picture: .png, .jpg or .exr", "another file, or a damaged one"};
    Image mask(width, height);
    for (std::size_t i = 0; i < mask.pixels.size(); ++i)
        for (int c = 0; c < 3; ++c) mask.pixels[i][c] = float(texels.get()[3 * i + std::size_t(c)]) / 255;
    return mask;
}

Rendering mixed(const Scene& scene, const Image& mask, std::span<const Rendering> of) {
    constexpr int k_points = 4;  // along a side of a pixel
    const Rays rays({&scene.mesh});
    Rendering rendering = of[0];
    const int width = rendering.radiance.width, height = rendering.radiance.height;
    const auto shares_in = [&](int x, int y) {
        Rgb sum;
        float count = 0;
        for (int i = 0; i < k_points * k_points; ++i) {
            const double s = 2 * (x + (i % k_points + 0.5) / k_points) / width - 1,
                         t = 1 - 2 * (y + (i / k_points + 0.5) / k_points) / height;
            const Vec3d direction = direction_through(scene.camera, double(width) / height, s, t);
            const auto hit = rays.closest(to_float(scene.camera.eye), to_float(direction));
            if (!hit) continue;
            const Rgb shares = mask_shares(mask, of.size(), texture_at(scene.mesh, *hit));
            sum = {sum.r + shares.r, sum.g + shares.g, sum.b + shares.b}, ++count;
        }
        return count > 0 ? scaled(1 / count, sum) : Rgb{1, 0, 0};
    };
    parallel_for(std::size_t(height), 0, [&](std::size_t row) {
        for (int x = 0, y = int(row); x < width; ++x) {
            const Rgb shares = shares_in(x, y);
            for (int c = 0; c < 3; ++c) {
                float& mean = rendering.radiance.at(x, y)[c] = 0;
                for (std::size_t k = 0; k < of.size(); ++k) mean += shares[int(k)] * of[k].radiance.at(x, y)[c];
            }
        }
    });
    return rendering;
}

}  // namespace srbf
