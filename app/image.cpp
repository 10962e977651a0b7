#include "app/image.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "base/errors.h"
#include "errors/sphere.h"
#include "srbf/file.h"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#define STBI_WRITE_NO_STDIO
#include <stb/stb_easy_font.h>
#include <stb/stb_image_write.h>
#include <array>
#pragma GCC diagnostic pop

namespace srbf {

namespace {

/// `text` with '?' in place of characters that the font lacks.
std::string in_ascii(std::string_view text) {
    std::string out(text);
    for (char& c : out)
        if (c < ' ' || c > '~') c = '?';
    return out;
}

/// A corner of a rectangle in the font's format.
struct Corner {
    float x, y, z;
    std::array<unsigned char, 4> colour;
};

constexpr Rgb8 k_strip_colour{38, 38, 38}, k_text_colour{225, 225, 225};

/// A strip of this size with centred `text`.
Image8 caption(int width, int height, const std::string& text) {
    Image8 out(width, height, k_strip_colour);
    const int columns = text_width(text), rows = 9;  // the font's twelve rows without the line spacing
    const int scale = std::max(1, std::min(height / 20, width / std::max(1, columns)));
    draw_text(out, (width - scale * columns) / 2, (height - scale * rows) / 2, text, k_text_colour, scale);
    return out;
}

/// Copies `part` into `image` with its upper left corner at (x, y).
void paste(const Image8& part, int x, int y, Image8& image) {
    for (int row = 0; row < part.height; ++row) std::copy_n(&part.at(0, row), part.width, &image.at(x, y + row));
}

/// Output callback of stb; `context` is a vector of bytes.
void append(void* context, void* data, int size) {
    auto& bytes = *static_cast<std::vector<std::byte>*>(context);
    bytes.insert(bytes.end(), static_cast<std::byte*>(data), static_cast<std::byte*>(data) + size);
}

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

Rgb8 to_srgb8(Rgb colour) {
    Rgb8 out{};
    for (int c = 0; c < 3; ++c) {
        if (std::isnan(colour[c])) return k_not_measured;
        out[std::size_t(c)] = std::uint8_t(255 * srgb_encoded(double(std::clamp(colour[c], 0.0f, 1.0f))) + 0.5);
    }
    return out;
}

int text_width(std::string_view text) { return stb_easy_font_width(in_ascii(text).data()); }

void draw_text(Image8& image, int x, int y, std::string_view text, Rgb8 colour, int scale) {
    assert(scale >= 1);
    std::string line = in_ascii(text);
    // A glyph has at most 11 strokes. Each is a rectangle, with corner 0 at the upper left and 2 at the lower right.
    std::vector<std::array<Corner, 4>> strokes(11 * line.size() + 1);
    const int count =
        stb_easy_font_print(0, 0, line.data(), nullptr, strokes.data(), int(strokes.size() * sizeof strokes[0]));
    for (const auto& stroke : std::span(strokes).first(std::size_t(count))) {
        const auto within = [scale](int origin, float offset, int end) {
            return int(std::clamp(origin + std::int64_t(scale) * int(offset), std::int64_t(0), std::int64_t(end)));
        };
        const auto column = [&](const Corner& corner) { return within(x, corner.x, image.width); };
        const auto row = [&](const Corner& corner) { return within(y, corner.y, image.height); };
        for (int j = row(stroke[0]); j < row(stroke[2]); ++j)
            for (int i = column(stroke[0]); i < column(stroke[2]); ++i) image.at(i, j) = colour;
    }
}

Image8 side_by_side(std::span<const Image8> images, std::span<const std::string> captions) {
    assert(!images.empty() && captions.size() == images.size());
    const int width = images[0].width, height = images[0].height, strip = std::max(12, width / 8);
    Image8 row(int(images.size()) * width, height + strip);
    for (std::size_t i = 0; i < images.size(); ++i) {
        assert(images[i].width == width && images[i].height == height);
        paste(images[i], int(i) * width, 0, row);
        paste(caption(width, strip, captions[i]), int(i) * width, height, row);
    }
    return row;
}

Result<std::vector<std::byte>> png(const Image8& image, const std::string& path) {
    assert(image.pixels.size() == std::size_t(image.width) * std::size_t(image.height));
    constexpr std::int64_t largest = std::int64_t(1) << 29;  // stb counts bytes in an int and doubles its buffers
    if (image.pixels.empty() || (3 * std::int64_t(image.width) + 1) * image.height > largest)
        return input_error(path, "size of a PNG", fmt::format("1 to {} bytes", largest),
                           fmt::format("{} x {} pixels", image.width, image.height));
    std::vector<std::byte> bytes;
    if (stbi_write_png_to_func(append, &bytes, image.width, image.height, 3, image.pixels.data(), 3 * image.width) == 0)
        return Error{path, {}, "cannot be written", "memory for a PNG", ""};
    return bytes;
}

Result<Done> write_png(const Image8& image, const std::string& path) {
    const auto bytes = png(image, path);
    if (!bytes) return bytes.error();
    return write_file(path, *bytes);
}

std::vector<std::byte> jpeg(const Image8& image, int quality) {
    assert(!image.pixels.empty() && image.width <= k_largest_jpeg && image.height <= k_largest_jpeg);
    std::vector<std::byte> bytes;
    stbi_write_jpg_to_func(append, &bytes, image.width, image.height, 3, image.pixels.data(), quality);
    return bytes;
}

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
