// Joins files of one sample, such as a goniometer's files for single incidences.
#include <fmt/ranges.h>

#include <map>
#include <set>

#include "base/floating_point.h"
#include "measured/readers.h"
#include "measured/samples.h"
#include "measured/tables.h"
#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {

namespace {

std::string name_of(const Measured& file) { return file.source.substr(file.source.find_last_of('/') + 1); }

/// The parts of a description or note.
std::set<std::string_view> parts_of(std::string_view text) {
    std::vector<std::string_view> parts;
    split_fields(text, parts, k_line_end[0]);
    return {parts.begin(), parts.end()};
}

/// Describes what all files of one sample must share: wavelengths or colours, and the names of values.
std::string kind_of(const Measured& file) {
    const auto* samples = std::get_if<ScatteredSamples>(&file.table);
    if (!samples) return "a table, or two sides";
    std::string kind = fmt::format("{:g} nm", fmt::join(samples->wavelengths, ", "));
    const auto is_grey = [](const Rgb& f) { return f.r == f.g && f.g == f.b; };
    if (samples->wavelengths.empty()) kind = std::ranges::all_of(samples->colour, is_grey) ? "grey" : "colours";
    for (const std::string& note : samples->notes)
        for (const std::string_view part : parts_of(note))
            if (part.starts_with("value")) kind += fmt::format(", {}", part);
    return kind;
}

/// "3 files as one sample: incidence 10, 30, 50 degrees; the same grey, lamp xenon; different date".
std::string note_of(std::span<const Measured> files) {
    std::set<double> incidences;
    std::map<std::string_view, std::size_t> lines;
    for (const Measured& file : files) {
        const auto& samples = std::get<ScatteredSamples>(file.table);
        for (const Vec3f wl : samples.wl)
            incidences.insert(std::round(elementary::acos(std::min(double(wl.z), 1.0)) / k_degree * 10) / 10);
        for (const std::string_view line : parts_of(samples.description)) ++lines[line];
    }
    constexpr std::size_t max_listed = 12;
    const auto listed = incidences.size() <= max_listed
                            ? fmt::format("{}", fmt::join(incidences, ", "))
                            : fmt::format("{} to {}", *incidences.begin(), *incidences.rbegin());
    std::string same = kind_of(files[0]), different;
    lines.erase("");
    for (const auto& [line, count] : lines)
        if (count == files.size())
            same += fmt::format(", {}", line);
        else if (const auto word = line.substr(0, line.find_first_of(" \t:=,")); !different.ends_with(word))
            different += fmt::format("{} {}", different.empty() ? "; different" : ",", word);
    return fmt::format("{} files as one sample: incidence {} degrees; the same {}{}", files.size(), listed, same,
                       different);
}

}  // namespace

Result<Measured> join_measurements(std::span<const Measured> files) {
    const StandardArithmetic mode;
    if (files.size() < 2) return Error{"files", {}, "one sample", "two or more", std::to_string(files.size())};
    for (const Measured& file : files) {
        const bool is_table = !std::holds_alternative<ScatteredSamples>(file.table);
        const std::string found = kind_of(file), expected = is_table ? "samples" : kind_of(files[0]),
                          as = fmt::format("{:.80} as in {}", expected, name_of(files[&file == &files[0]]));
        if (found != expected) return Error{file.source, {}, "one sample", as, fmt::format("{:.80}", found)};
    }
    Measured all = files[0];
    all.source = name_of(files[0]);
    auto& samples = std::get<ScatteredSamples>(all.table);
    const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
    for (const Measured& file : files) {
        const auto& more = std::get<ScatteredSamples>(file.table);
        samples.weight.resize(samples.wl.size(), 1);
        if (&file == &files[0]) continue;
        append(samples.wl, more.wl);
        append(samples.wv, more.wv);
        append(samples.colour, more.colour);
        append(samples.spectrum, more.spectrum);
        append(samples.weight, more.weight);
        append(samples.notes, more.notes);
        samples.weight.resize(samples.wl.size(), 1), samples.masked += more.masked;
        all.source += ", " + name_of(file), all.bytes += file.bytes;
    }
    samples.notes.insert(samples.notes.begin(), note_of(files));
    samples.isotropic = change_by_azimuth(samples) == 0;
    make_index(samples);
    return all;
}

}  // namespace
