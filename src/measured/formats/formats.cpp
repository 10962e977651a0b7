#include "measured/formats.h"

#include <fmt/ranges.h>

#include "base/errors.h"
#include "base/files.h"
#include "base/floating_point.h"
#include "generated/measured/extra_formats.h"
#include "measured/bytes.h"
#include "measured/formats/format_rows.h"
#include "measured/readers.h"
#include "measured/samples.h"
#include "srbf/file.h"

namespace SRBF_NAMESPACE {

namespace {

using Bytes = std::span<const std::byte>;

/// "A, B or C".
std::string join_words(const std::vector<std::string_view>& words) {
    return fmt::format("{} or {}", fmt::join(words.begin(), words.end() - 1, ", "), words.back());
}

bool recognises(const Format& format, Bytes head) {
    return (!format.is_text || is_text(head)) && format.recognise(head);
}

/// The first bytes in hexadecimal, by which a reader of the error may know the format.
std::string first_bytes(std::span<const std::byte> bytes) {
    if (bytes.empty()) return "an empty file";
    std::string text = "bytes that begin with";
    for (const std::byte b : bytes.first(std::min<std::size_t>(bytes.size(), 12)))
        text += fmt::format(" {:02x}", std::to_integer<unsigned>(b));
    return text;
}

/// Files of other kinds: their first bytes, a text near their beginning, and a message with the kind and a remedy.
constexpr std::string_view k_web_page = "a web page, not a file of data; download the file itself";
constexpr std::string_view k_other_files[][3] = {
    {"\xd0\xcf\x11\xe0", "", "an Excel workbook (.xls); save the sheet as CSV"},
    {"pk\x03\x04", "[content_types].xml", "an Excel workbook (.xlsx); save the sheet as CSV"},
    {"pk\x03\x04", "", "a ZIP archive; unpack it"},
    {"\x1f\x8b", "", "a file compressed by gzip; unpack it with gunzip"},
    {"<", "<html", k_web_page},
    {"<!doctype html", "", k_web_page},
    {"version https://git-lfs", "", "a pointer of Git LFS; get the file itself with git lfs pull"},
    {"\x93numpy", "", "an array of NumPy; use srbf.from_arrays in Python, or srbf map for texels"},
    {"#alta func header", "", "a function that ALTA fitted; take the measurement, or values by ALTA's brdf2data"}};

std::string_view other_file(std::span<const std::byte> bytes) {
    std::string head(as_text(bytes).substr(0, 4096));
    for (char& c : head) c = c >= 'A' && c <= 'Z' ? char(c + ('a' - 'A')) : c;
    head.erase(0, std::min(head.find_first_not_of(" \t\r\n\xef\xbb\xbf"), head.size()));
    for (const auto& [begins, has, what] : k_other_files)
        if (head.starts_with(begins) && head.find(has) != head.npos) return what;
    return {};
}

Result<Measured> read_unindexed(const Format& format, std::span<const std::byte> bytes, const std::string& file_name,
                                const ReadOptions& options) {
    auto measured = format.read(bytes, file_name, options);
    if (!measured) return measured;
    measured->source = file_name, measured->bytes = bytes.size();
    if (measured->format.empty()) measured->format = format.name;
    return measured;
}

/// Reads a measurement of any format, without the index of samples.
Result<Measured> read_unindexed(std::span<const std::byte> bytes, const std::string& file_name,
                                const ReadOptions& options) {
    if (const auto what = other_file(bytes); !what.empty())
        return Error{file_name, {}, "input", "a measurement", std::string(what)};
    if (const auto text = plain_text(bytes)) return read_unindexed(as_bytes(*text), file_name, options);
    if (!options.columns.empty()) {
        auto samples = read_csv(bytes, file_name, options);
        if (!samples) return samples.error();
        return Measured{file_name, "columns", bytes.size(), *std::move(samples)};
    }
    if (const Format* format = format_of(bytes)) return read_unindexed(*format, bytes, file_name, options);
    if (is_safetensors(bytes))
        return Error{file_name, {}, "input", "a measurement", "a fitted model", ErrorCode::wrong_kind};
    const bool may_be_rows = !bytes.empty() && is_text(bytes);
    return input_error(file_name, "unknown format",
                       names_of_formats() + (may_be_rows ? ", or --columns for rows of numbers" : ""),
                       first_bytes(bytes));
}

Result<Measured> build_index(Result<Measured> measured) {
    if (!measured) return measured;
    if (auto* samples = std::get_if<ScatteredSamples>(&measured->table)) make_index(*samples);
    return measured;
}

/// Masks values up to the floor, and converts values to f.
Result<Done> apply(const ReadOptions& options, ScatteredSamples& samples, const std::string& file_name) {
    const std::size_t channels = samples.wavelengths.size();
    if (options.floor > 0)
        keep_samples(samples, [&](std::size_t i) {
            const auto spectrum = std::span(samples.spectrum).subspan(i * channels, channels);
            const Rgb& f = samples.colour[i];
            return channels > 0 ? std::ranges::all_of(spectrum, [&](float x) { return x > options.floor; })
                                : std::min({f.r, f.g, f.b}) > options.floor;
        });
    if (samples.wl.empty()) return input_error(file_name, "samples", "at least one above the floor", "none");
    to_bsdf(samples, options.quantity);
    if (samples.wl.empty()) return input_error(file_name, "samples", "values in the range of f", "none");
    return Done{};
}

/// `read_unindexed`, with the quantity and the floor of the options.
Result<Measured> read_with_options(std::span<const std::byte> bytes, const std::string& file_name,
                                   const ReadOptions& options) {
    auto measured = read_unindexed(bytes, file_name, options);
    if (!options.any() || !measured) return measured;
    auto* samples = std::get_if<ScatteredSamples>(&measured->table);
    if (!samples) return argument_error(file_name, "input", "samples, for --quantity and --floor", measured->format);
    if (const auto applied = apply(options, *samples, file_name); !applied) return applied.error();
    return measured;
}

}  // namespace

std::span<const Format> formats() {
    static const std::vector<Format> all = [] {
        std::vector<Format> joined{k_rgl_format, k_mbsdf_format, k_merl_format};  // recognised by their first bytes
        for (const std::span<const Format> extra : k_extra_formats)
            joined.insert(joined.end(), extra.begin(), extra.end());
        joined.insert(joined.end(), {k_alta_format, k_astm_format, k_cornell_format, k_csv_format, k_utia_format});
        return joined;
    }();
    return all;
}

const Format* format_of(Bytes bytes) {
    const auto found = std::ranges::find_if(formats(), [&](const Format& format) { return recognises(format, bytes); });
    return found == formats().end() ? nullptr : &*found;
}

const Format* format_written_to(std::string_view path) {
    const Format* found = nullptr;
    for (const Format& format : formats())
        if (format.write && path.size() > format.extension.size() && path.ends_with(format.extension) &&
            (!found || format.extension.size() > found->extension.size()))
            found = &format;
    return found;
}

std::uint64_t max_bytes(Bytes head) {
    if (const auto text = plain_text(head)) return max_bytes(as_bytes(*text));
    std::uint64_t max = 0;
    for (const Format& format : formats())
        max = std::max(max, format.size ? format.size(head) : recognises(format, head) ? k_largest_file : 0);
    return max;
}

std::string names_of_formats() {
    std::vector<std::string_view> names;
    for (const Format& format : formats()) names.push_back(format.name);
    return join_words(names);
}

std::string extensions_of_formats() {
    std::vector<std::string_view> extensions;
    for (const Format& format : formats())
        if (format.write) extensions.push_back(format.extension);
    return join_words(extensions);
}

Result<std::vector<std::byte>> read_input(const std::string& path, const ReadOptions& options) {
    if (!options.columns.empty()) return read_file(path);
    return read_file(
        path, [](std::span<const std::byte> head) { return is_safetensors(head) ? k_largest_file : max_bytes(head); });
}

Result<Measured> read_as(const Format& format, std::span<const std::byte> bytes, const std::string& file_name,
                         const ReadOptions& options) {
    const StandardArithmetic mode;
    return build_index(read_unindexed(format, bytes, file_name, options));
}

Result<Measured> read_measured(std::span<const std::byte> bytes, const std::string& file_name,
                               const ReadOptions& options) {
    const StandardArithmetic mode;
    return build_index(read_with_options(bytes, file_name, options));
}

Result<Measured> read_measured(std::vector<std::byte>&& bytes, const std::string& file_name,
                               const ReadOptions& options) {
    const StandardArithmetic mode;
    auto measured = read_with_options(bytes, file_name, options);
    std::vector<std::byte>().swap(bytes);
    return build_index(std::move(measured));
}

Result<Measured> load_measured(const std::string& path, const ReadOptions& options) {
    return within_memory(path, [&]() -> Result<Measured> {
        auto bytes = read_input(path, options);
        if (!bytes) return bytes.error();
        return read_measured(*std::move(bytes), path, options);
    });
}

}  // namespace
