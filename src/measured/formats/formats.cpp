#include "measured/formats.h"

#include <fmt/ranges.h>

#include "base/files.h"
#include "measured/bytes.h"
#include "measured/formats/mbsdf.h"
#include "measured/formats/rows.h"
#include "measured/formats/write.h"
#include "measured/readers.h"
#include "measured/samples.h"
#include "srbf/file.h"

namespace SRBF_NAMESPACE {

namespace {

using Bytes = std::span<const std::byte>;

Result<Measured> read_any_mbsdf(Bytes bytes, const std::string& file_name, const ReadOptions&) {
    auto table = read_mbsdf(bytes, file_name);
    return table && table->has_transmission ? measurement_of(read_mbsdf_of_both_sides(bytes, file_name))
                                            : measurement_of(std::move(table));
}

Result<Measured> read_any_csv(Bytes bytes, const std::string& file_name, const ReadOptions& options) {
    return is_csv_of_both_sides(as_text(bytes)) ? measurement_of(read_csv_of_both_sides(bytes, file_name))
                                                : measurement_of(read_csv(bytes, file_name, options));
}

std::uint64_t utia_size(Bytes) { return utia_bytes(); }

/// Formats with a magic number, or with dimensions at the head. They are tried before those of extras.
constexpr Format k_with_heads[] = {
    {.name = "RGL",
     .recognise = is_rgl,
     .read = read_by<read_rgl>,
     .extension = ".bsdf",
     .used_by = "RGL",
     .one_sided = true,
     .write = write_as_rgl},
    {.name = "MBSDF",
     .recognise = is_mbsdf,
     .read = read_any_mbsdf,
     .extension = ".mbsdf",
     .used_by = "MDL",
     .write = write_as_mbsdf},
    {.name = "MERL",
     .recognise = is_merl,
     .read = read_by<read_merl>,
     .size = merl_bytes,
     .extension = ".binary",
     .used_by = "MERL",
     .one_sided = true,
     .write = write_as_merl},
};
/// Formats that are recognised by words or by size.
constexpr Format k_others[] = {
    {.name = "ALTA", .is_text = true, .recognise = in_text<is_alta>, .read = read_by<read_alta>},
    {.name = "ASTM E1392", .is_text = true, .recognise = in_text<is_astm>, .read = read_by<read_astm>},
    {.name = "Cornell", .is_text = true, .recognise = in_text<is_cornell>, .read = read_by<read_cornell>},
    {.name = "CSV",
     .is_text = true,
     .recognise = in_text<is_csv>,
     .read = read_any_csv,
     .extension = ".csv",
     .anisotropic = true,
     .write = write_as_csv},
    {.name = "UTIA", .recognise = is_utia, .read = read_by<read_utia>, .size = utia_size},
};

/// "A, B or C".
std::string join_words(const std::vector<std::string_view>& words) {
    return fmt::format("{} or {}", fmt::join(words.begin(), words.end() - 1, ", "), words.back());
}

bool recognises(const Format& format, Bytes head) {
    return (!format.is_text || is_text(head)) && format.recognise(head);
}

}  // namespace

std::span<const Format> formats() {
    static const std::vector<Format> all = [] {
        std::vector<Format> joined(std::begin(k_with_heads), std::end(k_with_heads));
        for (const std::span<const Format> extra : k_extra_formats)
            joined.insert(joined.end(), extra.begin(), extra.end());
        joined.insert(joined.end(), std::begin(k_others), std::end(k_others));
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

std::uint64_t most_bytes(Bytes head) {
    if (const auto text = plain_text(head)) return most_bytes(as_bytes(*text));
    std::uint64_t most = 0;
    for (const Format& format : formats())
        most = std::max(most, format.size ? format.size(head) : recognises(format, head) ? k_largest_file : 0);
    return most;
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

}  // namespace srbf
