// FRED's text of tabulated scatter: lines with an incidence, each followed by lines with scattered directions.
// Directions have a polar angle and an azimuth or, in the plane of incidence, a polar angle only.

#include "brdf/directions.h"
#include "extras/optics/formats.h"
#include "measured/samples.h"

namespace SRBF_NAMESPACE {

namespace {

/// The header's second line: `format angles=deg bsdf=value scale=1`.
struct FredFormat {
    double unit = k_degree, scale = 1;
    std::string wrong;  ///< the first unknown word; empty: none
};
FredFormat fred_format(std::string_view line) {
    FredFormat format;
    for (auto word = next_word(line); !word.empty(); word = next_word(line)) {
        const auto sign = word.find('=');
        const std::string_view key = word.substr(0, sign), value = sign == word.npos ? word : word.substr(sign + 1);
        const auto number = to_number<double>(value);
        if (key == "angles" && (value == "deg" || value == "rad"))
            format.unit = value == "deg" ? k_degree : 1;
        else if (key == "scale" && number && *number > 0 && *number <= 1e12)
            format.scale = *number;
        else if (word != "format" && word != "bsdf=value")
            format.wrong = word;
    }
    return format;
}

}  // namespace

bool is_fred(std::string_view text) {
    Lines lines(text);
    const auto line = lines.next();
    return line && line->starts_with("type bsdf_data");
}

Result<ScatteredSamples> read_fred(std::span<const std::byte> bytes, const std::string& file_name) {
    Lines lines(as_text(bytes));
    FredFormat format;
    SampleBuilder builder(Values::grey, {}, bytes.size(), lines_of(bytes));
    std::optional<Vec3d> light;
    std::size_t angles = 0;  // angles in a direction; 1 in the plane of incidence
    const auto expected_numbers = [&] {
        return angles == 1 ? "one of a light or two of a sample" : "two of a light or three of a sample";
    };
    while (auto line = lines.next()) {
        if (line->starts_with("type") || line->starts_with("#")) continue;
        const auto wrong = [&](const char* what, std::string expected, std::string_view found) {
            return at_line(file_name, lines.number(), what, std::move(expected), quoted(found));
        };
        if (line->starts_with("format")) {
            format = fred_format(*line);
            if (!format.wrong.empty()) return wrong("format", "angles=deg or rad, bsdf=value, scale=", format.wrong);
            continue;
        }
        std::array<double, 3> numbers{};
        std::size_t count = 0;
        std::string_view remaining = *line;
        for (auto word = next_word(remaining); !word.empty(); word = next_word(remaining), ++count) {
            const auto number = to_number<double>(word);
            if (!number || count == numbers.size()) return wrong("numbers", expected_numbers(), word);
            numbers[count] = *number;
        }
        if (angles == 0) angles = std::min<std::size_t>(count, 2);  // the first line has the angles of a light
        if (count != angles && count != angles + 1) return wrong("numbers", expected_numbers(), *line);
        const double theta = numbers[0] * format.unit, phi = angles == 2 ? numbers[1] * format.unit : 0;
        if (!(std::abs(theta) <= k_pi + k_azimuth_rounding)) return wrong("polar angle", "at most 180 degrees", *line);
        if (count == angles) {
            // Azimuth 0 of the viewer is the side of the mirror direction.
            light = spherical(theta, phi + k_pi);
            continue;
        }
        if (!light) return wrong("sample", "a line of the light before it", *line);
        const float f = float(numbers[angles]);
        builder.add(*light, spherical(theta, phi), std::span(&f, 1));
    }
    auto samples = std::move(builder).finish(file_name, "FRED");
    if (samples) to_bsdf(*samples, Quantity::bsdf, format.scale);
    return samples;
}

}  // namespace
