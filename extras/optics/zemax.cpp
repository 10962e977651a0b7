// Zemax' text format for measured scatter, "BSDF Data Interchange file format".
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/errors.h"
#include "base/floating_point.h"
#include "extras/optics/formats.h"
#include "measured/bytes.h"

namespace SRBF_NAMESPACE {

namespace {

/// The headings of data blocks for the SpectralContent Monochrome and XYZ.
constexpr std::string_view k_monochrome = "Monochrome", k_xyz = "XYZ";
constexpr std::array<std::string_view, 3> k_tristimulus{"TristimulusX", "TristimulusY", "TristimulusZ"};

/// The header. Its names are spelt as here.
struct ZemaxHeader {
    std::string_view symmetry, content = k_monochrome, type;
    std::vector<float> rotation, incidence, azimuth, radial;
};

void read_zemax_header(ScatterText& text, ZemaxHeader& header) {
    constexpr double tenth_turns = 3600;  // the maximum number of rotations, which is a step of 0.1 degree
    for (;;) {
        const std::string_view key = text.word();
        const auto list = [&](std::vector<float>& target, double upper) {
            target = text.angles(key, text.count(key, std::size_t(tenth_turns) + 1), 0, upper);
        };
        const auto one_of = [&](std::string_view& target, std::initializer_list<std::string_view> names) {
            const std::string_view word = text.word();
            const auto* match =
                std::ranges::find_if(names, [&](std::string_view name) { return equal_ignoring_case(name, word); });
            if (match == names.end())
                text.fail(key, fmt::format("one of {}", fmt::join(names, ", ")), quoted(word));
            else
                target = *match;
        };
        std::string_view ignored;
        if (key == "Source")
            one_of(ignored, {"Measured", "Generated"});
        else if (key == "Symmetry")
            one_of(header.symmetry, {"PlaneSymmetrical", "Asymmetrical", "Asymmetrical4D"});
        else if (key == "SpectralContent")
            one_of(header.content, {k_monochrome, k_xyz});
        else if (key == "ScatterType")
            one_of(header.type, {"BRDF", "BTDF"});
        else if (key == "SampleRotation")
            list(header.rotation, 360);
        else if (key == "AngleOfIncidence")
            list(header.incidence, 90);
        else if (key == "ScatterAzimuth")
            list(header.azimuth, 360);
        else if (key == "ScatterRadial")
            list(header.radial, 180);
        else if (key != k_monochrome && key != k_tristimulus[0])
            text.fail("header", "a key of it, or Monochrome", key.empty() ? "the end of the file" : quoted(key));
        if (!text.error() && (key == k_monochrome || key == k_tristimulus[0]) &&
            (key == k_monochrome) != (header.content == k_monochrome))
            text.fail("data", header.content == k_monochrome ? "Monochrome" : "TristimulusX, as XYZ", quoted(key));
        if (text.error() || key == k_monochrome || key == k_tristimulus[0]) return;
    }
}

/// Reads a block of data into the channel. Each slice has a row for each azimuth.
void read_zemax_data(ScatterText& text, std::size_t channel, ScatterTable& table) {
    if (const auto word = text.word(); word != "DataBegin") text.fail("data", "DataBegin", quoted(word));
    for (ScatterTable::Slice& slice : table.slices) {
        if (text.error()) return;
        if (const auto word = text.word(); word != "TIS")
            text.fail("data", "TIS before the values of an angle of incidence", quoted(word));
        text.number<float>("TIS");
        const std::size_t n_azimuth = slice.azimuth.size(), n_radial = slice.polar.size();
        std::vector<float> f;
        text.values(n_azimuth * n_radial, f);
        if (text.error()) return;
        mask_missing(f, 1);
        slice.f.resize(table.channels * f.size());
        for (std::size_t a = 0; a < n_azimuth; ++a)
            for (std::size_t r = 0; r < n_radial; ++r)
                slice.f[channel * f.size() + r * n_azimuth + a] = f[a * n_radial + r];
    }
    if (const auto word = text.word(); word != "DataEnd")
        text.fail("data", "DataEnd", word.empty() ? "the end of the file" : quoted(word));
}

}  // namespace

bool is_zemax(std::string_view text) {
    for (Lines lines(text); auto line = lines.next();) {
        if (line->starts_with('#')) continue;
        const std::string_view key = next_word(*line);
        return key == "Source" || key == "Symmetry" || key == "SpectralContent" || key == "ScatterType";
    }
    return false;
}

Result<ScatterTable> read_zemax(std::span<const std::byte> bytes, const std::string& file_name) {
    const StandardArithmetic mode;
    ScatterText text(as_text(bytes), file_name, true);
    ZemaxHeader header;
    read_zemax_header(text, header);
    if (!text.error())
        for (const auto* list : {&header.rotation, &header.incidence, &header.azimuth, &header.radial})
            if (list->empty())
                text.fail("header", "SampleRotation, AngleOfIncidence, ScatterAzimuth, ScatterRadial", "fewer");
    if (!text.error() && (header.symmetry.empty() || header.type.empty()))
        text.fail("header", "Symmetry and ScatterType", "fewer");
    if (text.error()) return *text.error();
    ScatterTable table;
    table.about_mirror = true;
    table.transmission = header.type == "BTDF";
    table.rotation = header.rotation;
    table.channels = header.content == k_xyz ? 3 : 1;
    const std::size_t values = header.azimuth.size() * header.radial.size();  // each factor is at most 3601²
    if (values > bytes.size() || values * header.incidence.size() > bytes.size() ||
        values * header.incidence.size() * header.rotation.size() > bytes.size())
        text.fail("header", "no more values than the file has bytes", "more");
    if (header.symmetry == "PlaneSymmetrical" && double(header.azimuth.back()) > k_pi + k_azimuth_rounding)
        text.fail("ScatterAzimuth", "angles to 180, as PlaneSymmetrical", written_degrees(header.azimuth.back()));
    if (header.symmetry != "Asymmetrical4D" && header.rotation.size() > 1)
        text.fail("SampleRotation", "one angle, unless Asymmetrical4D", fmt::format("{}", header.rotation.size()));
    if (text.error()) return *text.error();
    table.first = {0};
    for (std::size_t r = 0; r < header.rotation.size(); ++r) {
        for (const float theta : header.incidence) table.slices.push_back({theta, header.radial, header.azimuth, {}});
        table.first.push_back(std::uint32_t(table.slices.size()));
    }
    for (std::size_t channel = 0; channel < table.channels && !text.error(); ++channel) {
        if (channel > 0)
            if (const auto word = text.word(); word != k_tristimulus[channel])
                text.fail("data", std::string(k_tristimulus[channel]),
                          word.empty() ? "the end of the file" : quoted(word));
        read_zemax_data(text, channel, table);
    }
    if (text.error()) return *text.error();
    mask_gaps(table);
    return table;
}

std::string write_zemax(const ScatterTable& table) {
    const ScatterTable::Slice& first_slice = table.slices.front();
    const std::size_t n_azimuth = first_slice.azimuth.size(), n_radial = first_slice.polar.size();
    const bool is_plane = double(first_slice.azimuth.back()) <= k_pi + k_azimuth_rounding;
    std::string text = fmt::format(
        "# BSDF by srbf; values in 1/sr, TIS is the integral of BSDF times cosine\nSource  Measured\nSymmetry  {}\n"
        "SpectralContent  {}\nScatterType  {}\n",
        table.rotation.size() > 1 ? "Asymmetrical4D"
        : is_plane                ? "PlaneSymmetrical"
                                  : "Asymmetrical",
        table.channels == 1 ? k_monochrome : k_xyz, table.transmission ? "BTDF" : "BRDF");
    const auto list = [&](const char* key, const std::vector<float>& angles) {
        text += fmt::format("{}  {}\n", key, angles.size());
        for (const float angle : angles) text += written_degrees(angle) + '\t';
        text += '\n';
    };
    std::vector<float> incidence;
    for (std::uint32_t k = 0; k < table.first[1]; ++k) incidence.push_back(table.slices[k].theta_l);
    list("SampleRotation", table.rotation);
    list("AngleOfIncidence", incidence);
    list("ScatterAzimuth", first_slice.azimuth);
    list("ScatterRadial", first_slice.polar);
    for (std::size_t channel = 0; channel < table.channels; ++channel) {
        text += fmt::format("\n{}\nDataBegin\n", table.channels == 1 ? k_monochrome : k_tristimulus[channel]);
        for (const ScatterTable::Slice& slice : table.slices) {
            text += fmt::format("TIS {:.6g}\n", scatter_integral(table, slice, channel));
            for (std::size_t a = 0; a < n_azimuth; ++a) {
                for (std::size_t r = 0; r < n_radial; ++r) {
                    const float f = slice.f[(channel * n_radial + r) * n_azimuth + a];
                    text += fmt::format("{}\t", std::isfinite(f) ? f : 0.f);
                }
                text += '\n';
            }
        }
        text += "DataEnd\n";
    }
    return text;
}

Result<Measured> read_as_zemax(std::span<const std::byte> bytes, const std::string& file_name, const ReadOptions&) {
    auto table = read_zemax(bytes, file_name);
    if (!table) return table.error();
    const bool transmission = table->transmission;
    std::array<std::optional<ScatterTable>, 2> tables;
    tables[std::size_t(transmission)] = *std::move(table);
    return measured_of(std::move(tables), file_name, "Zemax");
}

/// Writes a BRDF, or a BSDF that only transmits light from the front.
Result<std::vector<std::byte>> write_as_zemax(const TableSource& source, const TableOptions& options) {
    const auto tables = scatter_tables(source, true, options.threads);
    if (tables.size() > 1) return argument_error("table", "input", "only reflection or only transmission", "both");
    return bytes_of(write_zemax(tables[0]));
}

}  // namespace
