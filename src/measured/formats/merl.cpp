#include <fmt/format.h>

#include "base/floating_point.h"
#include "measured/angles.h"
#include "measured/bytes.h"
#include "measured/formats/format_rows.h"
#include "measured/readers.h"
#include "measured/tables.h"
#include "srbf/measured.h"

namespace SRBF_NAMESPACE {

namespace {

constexpr std::size_t k_header = 3 * sizeof(std::int32_t);

using Dimensions = std::array<std::int32_t, 3>;

Dimensions dimensions(std::span<const std::byte> bytes) {
    return {load<std::int32_t>(&bytes[0]), load<std::int32_t>(&bytes[4]), load<std::int32_t>(&bytes[8])};
}

bool in_range(const Dimensions& n) {
    return std::ranges::all_of(n, [](std::int32_t i) { return 1 <= i && i <= std::int32_t(k_largest_dimension); });
}

/// The size of a file with these dimensions, at most 2⁴¹ bytes.
std::uint64_t file_size(const Dimensions& n) {
    return k_header + std::uint64_t(n[0]) * std::uint64_t(n[1]) * std::uint64_t(n[2]) * 3 * sizeof(double);
}

bool is_merl(std::span<const std::byte> bytes) {
    if (bytes.size() < k_header) return false;
    const Dimensions n = dimensions(bytes);
    return n == Dimensions{90, 90, 180} || (in_range(n) && file_size(n) == bytes.size());
}

std::uint64_t merl_bytes(std::span<const std::byte> head) {
    const bool has_header = head.size() >= k_header && in_range(dimensions(head));
    return has_header ? file_size(dimensions(head)) : 0;
}

}  // namespace

namespace scalar {
using Indices = std::size_t;
inline Indices index(float whole) { return Indices(whole); }
inline Indices scale(Indices i, std::size_t factor) { return i * factor; }
inline Indices added(Indices i, Indices j) { return i + j; }
inline float gather(const float* numbers, Indices i) { return numbers[i]; }
inline float floor(float x) { return float(Indices(x)); }  // of x ≥ 0
inline bool is_number(float x) { return x == x; }
#include "measured/merl.inl"
}  // namespace scalar

Result<MerlTable> read_merl(std::span<const std::byte> bytes, const std::string& file_name) {
    const StandardArithmetic mode;
    if (bytes.size() < k_header)
        return Error{file_name, bytes.size(), "MERL header", "3 dimensions in 12 bytes", "the end of the file"};
    const Dimensions n = dimensions(bytes);
    if (!in_range(n))
        return Error{file_name, 0, "MERL dimensions", fmt::format("each between 1 and {}", k_largest_dimension),
                     fmt::format("{} x {} x {}", n[0], n[1], n[2])};
    if (bytes.size() != file_size(n))
        return Error{file_name, k_header, fmt::format("size of a MERL table of {} x {} x {}", n[0], n[1], n[2]),
                     fmt::format("{} bytes", file_size(n)), fmt::format("{} bytes", bytes.size())};

    MerlTable table;
    for (std::size_t i = 0; i < 3; ++i) table.size[i] = std::uint32_t(n[i]);
    const std::size_t count = (bytes.size() - k_header) / (3 * sizeof(double));
    table.cells.resize(count);
    const std::byte* const plane = bytes.data() + k_header;
    for (std::size_t i = 0; i < count; ++i) {
        Rgb& f = table.cells[i];
        for (std::size_t c = 0; c < 3; ++c)
            f[int(c)] = float(k_merl_channel_scale[c] * load<double>(plane + (c * count + i) * sizeof(double)));
        if (is_finite(f) && f.r >= 0 && f.g >= 0 && f.b >= 0) continue;
        f = {k_nan, k_nan, k_nan};
        ++table.masked;
    }
    if (table.masked == count)
        return Error{file_name, k_header, "MERL cells", "at least one measured (finite and not negative)", "none"};
    return table;
}

Rgb signed_value(const MerlTable& table, Vec3f wl, Vec3f wv) {
    if (!above_horizon(wl, wv)) return {};
    const Vec3f f = scalar::merl_value(table, wl, wv);
    return {f.x, f.y, f.z};
}

const Format k_merl_format{.name = "MERL",
                           .recognise = is_merl,
                           .read = read_by<read_merl>,
                           .size = merl_bytes,
                           .extension = ".binary",
                           .used_by = "MERL",
                           .one_sided = true,
                           .write = write_as_merl};

}  // namespace
