#include "extras/maps/npy.h"

#include <fmt/format.h>

#include <bit>
#include <optional>

#include "base/text.h"

namespace SRBF_NAMESPACE {
namespace {

static_assert(std::endian::native == std::endian::little);

/// The text between `key` and the next of `ends`; no value if either is missing.
std::optional<std::string_view> text_after(std::string_view text, std::string_view key, std::string_view ends) {
    const auto begin = text.find(key);
    if (begin == text.npos) return {};
    const auto end = text.find_first_of(ends, begin + key.size());
    if (end == text.npos) return {};
    return text.substr(begin + key.size(), end - begin - key.size());
}

}  // namespace

Result<NpyHead> read_npy_head(std::span<const std::byte> beginning, std::uint64_t size, const std::string& file_name) {
    const auto fail = [&](std::uint64_t offset, std::string what, std::string expected, std::string found) {
        return Error{file_name, offset, std::move(what), std::move(expected), std::move(found)};
    };
    constexpr std::string_view magic = "\x93NUMPY";
    const std::string_view text(reinterpret_cast<const char*>(beginning.data()), beginning.size());
    if (!text.starts_with(magic)) return fail(0, "magic", "\\x93NUMPY, a .npy file", "something else");
    const auto byte = [&](std::size_t i) { return std::uint64_t(static_cast<unsigned char>(text[i])); };
    const std::uint64_t version = text.size() >= 12 ? byte(6) : 0;
    if (version < 1 || version > 3) return fail(6, "version", "1 to 3", fmt::format("{}", version));
    const std::uint64_t length =
        version == 1 ? byte(8) | byte(9) << 8 : byte(8) | byte(9) << 8 | byte(10) << 16 | byte(11) << 24;
    NpyHead head;
    head.data = (version == 1 ? 10 : 12) + length;
    if (head.data > text.size())
        return fail(8, "header length", fmt::format("at most {}", text.size()), fmt::format("{}", length));
    const std::string_view header = text.substr(0, std::size_t(head.data));
    const auto descr = text_after(header, "'descr': '", "'"), order = text_after(header, "'fortran_order': ", ",}"),
               shape = text_after(header, "'shape': (", ")");
    if (!descr || !order || !shape) return fail(10, "header", "descr, fortran_order and shape", "one is missing");
    if (*descr != "<f4") return fail(10, "descr", "<f4, float32", quoted(*descr));
    if (*order != "False") return fail(10, "fortran_order", "False", quoted(*order));
    std::uint64_t numbers = 1;
    for (std::string_view remaining = *shape; !remaining.empty();) {
        std::string_view word = remaining.substr(0, remaining.find(','));
        remaining.remove_prefix(std::min(word.size() + 1, remaining.size()));
        while (word.starts_with(' ')) word.remove_prefix(1);
        if (word.empty()) continue;
        const auto extent = to_number<std::uint64_t>(word);
        if (!extent || *extent == 0 || *extent > size / numbers)
            return fail(10, "shape", "counts of the numbers in the file", quoted(*shape));
        numbers *= *extent;
        head.shape.push_back(*extent);
    }
    if (size - head.data != 4 * numbers || size < head.data)
        return fail(head.data, "size", fmt::format("{} bytes", head.data + 4 * numbers), fmt::format("{}", size));
    return head;
}

}  // namespace
