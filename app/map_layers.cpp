#include "app/map_layers.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "base/half.h"
#include "brdf/colour.h"

namespace srbf {
namespace {

/// The bytes of a KTX 2 file; numbers are in little-endian order.
class KtxBytes {
  public:
    void add(std::uint64_t number, std::size_t count) {
        for (std::size_t i = 0; i < count; ++i, number >>= 8) bytes.push_back(std::byte(number & 0xff));
    }
    void add_words(std::span<const std::uint32_t> words) {
        for (const std::uint32_t word : words) add(word, 4);
    }
    /// A key, terminated by a zero byte, and its value.
    void add_metadata(std::string_view key, std::span<const std::byte> value) {
        add(key.size() + 1 + value.size(), 4);
        for (const char c : key) add(std::uint8_t(c), 1);
        add(0, 1);
        bytes.insert(bytes.end(), value.begin(), value.end());
        align(4);
    }
    /// A text, terminated by a zero byte too.
    void add_metadata(std::string_view key, const char* text) {
        add_metadata(key, std::as_bytes(std::span(text, std::string_view(text).size() + 1)));
    }
    void align(std::size_t multiple) { bytes.resize((bytes.size() + multiple - 1) / multiple * multiple); }
    void set(std::size_t offset, std::uint64_t number, std::size_t count) {
        for (std::size_t i = 0; i < count; ++i, number >>= 8) bytes[offset + i] = std::byte(number & 0xff);
    }

    std::vector<std::byte> bytes;
};

/// A texel of four equal numbers, in the terms of KTX 2 and of the Khronos Data Format 1.3, section 5.
struct TexelFormat {
    std::uint32_t vulkan;       ///< VkFormat
    std::uint32_t number_size;  ///< bytes of a number
    std::uint32_t transfer;     ///< 1: linear, 2: sRGB
    std::uint32_t rgb, alpha;   ///< channels with their flags
    std::uint32_t min, max;     ///< the numbers for 0 or -1, and for 1
};
/// R16G16B16A16_SFLOAT, of signed floats; R8G8B8A8_SRGB, with linear A.
constexpr TexelFormat k_halves{97, 2, 1, 0xc0, 0xcf, 0xbf800000, 0x3f800000}, k_bytes{43, 1, 2, 0, 0x1f, 0, 255};

std::vector<std::uint32_t> descriptor(const TexelFormat& format) {
    constexpr std::uint32_t rgba = 1, rec709 = 1, version = 2, block = 24 + 16 * 4;
    std::vector<std::uint32_t> words{
        4 + block, 0, version | block << 16, rgba | rec709 << 8 | format.transfer << 16, 0, 4 * format.number_size, 0};
    for (std::uint32_t c = 0; c < 4; ++c) {
        const std::uint32_t bits = 8 * format.number_size, channel = c < 3 ? format.rgb | c : format.alpha;
        words.insert(words.end(), {c * bits | (bits - 1) << 16 | channel << 24, 0, format.min, format.max});
    }
    return words;
}

/// The byte whose value in sRGB is nearest to a number in [0, 1].
class NearestSrgb {
  public:
    NearestSrgb() {
        for (int k = 0; k < 255; ++k)
            middle_[std::size_t(k)] = float((srgb_decoded(k / 255.0) + srgb_decoded((k + 1) / 255.0)) / 2);
    }
    std::uint64_t operator()(float x) const {
        return std::uint64_t(std::ranges::upper_bound(middle_, x) - middle_.begin());
    }

