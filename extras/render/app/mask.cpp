#include "extras/render/app/mask.h"

#include <memory>

#include "base/files.h"
#include "base/text.h"
#include "brdf/values.h"
#include "extras/render/exr.h"

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
    constexpr std::uint64_t k_max_bytes = std::uint64_t(1) << 29;
    const auto bytes = read_file(path, [](auto) { return k_max_bytes; });
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

}  // namespace
