#include "base/floating_point.h"
#include "base/text.h"
#include "measured/angles.h"
#include "measured/bytes.h"
#include "measured/formats/format_rows.h"
#include "measured/readers.h"
#include "measured/samples.h"
#include "measured/tables.h"
#include "srbf/measured.h"

namespace SRBF_NAMESPACE {

namespace {

constexpr std::string_view k_any_version = "NVIDIA ARC MBSDF V";
constexpr std::size_t k_max_entries = 1024;  ///< bound on the lines of the header

struct Cursor {
    std::string_view text;
    std::string file_name;
    std::size_t position = 0;

    bool is_at_end() const { return position == text.size(); }
    Error error(std::size_t offset, std::string what, std::string expected, std::string found) const {
        return {file_name, offset, std::move(what), std::move(expected), std::move(found)};
    }
    /// Reads a line, without its end; no value if the file ends first.
    std::optional<std::string_view> next_line() {
        const std::size_t end = text.find('\n', position);
        if (end == text.npos) return {};
        const std::string_view line = text.substr(position, end - position);
        position = end + 1;
        return line;
    }
};

/// Parses a line key="value" that begins at `begin`.
Result<MbsdfTable::Entry> parse_entry(const Cursor& file, std::string_view line, std::size_t begin) {
    constexpr const char *what = "MBSDF header", *form = "a line key=\"value\" or the head of a block";
    const std::size_t sign = line.find('=');
    if (sign == line.npos || sign == 0 || line.substr(sign + 1, 1) != "\"")
        return file.error(begin, what, form, quoted(line));
    if (const auto control = std::ranges::find_if(line, is_control); control != line.end())
        return file.error(begin + std::size_t(control - line.begin()), what, "printable characters",
                          fmt::format("the byte {:02x}", static_cast<unsigned char>(*control)));
    MbsdfTable::Entry entry{std::string(line.substr(0, sign)), {}};
    for (std::size_t i = sign + 2; i < line.size(); ++i) {
        if (line[i] == '"') {
            if (i + 1 == line.size()) return entry;
            return file.error(begin + i + 1, what, "the end of the line after the value", quoted(line.substr(i + 1)));
        }
        if (line[i] == '\\') {
            const char escaped = ++i < line.size() ? line[i] : ' ';
            if (escaped != 'n' && escaped != '"' && escaped != '\\')
                return file.error(begin + i - 1, what, "one of \\n, \\\" and \\\\", quoted(line.substr(i - 1, 2)));
            entry.value += escaped == 'n' ? '\n' : escaped;
        } else {
            entry.value += line[i];
        }
    }
    return file.error(begin + line.size(), what, "a quotation mark that ends the value", "the end of the line");
}

/// Reads the description that follows a block's head, and its numbers.
Result<MbsdfTable> read_block(Cursor& file) {
    const std::size_t begin = file.position, left = file.text.size() - begin;
    constexpr std::size_t size = 3 * sizeof(std::uint32_t);
    if (left < size)
        return file.error(begin, "MBSDF block", "type and numbers of angles in 12 bytes",
                          fmt::format("the end of the file after {}", left));
    const auto* bytes = reinterpret_cast<const std::byte*>(file.text.data()) + begin;
    const auto type = load<std::uint32_t>(bytes);
    if (type > 1) return file.error(begin, "type of an MBSDF block", "0 (grey) or 1 (RGB)", fmt::format("{}", type));
    MbsdfTable table;
    table.grey = type == 0;
    table.polar = load<std::uint32_t>(bytes + 4), table.azimuths = load<std::uint32_t>(bytes + 8);
    const auto in_range = [](std::uint32_t n) { return 1 <= n && n <= k_largest_dimension; };
    const std::string dimensions = fmt::format("{0} x {0} x {1}", table.polar, table.azimuths);
    if (!in_range(table.polar) || !in_range(table.azimuths))
        return file.error(begin + 4, "dimensions of an MBSDF block",
                          fmt::format("each between 1 and {}", k_largest_dimension), dimensions);
    const std::size_t channels = table.grey ? 1 : 3;
    const std::uint64_t samples = std::uint64_t(table.polar) * table.polar * table.azimuths,
                        needed = samples * channels * sizeof(float);
    if (needed > left - size)
        return file.error(begin + size, fmt::format("MBSDF block of {} x {} numbers", dimensions, channels),
                          fmt::format("{} bytes", needed), fmt::format("{} bytes", left - size));
    file.position += size + std::size_t(needed);
    table.cells.resize(std::size_t(samples));
    for (std::size_t i = 0; i < table.cells.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c)
            table.cells[i][int(c)] = load<float>(bytes + size + (i * channels + c % channels) * sizeof(float));
    mask_missing({&table.cells[0].r, 3 * table.cells.size()}, 3);
    for (Rgb& f : table.cells) {
        if (is_finite(f)) continue;
        f = {k_nan, k_nan, k_nan};
        ++table.masked;
    }
    if (table.masked == samples)
        return file.error(begin + size, "MBSDF samples", "at least one that is finite", "none");
    return table;
}

/// The nodes on either side of a position in units of nodes. Positions beyond the last node count as that node.
struct AngleNodes {
    std::size_t first, second;
    float fraction;
};
AngleNodes angle_nodes(float position, std::uint32_t n) {
    const float clamped = std::min(position, float(n - 1));
    const auto i = std::uint32_t(clamped);
    return {i, std::min(i + 1, n - 1), clamped - float(i)};
}

/// Reads the block of reflection, and the block of transmission if there is one.
Result<std::vector<MbsdfTable>> read_blocks(std::span<const std::byte> bytes, const std::string& file_name) {
    const StandardArithmetic mode;
    Cursor file{as_text(bytes), file_name};
    const auto magic = file.next_line();
    if (!magic || *magic != k_mbsdf_magic)
        return file.error(0, "MBSDF file", fmt::format("the line '{}'", k_mbsdf_magic),
                          quoted(magic.value_or(file.text)));
    std::vector<MbsdfTable::Entry> metadata;
    for (;;) {
        const std::size_t begin = file.position;
        const auto line = file.next_line();
        if (!line)
            return file.error(begin, "MBSDF header", fmt::format("a block, headed {}", k_mbsdf_reflection),
                              "the end of the file");
        if (*line == k_mbsdf_reflection || *line == k_mbsdf_data) break;
        if (*line == k_mbsdf_transmission)
            return file.error(begin, "MBSDF file", "a block of reflection", "transmission alone");
        if (metadata.size() == k_max_entries)
            return file.error(begin, "MBSDF header", fmt::format("at most {} lines key=\"value\"", k_max_entries),
                              "more");
        auto entry = parse_entry(file, *line, begin);
        if (!entry) return entry.error();
        metadata.push_back(*std::move(entry));
    }
    std::vector<MbsdfTable> blocks;
    for (const char* name : {"reflection", "transmission"}) {
        auto block = read_block(file);
        if (!block) return block.error();
        blocks.push_back(*std::move(block));
        const std::size_t begin = file.position;
        if (file.is_at_end()) break;
        const bool may_follow = blocks.size() == 1;
        if (may_follow && file.next_line() == k_mbsdf_transmission) continue;
        return file.error(
            begin, fmt::format("after the MBSDF block of {}", name),
            may_follow ? fmt::format("the end of the file, or {}", k_mbsdf_transmission) : "the end of the file",
            fmt::format("{} bytes", file.text.size() - begin));
    }
    blocks[0].metadata = std::move(metadata);
    return blocks;
}

bool is_mbsdf(std::span<const std::byte> bytes) { return as_text(bytes).starts_with(k_any_version); }

/// Reads both blocks, as reflection and transmission of light from the front; the reflection alone if there is no
/// other.
Result<Measured> read_any_mbsdf(std::span<const std::byte> bytes, const std::string& file_name, const ReadOptions&) {
    auto blocks = read_blocks(bytes, file_name);
    if (!blocks) return blocks.error();
    if (blocks->size() == 1) return Measured{{}, {}, 0, std::move((*blocks)[0])};
    BsdfTable table{{{}}, 0, {}};
    const auto part = [&](MbsdfTable&& block) {
        return std::make_shared<const Measured>(Measured{file_name, "MBSDF", 0, std::move(block)});
    };
    table.bands[0].part[std::size_t(Part::reflection_front)] = part(std::move((*blocks)[0]));
    table.bands[0].part[std::size_t(Part::transmission_front)] = part(std::move((*blocks)[1]));
    return Measured{{}, {}, 0, std::move(table)};
}

}  // namespace

Result<MbsdfTable> read_mbsdf(std::span<const std::byte> bytes, const std::string& file_name) {
    auto blocks = read_blocks(bytes, file_name);
    if (!blocks) return blocks.error();
    return std::move((*blocks)[0]);
}

Rgb signed_value(const MbsdfTable& table, Vec3f wl, Vec3f wv) {
    if (!above_horizon(wl, wv)) return {};
    const auto step = float(k_pi / 2 / table.polar), turn = float(k_pi / std::max(table.azimuths - 1, 1u));
    const float phi = azimuth(std::abs(wl.x * wv.y - wl.y * wv.x), wl.x * wv.x + wl.y * wv.y);
    const AngleNodes l = angle_nodes(polar_angle(wl) / step, table.polar),
                     v = angle_nodes(polar_angle(wv) / step, table.polar), p = angle_nodes(phi / turn, table.azimuths);
    Rgb sum;
    const auto add_row = [&](std::size_t i, std::size_t j, float weight) {
        const Rgb* const row = &table.cells[(i * table.polar + j) * table.azimuths];
        for (int c = 0; c < 3; ++c)
            sum[c] += weight * ((1 - p.fraction) * row[p.first][c] + p.fraction * row[p.second][c]);
    };
    add_row(l.first, v.first, (1 - l.fraction) * (1 - v.fraction));
    add_row(l.first, v.second, (1 - l.fraction) * v.fraction);
    add_row(l.second, v.first, l.fraction * (1 - v.fraction));
    add_row(l.second, v.second, l.fraction * v.fraction);
    // The mean may be rounded beyond the largest float. NaN remains.
    for (int c = 0; c < 3; ++c) sum[c] = std::clamp(sum[c], -k_max_float, k_max_float);
    return sum;
}

const Format k_mbsdf_format{.name = "MBSDF",
                            .recognise = is_mbsdf,
                            .read = read_any_mbsdf,
                            .extension = ".mbsdf",
                            .used_by = "MDL",
                            .write = write_as_mbsdf};

}  // namespace
