#include "base/floating_point.h"
#include "measured/formats/format_rows.h"
#include "measured/readers.h"
#include "measured/samples.h"

namespace SRBF_NAMESPACE {

namespace {

/// The comments at the beginning, which describe the measurement.
std::string description_of(std::string_view text) {
    std::string description;
    for (Lines lines(text); auto line = lines.next();) {
        if (!line->starts_with('#')) break;
        line->remove_prefix(1);
        const std::string_view comment = trimmed(*line);
        if (comment == "num wls") break;
        if (!comment.empty()) description += (description.empty() ? "" : ", ") + std::string(comment);
    }
    return description.substr(0, 1000);
}

bool is_cornell(std::string_view text) {
    for (Lines lines(text); auto line = lines.next();) {
        std::string_view rest = trimmed(line->substr(0, line->find('#')));
        if (rest.empty()) continue;
        return to_number<int>(next_word(rest)) && trimmed(rest).empty();
    }
    return false;
}

}  // namespace

Result<ScatteredSamples> read_cornell(std::span<const std::byte> bytes, const std::string& file_name) {
    const std::string_view text = as_text(bytes);
    Lines lines(text);
    std::string_view line;
    const auto next = [&] {  // the next word outside comments; empty at the end of the text
        for (;;) {
            if (const auto found = next_word(line); !found.empty()) return found;
            const auto following = lines.next();
            if (!following) return std::string_view();
            line = following->substr(0, following->find('#'));
        }
    };
    std::string_view word = next();
    const auto count = to_number<std::uint32_t>(word);
    if (!count || *count < 1 || *count > k_max_columns)
        return at_line(file_name, lines.number(), "number of wavelengths",
                       fmt::format("between 1 and {}", k_max_columns), quoted(word));
    std::vector<float> wavelengths;
    for (std::uint32_t i = 0; i < *count; ++i) {
        word = next();
        const auto nm = to_number<float>(word);
        if (!nm)
            return at_line(file_name, lines.number(), fmt::format("wavelength {} of {}", i + 1, *count), "a number",
                           word.empty() ? "the end of the file" : quoted(word));
        wavelengths.push_back(*nm);
    }
    if (!are_wavelengths(wavelengths))
        return at_line(file_name, lines.number(), "wavelengths", "increasing ones in nm, from 100 up",
                       fmt::format("{} to {}", wavelengths.front(), wavelengths.back()));

    std::vector<float> row(4 + wavelengths.size());
    // A row may span several lines, and a line may hold several rows; a word takes at least two bytes.
    SampleBuilder builder(Values::spectrum, std::move(wavelengths), bytes.size(), bytes.size() / (2 * row.size()) + 1);
    for (;;) {
        for (std::size_t i = 0; i < row.size(); ++i) {
            word = next();
            if (word.empty() && i == 0) return std::move(builder).finish(file_name, description_of(text));
            const auto number = to_number<float>(word);
            if (!number)
                return at_line(file_name, lines.number(), fmt::format("number {} of a sample of {}", i + 1, row.size()),
                               "a number", word.empty() ? "the end of the file" : quoted(word));
            row[i] = *number;
        }
        for (std::size_t i = 0; i < 4; ++i)
            if (auto expected = expected_angle(k_angle_kinds[i], double(row[i]), k_in_radians); !expected.empty())
                return at_line(file_name, lines.number(), fmt::format("number {} of a sample of {}", i + 1, row.size()),
                               std::move(expected), fmt::format("{:g}", row[i]));
        builder.add(spherical(double(row[0]), double(row[1])), spherical(double(row[2]), double(row[3])),
                    std::span(row).subspan(4));
    }
}

const Format k_cornell_format{
    .name = "Cornell", .is_text = true, .recognise = in_text<is_cornell>, .read = read_by<read_cornell>};

}  // namespace
