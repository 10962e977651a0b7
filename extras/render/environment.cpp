#include "extras/render/environment.h"

#include <fmt/format.h>

#include <cmath>

#include "base/files.h"
#include "base/text.h"
#include "extras/render/exr.h"
#include "srbf/file.h"
#include "src/base/floating_point.h"

/// data/studio.hdr, embedded into the program by studio.S.
extern "C" const std::byte srbf_studio_begin[], srbf_studio_end[];

namespace SRBF_NAMESPACE {
namespace {

/// The interval of the cumulative distribution that contains u, and the position of u within it, in [0, 1].
struct CdfPosition {
    std::size_t index;
    float fraction;
};
CdfPosition find(std::span<const float> running, float u) {
    const auto after = std::upper_bound(running.begin() + 1, running.end() - 1, u);
    auto index = std::size_t(after - running.begin()) - 1;
    while (index > 0 && !(running[index + 1] > running[index])) --index;  // rounding selected an empty interval
    const float width = running[index + 1] - running[index];
    return {index, width > 0 ? std::clamp((u - running[index]) / width, 0.f, 1.f) : 0.5f};
}

/// The solid angle of a texel in a row.
double solid_angle(int row, int width, int height) {
    return 2 * k_pi / width * (std::cos(k_pi * row / height) - std::cos(k_pi * (row + 1) / height));
}

/// Reads consecutive bytes.
struct Bytes {
    std::span<const std::byte> remaining;
    bool has(std::size_t count) const { return remaining.size() >= count; }
    unsigned take() {
        const auto byte = std::to_integer<unsigned>(remaining[0]);
        remaining = remaining.subspan(1);
        return byte;
    }
};
using Rgbe = std::array<unsigned, 4>;

Rgb decode(const Rgbe& rgbe) {
    if (rgbe[3] == 0) return {};
    const auto channel = [&](unsigned mantissa) { return std::ldexp(float(mantissa), int(rgbe[3]) - 136); };
    return {channel(rgbe[0]), channel(rgbe[1]), channel(rgbe[2])};
}

/// Reads a row; returns false if the file ends early or a run is longer than the row.
bool read_row(Bytes& bytes, std::vector<Rgbe>& row) {
    const std::size_t width = row.size();
    if (!bytes.has(4)) return false;
    const auto is = [&](std::size_t i, unsigned x) { return std::to_integer<unsigned>(bytes.remaining[i]) == x; };
    const bool encoded = width >= 8 && width < 32768 && is(0, 2) && is(1, 2) && is(2, unsigned(width >> 8)) &&
                         is(3, unsigned(width & 255));
    if (!encoded) {
        if (!bytes.has(4 * width)) return false;
        for (Rgbe& texel : row)
            for (unsigned& byte : texel) byte = bytes.take();
        return true;
    }
    bytes.remaining = bytes.remaining.subspan(4);
    for (std::size_t c = 0; c < 4; ++c)
        for (std::size_t x = 0; x < width;) {
            if (!bytes.has(2)) return false;
            const unsigned count = bytes.take(), length = count > 128 ? count - 128 : count;
            if (length == 0 || length > width - x || !bytes.has(count > 128 ? 1 : length)) return false;
            const unsigned repeated = count > 128 ? bytes.take() : 0;
            for (unsigned i = 0; i < length; ++i) row[x++][c] = count > 128 ? repeated : bytes.take();
        }
    return true;
}

/// The header before the texels.
struct HdrHeader {
    std::int64_t width, height;
    std::size_t resolution, texels;  ///< offsets of the resolution line and of the texels
};
Result<HdrHeader> read_header(std::span<const std::byte> bytes, const std::string& file_name) {
    const auto fail = [&](std::uint64_t offset, std::string what, std::string expected, std::string found) {
        return Error{file_name, offset, std::move(what), std::move(expected), std::move(found)};
    };
    const std::string_view text = as_text(bytes);
    if (!text.starts_with("#?"))
        return fail(0, "first bytes", "'#?' of a Radiance file, or OpenEXR", quoted(text.substr(0, 8)));
    const auto header_end = text.find("\n\n");
    if (header_end == text.npos || header_end > 65536) return fail(0, "header", "ended by an empty line", "none");
    if (const auto format = text.find("\nFORMAT="); format < header_end)
        if (const auto format_name = trimmed(text.substr(format + 8, text.find('\n', format + 8) - format - 8));
            format_name != "32-bit_rle_rgbe")
            return fail(format + 1, "FORMAT", "32-bit_rle_rgbe", quoted(format_name));
    const auto begin = header_end + 2, end = std::min(text.find('\n', begin), text.size());
    std::string_view line = text.substr(begin, end - begin);
    const auto minus_y = next_word(line);
    const auto height = to_number<std::int64_t>(next_word(line));
    const auto plus_x = next_word(line);
    const auto width = to_number<std::int64_t>(next_word(line));
    if (minus_y != "-Y" || plus_x != "+X" || !height || !width || end == text.size())
        return fail(begin, "resolution", "'-Y HEIGHT +X WIDTH'", quoted(text.substr(begin, end - begin)));
    if (*width < 1 || *height < 1 || *width > k_max_texels / *height)
        return fail(begin, "resolution", fmt::format("1 to {} texels", k_max_texels),
                    fmt::format("{} x {}", *width, *height));
    return HdrHeader{*width, *height, begin, end + 1};
}

/// Upper bound on the size of a file with this beginning. An invalid header limits it to the beginning, which
/// suffices to report the error.
std::uint64_t max_bytes_of(std::span<const std::byte> head) {
    if (is_exr(head)) return check_exr_header(head, k_largest_file, {}).ok() ? k_largest_file : head.size();
    const auto header = read_header(head, {});
    if (!header) return head.size();
    // A run of one texel takes two bytes in each of the four channels.
    return header->texels + std::uint64_t(header->height) * (8 * std::uint64_t(header->width) + 4);
}

}  // namespace

Environment::Environment(Image texels) : texels_(std::move(texels)) {
    const int width = texels_.width, height = texels_.height;
    for (Rgb& texel : texels_.pixels) {
        bool changed = false;
        for (int c = 0; c < 3; ++c)
            if (!(texel[c] >= 0 && std::isfinite(texel[c]))) {
                texel[c] = 0;
                changed = true;
            }
        clamped_ += changed;
    }
    // The mean of the bilinear function over a texel: weights of three quarters for the texel and an eighth for
    // each neighbour, along both axes.
    const auto light = [&](int x, int y) {
        return luminance(texels_.at((x + width) % width, std::clamp(y, 0, height - 1)));
    };
    const auto along = [&](int x, int y) { return 0.75 * light(x, y) + 0.125 * (light(x - 1, y) + light(x + 1, y)); };
    std::vector<double> row_sums(std::size_t(height) + 1);
    for (int y = 0; y < height; ++y) solid_angle_.push_back(float(solid_angle(y, width, height)));
    for (int y = 0; y < height; ++y) {
        std::vector<double> running{0};
        for (int x = 0; x < width; ++x)
            running.push_back(running.back() + 0.75 * along(x, y) + 0.125 * (along(x, y - 1) + along(x, y + 1)));
        const double total = running.back();
        row_sums[std::size_t(y) + 1] = row_sums[std::size_t(y)] + total * solid_angle(y, width, height);
        for (const double sum : running) column_.push_back(total > 0 ? float(sum / total) : 0.f);
    }
    for (const double sum : row_sums) row_.push_back(row_sums.back() > 0 ? float(sum / row_sums.back()) : 0.f);
}

Environment::Light Environment::at(Vec3f w) const {
    const int width = texels_.width, height = texels_.height;
    const float column = (0.5f + std::atan2(w.x, -w.z) * float(0.5 / k_pi)) * float(width),
                row = std::acos(std::clamp(w.y, -1.f, 1.f)) * float(1 / k_pi) * float(height);
    const float x = column - 0.5f, y = std::clamp(row - 0.5f, 0.f, float(height - 1)), x0 = std::floor(x),
                y0 = std::floor(y), s = x - x0, t = y - y0;
    const int left = (int(x0) + width) % width, right = (left + 1) % width, top = int(y0),
              below = std::min(top + 1, height - 1);
    Light light;
    for (int c = 0; c < 3; ++c)
        light.radiance[c] = (1 - t) * ((1 - s) * texels_.at(left, top)[c] + s * texels_.at(right, top)[c]) +
                            t * ((1 - s) * texels_.at(left, below)[c] + s * texels_.at(right, below)[c]);
    const auto i = std::size_t(std::clamp(int(row), 0, height - 1)),
               j = std::size_t(std::clamp(int(column), 0, width - 1)), index = i * std::size_t(width + 1) + j;
    light.pdf = (row_[i + 1] - row_[i]) * (column_[index + 1] - column_[index]) / solid_angle_[i];
    return light;
}

Vec3f Environment::sample(float u1, float u2) const {
    const int width = texels_.width, height = texels_.height;
    const CdfPosition row = find(row_, u2);
    const CdfPosition column =
        find(std::span(column_).subspan(row.index * std::size_t(width + 1), std::size_t(width + 1)), u1);
    const double top = std::cos(k_pi * double(row.index) / height),
                 bottom = std::cos(k_pi * double(row.index + 1) / height);
    const double y = top + double(row.fraction) * (bottom - top), r = std::sqrt(std::max(0.0, 1 - y * y));
    const double phi = ((double(column.index) + double(column.fraction)) / width - 0.5) * 2 * k_pi;
    return {float(r * std::sin(phi)), float(y), float(-r * std::cos(phi))};
}

Image halved(const Image& texels) {
    Image half(std::max(texels.width / 2, 1), std::max(texels.height / 2, 1));
    // The texels first..last along an axis of `source` texels that texel i of `target` texels covers; an odd one is
    // shared by both.
    const auto range = [](int i, int source, int target) {
        return std::pair(i * source / target, ((i + 1) * source + target - 1) / target);
    };
    for (int y = 0; y < half.height; ++y)
        for (int x = 0; x < half.width; ++x) {
            const auto [top, bottom] = range(y, texels.height, half.height);
            const auto [left, right] = range(x, texels.width, half.width);
            std::array<double, 3> sum{};
            double weight = 0;
            for (int row = top; row < bottom; ++row) {
                const double row_weight = solid_angle(row, texels.width, texels.height);
                for (int column = left; column < right; ++column, weight += row_weight)
                    for (int c = 0; c < 3; ++c) sum[std::size_t(c)] += row_weight * double(texels.at(column, row)[c]);
            }
            for (int c = 0; c < 3; ++c) half.at(x, y)[c] = float(sum[std::size_t(c)] / weight);
        }
    return half;
}

std::vector<std::array<std::uint8_t, 4>> to_rgbe(const Image& image) {
    std::vector<std::array<std::uint8_t, 4>> texels;
    texels.reserve(image.pixels.size());
    for (const Rgb& c : image.pixels) {
        auto& texel = texels.emplace_back();
        const float peak = std::max({c.r, c.g, c.b});
        if (!(peak > 1e-30f)) continue;
        int exponent = 0;
        if (std::frexp(peak, &exponent) > 255.5f / 256) ++exponent;
        for (int k = 0; k < 3; ++k)
            texel[std::size_t(k)] = std::uint8_t(std::lround(std::ldexp(std::max(c[k], 0.f), 8 - exponent)));
        texel[3] = std::uint8_t(std::clamp(exponent + 128, 1, 255));
    }
    return texels;
}

Result<Image> read_hdr(std::span<const std::byte> bytes, const std::string& file_name) {
    const StandardArithmetic mode;
    const auto header = read_header(bytes, file_name);
    if (!header) return header.error();
    // A run of 127 texels takes two bytes in each of the four channels.
    Bytes reader{bytes.subspan(header->texels)};
    if (header->width * header->height > std::int64_t(reader.remaining.size()) * 16)
        return Error{file_name, header->resolution, "resolution",
                     fmt::format("texels that {} bytes can hold", reader.remaining.size()),
                     fmt::format("{} x {}", header->width, header->height)};
    Image image(static_cast<int>(header->width), static_cast<int>(header->height));
    std::vector<Rgbe> row(static_cast<std::size_t>(header->width));
    for (int y = 0; y < image.height; ++y) {
        const std::size_t offset = bytes.size() - reader.remaining.size();
        if (!read_row(reader, row))
            return Error{file_name, offset, fmt::format("row {}", y), fmt::format("{} texels", header->width),
                         "fewer, or a longer run"};
        for (int x = 0; x < image.width; ++x) image.at(x, y) = decode(row[std::size_t(x)]);
    }
    return image;
}

Result<Environment> read_environment(std::span<const std::byte> bytes, const std::string& file_name) {
    const StandardArithmetic mode;
    auto image = is_exr(bytes) ? read_exr(bytes, file_name) : read_hdr(bytes, file_name);
    if (!image) return image.error();
    return Environment(*std::move(image));
}

Result<Environment> load_environment(const std::string& name) {
    if (name == k_built_in_environment)
        return read_environment(std::span(srbf_studio_begin, srbf_studio_end), "studio.hdr");
    return within_memory(name, [&]() -> Result<Environment> {
        const auto bytes = read_file(name, max_bytes_of);
        if (!bytes) return bytes.error();
        return read_environment(*bytes, name);
    });
}

}  // namespace
