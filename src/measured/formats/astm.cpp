#include "base/floating_point.h"
#include "measured/formats/format_rows.h"
#include "measured/readers.h"
#include "measured/samples.h"

namespace SRBF_NAMESPACE {

namespace {

constexpr std::array<std::string_view, 4> k_names_of_angles{"theta_i", "phi_i", "theta_s", "phi_s"};

/// The comment of Cornell's files with RGB values. Their conversion to linear sRGB is the least-squares map from
/// krylon_blue_RGB.astm to the colours of the spectra of the same samples (krylon_blue.brdf), with a squared error
/// ratio of 2e-8. Its rows sum to 2.8, by which the scale of those files is lower than white = 1.
constexpr std::string_view k_trinitron = "RGB for Trinitron phosphors";
constexpr double k_from_trinitron[3][3] = {
    {3.10689, -0.26651, -0.04211}, {0.08512, 2.62439, 0.07920}, {0.04650, 0.06312, 2.68701}};

Rgb from_trinitron(const Rgb& f) {
    Rgb rgb;
    for (int c = 0; c < 3; ++c)
        for (int k = 0; k < 3; ++k) rgb[c] += float(k_from_trinitron[c][k] * double(f[k]));
    return rgb;
}

/// Positions of the columns that VARS names.
struct Vars {
    std::array<std::size_t, 4> angle{k_absent, k_absent, k_absent, k_absent};
    std::vector<std::size_t> value;
    Values values = Values::grey;
    std::size_t count = 0;
};

Result<Vars> parse_vars(std::string_view vars, const std::string& file_name, std::uint64_t line) {
    Vars columns;
    std::vector<std::string_view> names, values;
    split_fields(vars, names);
    columns.count = names.size();
    if (columns.count > k_max_columns)
        return at_line(file_name, line, "VARS", fmt::format("at most {} columns", k_max_columns),
                       fmt::format("{}", columns.count));
    for (std::size_t i = 0; i < names.size(); ++i) {
        const auto angle = std::ranges::find(k_names_of_angles, names[i]);
        if (angle == k_names_of_angles.end()) {
            columns.value.push_back(i);
            values.push_back(names[i]);
            continue;
        }
        std::size_t& column = columns.angle[std::size_t(angle - k_names_of_angles.begin())];
        if (column != k_absent)
            return at_line(file_name, line, "VARS", "each column once", quoted(names[i]) + " again");
        column = i;
    }
    // The azimuth of the light is optional and 0 by default.
    for (const std::size_t a : {std::size_t(0), std::size_t(2), std::size_t(3)})
        if (columns.angle[a] == k_absent)
            return at_line(file_name, line, "VARS", fmt::format("a column {}", k_names_of_angles[a]), "none");
    const std::vector<std::string_view> rgb{"R", "G", "B"}, xyz{"X", "Y", "Z"};
    columns.values = values == rgb ? Values::rgb : values == xyz ? Values::xyz : Values::grey;
    if (columns.values == Values::grey && values.size() != 1)
        return at_line(file_name, line, "VARS", "values R,G,B or X,Y,Z or one column",
                       values.empty() ? "none" : fmt::format("{} from {}", values.size(), quoted(values[0])));
    return columns;
}

bool opens_row(std::string_view line) { return line.find_first_of("0123456789+-.") == 0; }

struct AstmHeader {
    Vars columns;
    std::optional<std::uint64_t> points;
    std::string description;
};

Result<AstmHeader> read_astm_header(Lines& lines, const std::string& file_name) {
    AstmHeader header;
    for (;;) {
        auto line = lines.next();
        if (!line) return at_line(file_name, lines.number(), "header", "a line VARS", "the end of the file");
        const std::string_view key = next_word(*line), rest = trimmed(*line);
        if (key.starts_with('#')) continue;
        if (opens_row(key))
            return at_line(file_name, lines.number(), "header", "a line VARS before the samples", "none");
        if (key == "NUM_POINTS") {
            header.points = to_number<std::uint64_t>(rest);
            if (!header.points) return at_line(file_name, lines.number(), "NUM_POINTS", "a number", quoted(rest));
        } else if (key == "VARS") {
            auto columns = parse_vars(rest, file_name, lines.number());
            if (!columns) return columns.error();
            header.columns = *std::move(columns);
            return header;
        } else if (key == "SAMPLE_NAME" || key == "SAMPLE_TYPE" || key == "LAB_COMMENTS") {
            header.description += (header.description.empty() ? "" : ", ") + std::string(rest.substr(0, 300));
        }
    }
}

bool is_astm(std::string_view text) {
    for (Lines lines(text); auto line = lines.next();) {
        const std::string_view key = next_word(*line);
        if (key == "VARS" || key == "NUM_POINTS" || key == "LAB_NAME") return true;
        if (key.starts_with('#')) continue;
        if (opens_row(key) || key.find(',') != key.npos) return false;
    }
    return false;
}

}  // namespace

Result<ScatteredSamples> read_astm(std::span<const std::byte> bytes, const std::string& file_name) {
    Lines lines(as_text(bytes));
    auto header = read_astm_header(lines, file_name);
    if (!header) return header.error();
    const Vars& columns = header->columns;
    const bool is_trinitron =
        columns.values == Values::rgb && header->description.find(k_trinitron) != std::string::npos;

    SampleBuilder builder(columns.values, {}, bytes.size(), lines_of(bytes));
    NumberRow row(columns.count, file_name);
    std::array<double, 4> angle{};
    std::vector<float> f(builder.width());
    std::uint64_t rows = 0;
    while (auto line = lines.next()) {
        if (line->starts_with('#')) continue;
        ++rows;
        row.read(*line, lines.number());
        for (std::size_t a = 0; a < angle.size(); ++a)
            if (columns.angle[a] != k_absent)
                angle[a] = row.angle(columns.angle[a], k_names_of_angles[a], k_angle_kinds[a], k_in_radians);
        for (std::size_t v = 0; v < f.size(); ++v) f[v] = row.number<float>(columns.value[v], "value");
        if (row.error()) return *row.error();
        builder.add(spherical(angle[0], angle[1]), spherical(angle[2], angle[3]), f);
    }
    if (header->points && *header->points != rows)
        return Error{
            file_name, {}, "samples", fmt::format("{} (NUM_POINTS)", *header->points), fmt::format("{}", rows)};
    auto samples = std::move(builder).finish(file_name, std::move(header->description));
    if (samples && is_trinitron) std::ranges::transform(samples->colour, samples->colour.begin(), from_trinitron);
    return samples;
}

const Format k_astm_format{
    .name = "ASTM E1392", .is_text = true, .recognise = in_text<is_astm>, .read = read_by<read_astm>};

}  // namespace
