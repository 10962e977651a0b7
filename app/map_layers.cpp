#include "app/map_layers.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "base/half.h"

namespace srbf {
namespace {

/// The levels of a map, down to 1 × 1.
std::vector<MapLevel> mip_levels(const Library& map) {
    const auto width = std::size_t(map.width);
    std::vector<MapLevel> levels{{width, map.count() / width, map.coefficient}};
    while (levels.back().width * levels.back().height > 1) levels.push_back(coarser(levels.back()));
    return levels;
}

class Container {
  public:
    void add(std::uint64_t number, std::size_t count) {
        for (std::size_t i = 0; i < count; ++i, number >>= 8) bytes.push_back(std::byte(number & 0xff));
    }
    void add_words(std::span<const std::uint32_t> words) {
        for (const std::uint32_t word : words) add(word, 4);
    }
    /// A key and its value, each terminated by a zero byte.
    void add_metadata(std::string_view key, std::string_view text) {
        add(key.size() + text.size() + 2, 4);
        for (const std::string_view part : {key, text}) {
            for (const char c : part) add(std::uint8_t(c), 1);
            add(0, 1);
        }
        align(4);
    }
    void align(std::size_t multiple) { bytes.resize((bytes.size() + multiple - 1) / multiple * multiple); }
    void set(std::size_t offset, std::uint64_t number, std::size_t count) {
        for (std::size_t i = 0; i < count; ++i, number >>= 8) bytes[offset + i] = std::byte(number & 0xff);
    }

    std::vector<std::byte> bytes;
};

/// The data format descriptor of a texel of four signed 16-bit floats (Khronos Data Format 1.3, section 5).
std::vector<std::uint32_t> format_of_halves() {
    constexpr std::uint32_t rgb_model = 1, rec709 = 1, linear = 1, version = 2, bytes_of_texel = 8;
    constexpr std::uint32_t is_float = 0x80, is_signed = 0x40, alpha = 15;
    constexpr std::uint32_t block = 24 + 4 * 16, minus_one = 0xbf800000, one = 0x3f800000;
    std::vector<std::uint32_t> words{
        4 + block, 0, version | block << 16, rgb_model | rec709 << 8 | linear << 16, 0, bytes_of_texel, 0};
    for (std::uint32_t c = 0; c < 4; ++c) {
        const std::uint32_t channel = (c < 3 ? c : alpha) | is_float | is_signed;
        words.insert(words.end(), {16 * c | 15 << 16 | channel << 24, 0, minus_one, one});
    }
    return words;
}

}  // namespace

MapLevel coarser(const MapLevel& finer) {
    const std::size_t J = finer.coefficient.size() / (finer.width * finer.height);
    MapLevel level{std::max<std::size_t>(finer.width / 2, 1), std::max<std::size_t>(finer.height / 2, 1), {}};
    level.coefficient.resize(level.width * level.height * J);
    // Texel k of n covers [k m, (k + 1) m) and overlaps texel i of m, which covers [i n, (i + 1) n).
    const auto each = [](std::size_t i, std::size_t n, std::size_t m, const auto& visit) {
        for (std::size_t k = i * n / m; k * m < (i + 1) * n; ++k)
            visit(k, float(std::min((k + 1) * m, (i + 1) * n) - std::max(k * m, i * n)) / float(n));
    };
    for (std::size_t y = 0; y < level.height; ++y)
        for (std::size_t x = 0; x < level.width; ++x) {
            Rgb* const target = &level.coefficient[(y * level.width + x) * J];
            each(y, finer.height, level.height, [&](std::size_t row, float row_weight) {
                each(x, finer.width, level.width, [&](std::size_t column, float column_weight) {
                    const Rgb* const source = &finer.coefficient[(row * finer.width + column) * J];
                    for (std::size_t j = 0; j < J; ++j)
                        for (int c = 0; c < 3; ++c) target[j][c] += row_weight * column_weight * source[j][c];
                });
            });
        }
    return level;
}

Result<Done> check_layers(const Library& library, const std::string& file_name) {
    const auto refused = [&](const char* what, std::string expected, std::string found) {
        return Error{file_name, {}, what, std::move(expected), std::move(found), ErrorCode::argument};
    };
    if (!library.dense())
        return refused("library", "a coefficient for each lobe (srbf basis without --active)",
                       "some lobes of each material");
    if (library.width == 0) return refused("library", "a map (srbf map --width)", "materials without a map");
    if (library.basis.lobes > k_most_layers)
        return refused("lobes", fmt::format("at most {}", k_most_layers), fmt::format("{}", library.basis.lobes));
    for (const Rgb& coefficient : library.coefficient)
        if (const float largest = std::max({coefficient.r, coefficient.g, coefficient.b}); largest > k_half_max)
            return refused("coefficient", fmt::format("at most {:g}, the largest 16-bit float", k_half_max),
                           fmt::format("{:g}", largest));
    return Done{};
}

std::vector<std::byte> map_ktx2(const Library& map) {
    constexpr std::array<std::uint8_t, 12> identifier{0xab, 'K', 'T', 'X', ' ', '2', '0', 0xbb, '\r', '\n', 0x1a, '\n'};
    constexpr std::uint32_t halves = 97, bytes_of_half = 2, faces = 1;  // VK_FORMAT_R16G16B16A16_SFLOAT
    constexpr std::size_t index = 48, levels_offset = 80, bytes_of_level = 24, bytes_of_texel = 8;
    const std::vector<MapLevel> levels = mip_levels(map);
    const auto J = std::size_t(map.basis.lobes);
    Container file;
    for (const std::uint8_t byte : identifier) file.add(byte, 1);
    file.add_words(std::array{halves, bytes_of_half, std::uint32_t(levels[0].width), std::uint32_t(levels[0].height),
                              0u, std::uint32_t(J), faces, std::uint32_t(levels.size()), 0u});
    file.bytes.resize(levels_offset + bytes_of_level * levels.size());
    const auto add_part = [&](std::size_t offset, const auto& write) {
        const std::size_t begin = file.bytes.size();
        write();
        file.set(index + offset, begin, 4), file.set(index + offset + 4, file.bytes.size() - begin, 4);
    };
    add_part(0, [&] { file.add_words(format_of_halves()); });
    add_part(8, [&] { file.add_metadata("KTXorientation", "rd"), file.add_metadata("KTXwriter", "srbf"); });
    file.align(bytes_of_texel);
    for (std::size_t k = levels.size(); k-- > 0;) {  // the smallest level comes first
        const std::size_t texels = levels[k].width * levels[k].height, begin = file.bytes.size();
        const std::size_t size = J * texels * bytes_of_texel;
        for (const std::size_t member : {0, 1, 2})
            file.set(levels_offset + bytes_of_level * k + 8 * member, member == 0 ? begin : size, 8);
        file.bytes.reserve(begin + size);
        for (std::size_t j = 0; j < J; ++j)
            for (std::size_t t = 0; t < texels; ++t) {
                const Rgb& coefficient = levels[k].coefficient[t * J + j];
                for (const float number : {coefficient.r, coefficient.g, coefficient.b, 1.f})
                    file.add(to_half(number), 2);
            }
    }
    return std::move(file.bytes);
}

}  // namespace srbf