  private:
    std::array<float, 255> middle_;  ///< between a value and the next
};

/// Adds a layer, the coefficients of lobe j, as R, G, B and A = 1 in bytes with a scale.
void add_layer(KtxBytes& file, const MapLevel& level, std::size_t j, std::size_t J, const Rgb& scale) {
    static const NearestSrgb nearest;
    for (std::size_t i = j; i < level.coefficient.size(); i += J) {
        for (int c = 0; c < 3; ++c) file.add(scale[c] > 0 ? nearest(level.coefficient[i][c] / scale[c]) : 0, 1);
        file.add(255, 1);
    }
}

/// Adds all layers of a level.
void add_level(KtxBytes& file, const MapLevel& level, LayerNumbers numbers, const std::vector<Rgb>& scales) {
    if (numbers == LayerNumbers::halves)
        for (const std::uint16_t half : layers_in_halves(level)) file.add(half, 2);
    else
        for (std::size_t j = 0; j < scales.size(); ++j) add_layer(file, level, j, scales.size(), scales[j]);
}

}  // namespace

MapLevel coarser(const MapLevel& finer) {
    const std::size_t J = finer.coefficient.size() / (finer.width * finer.height);
    MapLevel level{std::max<std::size_t>(finer.width / 2, 1), std::max<std::size_t>(finer.height / 2, 1), {}};
    level.coefficient.resize(level.width * level.height * J);
    // Texel k of n covers [k m, (k + 1) m) and overlaps texel i of m, which covers [i n, (i + 1) n).
    const auto visit_overlaps = [](std::size_t i, std::size_t n, std::size_t m, const auto& visit) {
        for (std::size_t k = i * n / m; k * m < (i + 1) * n; ++k)
            visit(k, float(std::min((k + 1) * m, (i + 1) * n) - std::max(k * m, i * n)) / float(n));
    };
    for (std::size_t y = 0; y < level.height; ++y)
        for (std::size_t x = 0; x < level.width; ++x) {
            Rgb* const target = &level.coefficient[(y * level.width + x) * J];
            visit_overlaps(y, finer.height, level.height, [&](std::size_t row, float row_weight) {
                visit_overlaps(x, finer.width, level.width, [&](std::size_t column, float column_weight) {
                    const Rgb* const source = &finer.coefficient[(row * finer.width + column) * J];
                    for (std::size_t j = 0; j < J; ++j)
                        for (int c = 0; c < 3; ++c) target[j][c] += row_weight * column_weight * source[j][c];
                });
            });
        }
    return level;
}

std::vector<MapLevel> mip_levels(const TexelMap& map) {
    std::vector<MapLevel> levels{{map.width, map.height(), map.coefficient}};
    while (levels.back().width * levels.back().height > 1) levels.push_back(coarser(levels.back()));
    return levels;
}

Result<Done> check_layers(const TexelMap& map, const std::string& file_name) {
    const auto refused = [&](const char* what, std::string expected, std::string found) {
        return Error{file_name, {}, what, std::move(expected), std::move(found), ErrorCode::argument};
    };
    if (map.basis.lobes > k_max_layers)
        return refused("lobes", fmt::format("at most {}", k_max_layers), fmt::format("{}", map.basis.lobes));
    if (const std::size_t longest = std::max(map.width, map.height()); longest > k_longest_side)
        return refused("texels of a side", fmt::format("at most {} (srbf map --width)", k_longest_side),
                       fmt::format("{}", longest));
    for (const Rgb& coefficient : map.coefficient)
        if (const float largest = std::max({coefficient.r, coefficient.g, coefficient.b}); largest > k_half_max)
            return refused("coefficient", fmt::format("at most {:g}, the largest 16-bit float", k_half_max),
                           fmt::format("{:g}", largest));
    return Done{};
}

std::vector<std::uint16_t> layers_in_halves(const MapLevel& level) {
    const std::size_t J = level.coefficient.size() / (level.width * level.height);
    std::vector<std::uint16_t> halves;
    halves.reserve(4 * level.coefficient.size());
    for (std::size_t j = 0; j < J; ++j)
        for (std::size_t i = j; i < level.coefficient.size(); i += J) {
            const auto& [r, g, b] = level.coefficient[i];
            for (const float number : {r, g, b, 1.f}) halves.push_back(to_half(number));
        }
    return halves;
}

std::vector<Rgb> layer_scales(const TexelMap& map) {
    std::vector<Rgb> scales(std::size_t(map.basis.lobes));
    for (std::size_t i = 0; i < map.coefficient.size(); ++i)
        for (int c = 0; c < 3; ++c) {
            float& largest = scales[i % scales.size()][c];
            largest = std::max(largest, map.coefficient[i][c]);
        }
    return scales;
}

std::vector<std::byte> map_ktx2(const TexelMap& map, LayerNumbers numbers) {
    constexpr std::array<std::uint8_t, 12> identifier{0xab, 'K', 'T', 'X', ' ', '2', '0', 0xbb, '\r', '\n', 0x1a, '\n'};
    constexpr std::size_t index = 48, levels_offset = 80, bytes_of_level = 24, faces = 1;
    const TexelFormat& format = numbers == LayerNumbers::halves ? k_halves : k_bytes;
    const std::vector<MapLevel> levels = mip_levels(map);
    const auto J = std::size_t(map.basis.lobes);
    const std::vector<Rgb> scales = layer_scales(map);
    KtxBytes file;
    for (const std::uint8_t byte : identifier) file.add(byte, 1);
    for (const std::size_t number : {std::size_t(format.vulkan), std::size_t(format.number_size), levels[0].width,
                                     levels[0].height, std::size_t(0), J, faces, levels.size(), std::size_t(0)})
        file.add(number, 4);
    file.bytes.resize(levels_offset + bytes_of_level * levels.size());
    const auto add_part = [&](std::size_t offset, const auto& write) {
        const std::size_t begin = file.bytes.size();
        write();
        file.set(index + offset, begin, 4);
        file.set(index + offset + 4, file.bytes.size() - begin, 4);
    };
    add_part(0, [&] { file.add_words(descriptor(format)); });
    add_part(8, [&] {
        file.add_metadata("KTXorientation", "rd");
        file.add_metadata("KTXwriter", "srbf");
        if (numbers != LayerNumbers::halves) file.add_metadata(k_scale_key, std::as_bytes(std::span(scales)));
    });
    const std::size_t texel_size = 4 * format.number_size;
    file.align(texel_size);
    for (std::size_t k = levels.size(); k-- > 0;) {  // the smallest level comes first
        const std::size_t begin = file.bytes.size(), size = J * levels[k].width * levels[k].height * texel_size;
        for (const std::size_t member : {0, 1, 2})
            file.set(levels_offset + bytes_of_level * k + 8 * member, member == 0 ? begin : size, 8);
        file.bytes.reserve(begin + size);
        add_level(file, levels[k], numbers, scales);
    }
    return std::move(file.bytes);
}

}  // namespace srbf
