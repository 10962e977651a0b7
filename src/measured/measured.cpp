#include "srbf/measured.h"

#include <fmt/format.h>

#include <algorithm>

#include "measured/bytes.h"
#include "srbf/file.h"

namespace srbf {

namespace {

/// "01 02 0a ..": the first bytes of a file, for a reader of the error who knows the format.
std::string opening(std::span<const std::byte> bytes) {
    if (bytes.empty()) return "an empty file";
    std::string text = fmt::format("{} bytes that begin with", bytes.size());
    for (const std::byte b : bytes.first(std::min<std::size_t>(bytes.size(), 12)))
        text += fmt::format(" {:02x}", std::to_integer<unsigned>(b));
    return text;
}

template <typename Table>
Result<Measured> labelled(Result<Table> table, const std::string& source, std::string format, std::size_t bytes) {
    if (!table) return table.error();
    return Measured{source, std::move(format), bytes, *std::move(table)};
}

}  // namespace

Result<Measured> read_measured(std::span<const std::byte> bytes, const std::string& source) {
    if (is_rgl(bytes)) return labelled(read_rgl(bytes, source), source, "RGL", bytes.size());
    if (is_merl(bytes)) return labelled(read_merl(bytes, source), source, "MERL", bytes.size());
    return Error{source, {}, "unknown format", "a MERL table (.binary) or an RGL measurement (.bsdf)", opening(bytes)};
}

Result<Measured> load_measured(const std::string& path) {
    const auto bytes = read_file(path);
    if (!bytes) return bytes.error();
    return read_measured(*bytes, path);
}

Rgb value(const Measured& measured, Vec3f wl, Vec3f wv) {
    return std::visit([&](const auto& table) { return value(table, wl, wv); }, measured.table);
}

Rgb signed_value(const Measured& measured, Vec3f wl, Vec3f wv) {
    return std::visit([&](const auto& table) { return signed_value(table, wl, wv); }, measured.table);
}

Evaluate signed_evaluator(const Measured& measured) {
    return [&measured](auto wl, auto wv, auto f) {
        for (std::size_t i = 0; i < wl.size(); ++i) f[i] = signed_value(measured, wl[i], wv[i]);
    };
}

}  // namespace srbf
