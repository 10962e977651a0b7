#include <fmt/format.h>

#include "base/floating_point.h"
#include "measured/angles.h"
#include "measured/bytes.h"
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

/// The position of a pair in units of nodes: h in [0, n_h − 1], d in [0, n_d − 1], p in [0, n_p].
struct Position {
    float h, d, p;
};

/// With h = ωl + ωv and d = ωl − ωv, which are orthogonal:
///   tan θ_h = √(h_x² + h_y²) / h_z,  tan θ_d = |d| / |h|,
///   tan φ_d = |h| (h_x d_y − h_y d_x) / (h_z (h_x d_x + h_y d_y) − (h_x² + h_y²) d_z).
/// For close directions d is exact, so that the angles are accurate where an arc cosine of a dot product would lose
/// half of its digits. φ_d is 0 if it is undefined (h along the normal, or ωl = ωv), under every rotation about the
/// normal.
Position position(const MerlTable& table, Vec3f wl, Vec3f wv) {
    const Vec3f h = wl + wv, d = wl - wv;
    const float planar2 = h.x * h.x + h.y * h.y, length = std::sqrt(planar2 + h.z * h.z);
    const float theta_h = polar_angle(planar2, h.z), theta_d = polar_angle(dot(d, d), length);
    const float y_d = length * (h.x * d.y - h.y * d.x);
    const float x_d = h.z * (h.x * d.x + h.y * d.y) - planar2 * d.z;
    // Exchanging ωl and ωv negates x_d and y_d. Negating both if y_d is negative reduces φ_d modulo π.
    const bool is_negative = y_d < 0 || (y_d == 0 && x_d < 0);
    const float phi_d = azimuth(std::abs(y_d), is_negative ? -x_d : x_d);

    const auto [n_h, n_d, n_p] = table.size;
    const float right_angle = float(k_pi / 2);
    return {std::min(float(n_h - 1), float(n_h) * std::sqrt(theta_h / right_angle)),
            std::min(float(n_d - 1), float(n_d) * (theta_d / right_angle)),
            std::min(float(n_p), float(n_p) * (phi_d / float(k_pi)))};
}

const Rgb& cell(const MerlTable& table, std::uint32_t h, std::uint32_t d, std::uint32_t p) {
    return table.cells[p + table.size[2] * (d + std::size_t(table.size[1]) * h)];
}

}  // namespace

bool is_merl(std::span<const std::byte> bytes) {
    if (bytes.size() < k_header) return false;
    const Dimensions n = dimensions(bytes);
    return n == Dimensions{90, 90, 180} || (in_range(n) && file_size(n) == bytes.size());
}

std::uint64_t merl_bytes(std::span<const std::byte> head) {
    const bool has_header = head.size() >= k_header && in_range(dimensions(head));
    return has_header ? file_size(dimensions(head)) : 0;
}

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
    const Position x = position(table, wl, wv);
    const auto [n_h, n_d, n_p] = table.size;
    const auto h = std::uint32_t(x.h), d = std::uint32_t(x.d);
    const auto p = std::min(std::uint32_t(x.p), n_p - 1);
    const float t_h = x.h - float(h), t_d = x.d - float(d), t_p = x.p - float(p);
    const std::uint32_t next_h = std::min(h + 1, n_h - 1), next_d = std::min(d + 1, n_d - 1),
                        next_p = p + 1 == n_p ? 0 : p + 1;

    Rgb sum;
    float weight = 0;
    const auto add = [&](const Rgb& f, float w) {
        const bool valid = f.r == f.r;
        weight += valid ? w : 0;
        sum.r += valid ? w * f.r : 0;
        sum.g += valid ? w * f.g : 0;
        sum.b += valid ? w * f.b : 0;
    };
    const auto add_line = [&](std::uint32_t i, std::uint32_t j, float w) {
        add(cell(table, i, j, p), w * (1 - t_p));
        add(cell(table, i, j, next_p), w * t_p);
    };
    add_line(h, d, (1 - t_h) * (1 - t_d));
    add_line(h, next_d, (1 - t_h) * t_d);
    add_line(next_h, d, t_h * (1 - t_d));
    add_line(next_h, next_d, t_h * t_d);
    if (!(weight > 0)) return {k_nan, k_nan, k_nan};
    // The mean may be rounded beyond the largest float.
    return {std::min(sum.r / weight, k_most_float), std::min(sum.g / weight, k_most_float),
            std::min(sum.b / weight, k_most_float)};
}

Rgb nearest(const MerlTable& table, Vec3f wl, Vec3f wv) {
    if (!above_horizon(wl, wv)) return {};
    const Position x = position(table, wl, wv);
    return cell(table, std::uint32_t(x.h + 0.5f), std::uint32_t(x.d + 0.5f), std::uint32_t(x.p + 0.5f) % table.size[2]);
}

}  // namespace srbf
