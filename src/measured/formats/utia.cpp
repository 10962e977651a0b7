#include "base/errors.h"
#include "base/files.h"
#include "base/floating_point.h"
#include "base/printable.h"
#include "measured/angles.h"
#include "measured/bytes.h"
#include "measured/formats/format_rows.h"
#include "measured/readers.h"
#include "measured/samples.h"
#include "measured/tables.h"
#include "srbf/file.h"
#include "srbf/measured.h"

namespace SRBF_NAMESPACE {

namespace {

struct UtiaTable {
    static constexpr std::string_view k_name = "UTIA";
    static constexpr std::uint32_t k_polar = 6, k_azimuths = 48, k_directions = k_polar * k_azimuths;
    /// f_r [1/sr]; φ_v varies fastest, then θ_v, φ_l, θ_l; negative channels not yet clamped. NaN: not measured
    std::vector<Rgb> cells;
    std::uint64_t masked = 0;  ///< cells without a measurement
};

constexpr std::size_t k_cells = std::size_t(UtiaTable::k_directions) * UtiaTable::k_directions;
constexpr std::size_t k_bytes = 3 * k_cells * sizeof(double);

/// The four nodes around a direction and their weights, which sum to 1. Beyond the last polar angle some are negative.
struct Corners {
    std::array<std::uint32_t, 4> node;
    std::array<float, 4> weight;
};

Corners corners(Vec3f w) {
    constexpr float polar_step = float(15 * k_degree), azimuth_step = float(7.5 * k_degree);
    constexpr std::uint32_t azimuths = UtiaTable::k_azimuths;
    const float t = polar_angle(w) / polar_step, phi = azimuth(w.y, w.x);
    const float p = (phi < 0 ? phi + float(2 * k_pi) : phi) / azimuth_step;
    const std::uint32_t i = std::min(std::uint32_t(t), UtiaTable::k_polar - 2);
    const std::uint32_t j = std::min(std::uint32_t(p), azimuths - 1), next = j + 1 == azimuths ? 0 : j + 1;
    const float t_i = t - float(i), t_j = std::min(p - float(j), 1.0f);
    return {{i * azimuths + j, i * azimuths + next, (i + 1) * azimuths + j, (i + 1) * azimuths + next},
            {(1 - t_i) * (1 - t_j), (1 - t_i) * t_j, t_i * (1 - t_j), t_i * t_j}};
}

Rgb signed_value(const UtiaTable& table, Vec3f wl, Vec3f wv) {
    if (!above_horizon(wl, wv)) return {};
    const Corners light = corners(wl), view = corners(wv);
    Rgb f;
    for (std::size_t l = 0; l < 4; ++l)
        for (std::size_t v = 0; v < 4; ++v) {
            const float weight = light.weight[l] * view.weight[v];
            const Rgb& cell = table.cells[std::size_t(light.node[l]) * UtiaTable::k_directions + view.node[v]];
            for (int c = 0; c < 3; ++c) f[c] += weight * cell[c];
        }
    for (int c = 0; c < 3; ++c) f[c] = std::min(f[c], k_max_float);
    return f;
}

bool is_isotropic(const UtiaTable&) { return false; }

std::vector<TableLine> lines_about(const UtiaTable& table) {
    return {{"dimensions", fmt::format("{0} θl × {1} φl × {0} θv × {1} φv", UtiaTable::k_polar, UtiaTable::k_azimuths)},
            {"masked entries", fmt::format("{} of {}", grouped(table.masked), grouped(table.cells.size()))},
            {"value [1/sr]", {}, table.cells}};
}

bool is_utia(std::span<const std::byte> bytes) { return bytes.size() == k_bytes && !is_safetensors(bytes); }

}  // namespace

Result<EvaluatedTable> read_utia(std::span<const std::byte> bytes, const std::string& file_name) {
    const StandardArithmetic mode;
    if (bytes.size() != k_bytes)
        return input_error(file_name, "size of a UTIA table", fmt::format("{} bytes", k_bytes),
                           fmt::format("{} bytes", bytes.size()));
    UtiaTable table;
    table.cells.resize(k_cells);
    for (std::size_t i = 0; i < k_cells; ++i)
        for (std::size_t c = 0; c < 3; ++c)
            table.cells[i][int(c)] = float(load<double>(&bytes[(c * k_cells + i) * sizeof(double)]));
    mask_missing({&table.cells[0].r, 3 * k_cells}, 3);
    for (Rgb& f : table.cells) {
        if (std::max({std::abs(f.r), std::abs(f.g), std::abs(f.b)}) <= k_largest_value && is_finite(f)) continue;
        f = {k_nan, k_nan, k_nan};
        ++table.masked;
    }
    if (table.masked == k_cells) return Error{file_name, 0, "UTIA cells", "at least one that is finite", "none"};
    return evaluated_table(std::make_shared<const UtiaTable>(std::move(table)));
}

const Format k_utia_format{.name = "UTIA",
                           .recognise = is_utia,
                           .read = read_by<read_utia>,
                           .size = [](std::span<const std::byte>) -> std::uint64_t { return k_bytes; }};

}  // namespace
