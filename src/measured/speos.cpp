// Speos' text of anisotropic BSDFs, `.anisotropicbsdf`.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "measured/limits.h"
#include "measured/scatter.h"
#include "srbf/colour.h"
#include "srbf/convert.h"
#include "srbf/elementary.h"

namespace srbf {

namespace {

constexpr std::string_view k_speos_title = "OPTIS - Anisotropic BSDF surface file";
/// Limits on what a header may count.
constexpr std::size_t k_most_rotations = 3600, k_most_incidences = 3600, k_most_grid = 10000, k_most_percents = 10000;
/// Values are relative to the percentage. Where their own integral is within this of it, they are taken as they are: the
/// percentage of a file is often that of another quadrature.
constexpr double k_same_percentage = 0.1;

/// Of a side, reflection or transmission.
struct SpeosSide {
    bool is_there = false, is_transmission = false;
    std::vector<float> rotation;
    std::vector<std::vector<float>> incidence;  ///< of each rotation
    double theta = 0;                           ///< of the light of the percentages [rad]
    std::vector<float> wavelength, percent;
};

void read_speos_angles(ScatterText& text, SpeosSide& side) {
    side.rotation = text.angles("rotation", text.count("number of rotations", k_most_rotations), 0, 360);
    for (std::size_t r = 0; r < side.rotation.size() && !text.error(); ++r)
        side.incidence.push_back(
            text.angles("incidence", text.count("number of incidences", k_most_incidences), 0, 90));
}

void read_speos_percents(ScatterText& text, SpeosSide& side) {
    side.theta = text.number<double>("theta of the spectrum") * k_degree;
    text.number<double>("phi of the spectrum");
    text.raw_line(), text.raw_line();  // the end of that line, then a description
    const std::size_t n = text.count("number of wavelengths", k_most_percents);
    for (std::size_t i = 0; i < n && !text.error(); ++i) {
        side.wavelength.push_back(text.number<float>("wavelength"));
        side.percent.push_back(text.number<float>("percentage"));
        if (!text.error() && !(side.percent.back() >= 0 && side.percent.back() <= 1000))
            text.fail("percentage", "0 to 1000", fmt::format("{}", side.percent.back()));
    }
    if (!text.error() && !are_wavelengths(side.wavelength)) text.fail("wavelengths", "rising ones in nm", "others");
}

/// A block of values: θ rises from the normal in reflection, from 90 to 180° in transmission, which is turned round.
ScatterTable::Slice read_speos_slice(ScatterText& text, const SpeosSide& side, float theta_l, bool are_bsdf) {
    ScatterTable::Slice slice;
    slice.theta_l = theta_l;
    const std::size_t n_theta = text.count("number of theta", k_most_grid),
                      n_phi = text.count("number of phi", k_most_grid);
    if (!text.error() && n_theta * n_phi > text.left()) text.fail("number of values", "what the file has", "more");
    slice.azimuth = text.angles("phi", n_phi, 0, 360);
    const auto [least, most] = side.is_transmission ? std::pair(90.0, 180.0) : std::pair(0.0, 90.0);
    std::vector<std::vector<float>> rows;
    for (std::size_t t = 0; t < n_theta && !text.error(); ++t) {
        const auto theta = text.angles("theta", 1, least, most);
        if (text.error()) break;
        if (t > 0 && !(theta[0] > slice.polar.back())) text.fail("theta", "a larger one", written_degrees(theta[0]));
        slice.polar.push_back(theta[0]);
        text.values(n_phi, rows.emplace_back(), are_bsdf ? 1 / k_pi : 1);  // BSDFs are relative to white
    }
    if (side.is_transmission) {
        std::ranges::reverse(slice.polar), std::ranges::reverse(rows);
        for (float& theta : slice.polar) theta = float(k_pi - double(theta));
    }
    for (const auto& row : rows) slice.f.insert(slice.f.end(), row.begin(), row.end());
    return slice;
}

/// Turns values of a side into f [1/sr].
void scale_speos(ScatterTable& table, const SpeosSide& side, bool are_bsdf) {
    for (ScatterTable::Slice& slice : table.slices)
        for (std::size_t k = 0; k < slice.f.size() && !are_bsdf; ++k) {
            const double c = elementary::cos(double(slice.polar[k / slice.azimuth.size()]));
            // An intensity has the cosine, and nothing at the horizon.
            slice.f[k] = c > 1e-4 ? float(double(slice.f[k]) / c) : 0.f;
        }
    mask_gaps(table);
    const auto nearest = std::ranges::min_element(
        table.slices, {}, [&](const ScatterTable::Slice& of) { return std::abs(double(of.theta_l) - side.theta); });
    double mean = 0;
    for (const float percent : side.percent) mean += double(percent) / 100 / double(side.percent.size());
    const double own = scatter_integral(table, *nearest, true);
    if (own > 0 && mean > 0 && !(std::abs(own - mean) <= k_same_percentage * mean))
        for (ScatterTable::Slice& slice : table.slices)
            for (float& f : slice.f) f = float(double(f) * mean / own);
    const bool is_flat = std::ranges::all_of(side.percent, [&](float p) { return p == side.percent[0]; });
    if (is_flat || !(mean > 0)) return;
    const Rgb tint = to_rgb(side.percent, rgb_weights(side.wavelength));
    for (int c = 0; c < 3; ++c) table.tint[c] = float(double(tint[c]) / 100 / mean);
}

std::optional<Error> check_values(const ScatterTable& table, const std::string& file_name) {
    for (const ScatterTable::Slice& slice : table.slices)
        for (const float f : slice.f)
            if (std::isinf(f) || std::abs(f) > k_largest_value)
                return Error{file_name, {}, "values", "ones in the range of values", "others"};
    return {};
}

}  // namespace

bool is_speos(std::string_view text) { return text.starts_with(k_speos_title); }

Result<std::array<std::optional<ScatterTable>, 2>> read_speos(std::span<const std::byte> bytes,
                                                              const std::string& file_name) {
    ScatterText text(as_text(bytes), file_name, false);
    if (const auto title = text.raw_line(); !title.starts_with(k_speos_title))
        text.fail("title", std::string(k_speos_title), quoted(title));
    if (const auto flag = text.raw_line(); flag != "0")
        text.fail("second line", "0, a file of text", flag.starts_with('1') ? "1, a binary file" : quoted(flag));
    text.raw_line();  // a comment
    const auto length = text.number<std::uint32_t>("length of the description");
    text.raw_line(), text.skip(length), text.raw_line();
    for (int i = 0; i < 3; ++i) text.number<double>("anisotropy vector");
    std::array<SpeosSide, 2> sides;
    for (std::size_t s = 0; s < 2; ++s)
        sides[s].is_there = text.number<int>("flags of reflection and transmission") != 0,
        sides[s].is_transmission = s == 1;
    const int type = text.number<int>("type of values");
    if (!text.error() && !(type == 0 || type == 1)) text.fail("type of values", "0 or 1", fmt::format("{}", type));
    if (!text.error() && !sides[0].is_there && !sides[1].is_there)
        text.fail("flags", "reflection or transmission", "neither");
    for (SpeosSide& side : sides)
        if (side.is_there) read_speos_angles(text, side);
    for (SpeosSide& side : sides)
        if (side.is_there) read_speos_percents(text, side);
    std::array<std::optional<ScatterTable>, 2> tables;
    for (std::size_t s = 0; s < 2 && !text.error(); ++s) {
        if (!sides[s].is_there) continue;
        ScatterTable& table = tables[s].emplace();
        table.transmission = s == 1, table.rotation = sides[s].rotation, table.first = {0};
        for (const auto& incidences : sides[s].incidence) {
            for (const float theta : incidences) {
                if (text.error()) break;
                table.slices.push_back(read_speos_slice(text, sides[s], theta, type == 1));
            }
            table.first.push_back(std::uint32_t(table.slices.size()));
        }
        if (text.error()) break;
        scale_speos(table, sides[s], type == 1);
        if (auto error = check_values(table, file_name)) return *std::move(error);
    }
    if (const auto word = text.word(); word != "End")
        text.fail("data", "End of file", word.empty() ? "the end of the file" : quoted(word));
    if (text.error()) return *text.error();
    return tables;
}

std::string write_speos(std::span<const ScatterTable* const> tables) {
    const auto has = [&](bool transmission) {
        return std::ranges::any_of(tables, [&](const ScatterTable* of) { return of->transmission == transmission; });
    };
    std::string text = fmt::format("{} v8.0\n0\nBSDF by srbf\n0\n\n1\t0\t0\n{}\t{}\n1\n", k_speos_title,
                                   int(has(false)), int(has(true)));
    const auto line = [&](const std::vector<float>& angles) {
        for (const float angle : angles) text += written_degrees(angle) + '\t';
        text += '\n';
    };
    for (const ScatterTable* table : tables) {
        text += fmt::format("{}\n", table->rotation.size());
        line(table->rotation);
        for (std::size_t r = 0; r < table->rotation.size(); ++r) {
            std::vector<float> incidence;
            for (std::uint32_t k = table->first[r]; k < table->first[r + 1]; ++k)
                incidence.push_back(table->slices[k].theta_l);
            text += fmt::format("{}\n", incidence.size());
            line(incidence);
        }
    }
    for (const ScatterTable* table : tables) {
        const double percent = 100 * scatter_integral(*table, table->slices.front(), true);
        text += fmt::format("{}\t0\n\n2\n350\t{:.9g}\n850\t{:.9g}\n", written_degrees(table->slices.front().theta_l),
                            percent, percent);
    }
    for (const ScatterTable* table : tables)
        for (const ScatterTable::Slice& slice : table->slices) {
            const std::size_t n = slice.azimuth.size();
            text += fmt::format("{} {}\n\t", slice.polar.size(), n);
            line(slice.azimuth);
            for (std::size_t row = 0; row < slice.polar.size(); ++row) {
                const std::size_t t = table->transmission ? slice.polar.size() - 1 - row : row;
                text += written_degrees(table->transmission ? float(k_pi - double(slice.polar[t])) : slice.polar[t]);
                for (std::size_t a = 0; a < n; ++a) {
                    const float f = slice.f[t * n + a];
                    text += fmt::format("\t{:.9g}", std::isfinite(f) ? double(f) * k_pi : 0.0);
                }
                text += '\n';
            }
        }
    return text + "End of file\n";
}

}  // namespace srbf
