// Speos' text files of BSDFs: anisotropic ones, `.anisotropicbsdf`, and isotropic ones by wavelength, `.brdf`.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/floating_point.h"
#include "brdf/colour.h"
#include "extras/optics/formats.h"
#include "measured/bytes.h"
#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {

namespace {

constexpr std::string_view k_anisotropic_title = "OPTIS - Anisotropic BSDF surface file",
                           k_spectral_title = "OPTIS - brdf surface file";
/// Limits on the counts in a header.
constexpr std::size_t k_max_rotations = 3600, k_max_incidences = 3600, k_max_grid = 10000, k_max_percents = 10000;
/// Values are relative to the stated percentage. If their own integral is within this fraction of it they are kept
/// as they are, since a stated percentage often comes from another quadrature.
constexpr double k_same_percentage = 0.1;

/// The angles of one side, reflection or transmission.
struct SpeosSide {
    bool is_there = false, is_transmission = false;
    std::vector<float> rotation;
    std::vector<std::vector<float>> incidence;  ///< angles of incidence of each rotation
    double theta = 0;                           ///< polar angle of the light for the percentages [rad]
    std::vector<float> wavelength, percent;
};

void read_speos_angles(ScatterText& text, SpeosSide& side) {
    side.rotation = text.angles("rotation", text.count("number of rotations", k_max_rotations), 0, 360);
    for (std::size_t r = 0; r < side.rotation.size() && !text.error(); ++r)
        side.incidence.push_back(text.angles("incidence", text.count("number of incidences", k_max_incidences), 0, 90));
}

float speos_percentage(ScatterText& text) {
    const auto percent = text.number<float>("percentage");
    if (!text.error() && !(percent >= 0 && percent <= 1000))
        text.fail("percentage", "0 to 1000", fmt::format("{}", percent));
    return percent;
}

void read_speos_percents(ScatterText& text, SpeosSide& side) {
    side.theta = text.number<double>("theta of the spectrum") * k_degree;
    text.number<double>("phi of the spectrum");
    text.raw_line();
    text.raw_line();  // the end of that line, then a description
    const std::size_t n = text.count("number of wavelengths", k_max_percents);
    for (std::size_t i = 0; i < n && !text.error(); ++i) {
        side.wavelength.push_back(text.number<float>("wavelength"));
        side.percent.push_back(speos_percentage(text));
    }
    if (!text.error() && !are_wavelengths(side.wavelength)) text.fail("wavelengths", "increasing numbers in nm", "");
}

/// Converts intensities, which include the cosine and are 0 at the horizon, to f up to a factor.
void divide_by_cosine(ScatterTable::Slice& slice) {
    for (std::size_t k = 0; k < slice.f.size(); ++k) {
        const double c = elementary::cos(double(slice.polar[k / slice.azimuth.size()]));
        slice.f[k] = c > 1e-4 ? float(double(slice.f[k]) / c) : 0.f;
    }
}

/// Reads a block of values. θ rises from the normal in reflection; in transmission it rises from 90 to 180°, and is
/// reversed.
ScatterTable::Slice read_speos_slice(ScatterText& text, const SpeosSide& side, float theta_l, bool are_bsdf) {
    ScatterTable::Slice slice;
    slice.theta_l = theta_l;
    const std::size_t n_theta = text.count("number of theta", k_max_grid),
                      n_phi = text.count("number of phi", k_max_grid);
    if (!text.error() && n_theta * n_phi > text.left()) text.fail("number of values", "what the file has", "more");
    slice.azimuth = text.angles("phi", n_phi, 0, 360);
    const auto [lower, upper] = side.is_transmission ? std::pair(90.0, 180.0) : std::pair(0.0, 90.0);
    std::vector<std::vector<float>> rows;
    for (std::size_t t = 0; t < n_theta && !text.error(); ++t) {
        const auto theta = text.angles("theta", 1, lower, upper);
        if (text.error()) break;
        if (t > 0 && !(theta[0] > slice.polar.back())) text.fail("theta", "a larger one", written_degrees(theta[0]));
        slice.polar.push_back(theta[0]);
        text.values(n_phi, rows.emplace_back(), are_bsdf ? 1 / k_pi : 1);  // BSDFs are relative to white
    }
    if (side.is_transmission) {
        std::ranges::reverse(slice.polar);
        std::ranges::reverse(rows);
        for (float& theta : slice.polar) theta = float(k_pi - double(theta));
    }
    for (const auto& row : rows) slice.f.insert(slice.f.end(), row.begin(), row.end());
    mask_missing(slice.f, 1);
    if (!are_bsdf) divide_by_cosine(slice);
    return slice;
}

/// The factor for values whose integral is `found` if the file states the fraction of light `stated`.
double speos_scale(double found, double stated) {
    return found > 0 && stated > 0 && !(std::abs(found - stated) <= k_same_percentage * stated) ? stated / found : 1;
}

/// Tints all values with the percentages by wavelength.
void tint_speos(ScatterTable& table, const std::vector<float>& wavelength, const std::vector<float>& percent) {
    double mean = 0;
    for (const float p : percent) mean += double(p) / 100 / double(percent.size());
    const bool is_flat = std::ranges::all_of(percent, [&](float p) { return p == percent[0]; });
    if (is_flat || !(mean > 0)) return;
    const Rgb tint = to_rgb(percent, rgb_weights(wavelength));
    for (int c = 0; c < 3; ++c) table.tint[c] = float(double(tint[c]) / 100 / mean);
}

/// Scales the values of a side to f [1/sr].
void scale_speos(ScatterTable& table, const SpeosSide& side) {
    mask_gaps(table);
    const auto nearest = std::ranges::min_element(table.slices, {}, [&](const ScatterTable::Slice& slice) {
        return std::abs(double(slice.theta_l) - side.theta);
    });
    double mean = 0;
    for (const float percent : side.percent) mean += double(percent) / 100 / double(side.percent.size());
    const double scale = speos_scale(scatter_integral(table, *nearest), mean);
    for (ScatterTable::Slice& slice : table.slices)
        for (float& f : slice.f) f = float(scale * double(f));
    tint_speos(table, side.wavelength, side.percent);
}

std::optional<Error> check_values(const ScatterTable& table, const std::string& file_name) {
    for (const ScatterTable::Slice& slice : table.slices)
        for (const float f : slice.f)
            if (std::isinf(f) || std::abs(f) > k_largest_value)
                return Error{
                    file_name, {}, "values", fmt::format("at most {:g}", k_largest_value), fmt::format("{:g}", f)};
    return {};
}

using SpeosTables = std::array<std::optional<ScatterTable>, 2>;
/// Reads an anisotropic file after the type of values: the rotations and incidences of each side, the percentages
/// of each side, and slices.
void read_anisotropic(ScatterText& text, std::array<SpeosSide, 2>& sides, bool are_bsdf, SpeosTables& tables) {
    for (SpeosSide& side : sides)
        if (side.is_there) read_speos_angles(text, side);
    for (SpeosSide& side : sides)
        if (side.is_there) read_speos_percents(text, side);
    for (std::size_t s = 0; s < 2 && !text.error(); ++s) {
        if (!sides[s].is_there) continue;
        ScatterTable& table = tables[s].emplace();
        table.transmission = s == 1, table.rotation = sides[s].rotation, table.first = {0};
        for (const auto& incidences : sides[s].incidence) {
            for (const float theta : incidences) {
                if (text.error()) break;
                table.slices.push_back(read_speos_slice(text, sides[s], theta, are_bsdf));
            }
            table.first.push_back(std::uint32_t(table.slices.size()));
        }
        if (!text.error()) scale_speos(table, sides[s]);
    }
}

/// Reads a file by wavelength after the type of values: incidences and wavelengths, then a percentage and a slice
/// for each, first for reflection and then for transmission. A table keeps the mean over wavelengths and the tint
/// of the percentages.
void read_spectral(ScatterText& text, std::array<SpeosSide, 2>& sides, bool are_bsdf, SpeosTables& tables) {
    const std::size_t n_incidences = text.count("number of incidences", k_max_incidences),
                      n_wavelengths = text.count("number of wavelengths", k_max_percents);
    const auto incidences = text.angles("incidence", n_incidences, 0, 90);
    std::vector<float> wavelength;
    for (std::size_t k = 0; k < n_wavelengths && !text.error(); ++k)
        wavelength.push_back(text.number<float>("wavelength"));
    if (!text.error() && !are_wavelengths(wavelength)) text.fail("wavelengths", "increasing numbers in nm", "");
    for (std::size_t s = 0; s < 2 && !text.error(); ++s) {
        if (!sides[s].is_there) continue;
        ScatterTable& table = tables[s].emplace();
        table.transmission = s == 1, table.rotation = {0};
        std::vector<float> percent(n_wavelengths);
        for (const float theta : incidences)
            for (std::size_t k = 0; k < n_wavelengths && !text.error(); ++k) {
                const float fraction = speos_percentage(text);
                ScatterTable::Slice slice = read_speos_slice(text, sides[s], theta, are_bsdf);
                if (text.error()) return;
                percent[k] += fraction / float(n_incidences);
                const double scale = speos_scale(scatter_integral(table, slice), double(fraction) / 100);
                for (float& f : slice.f) f = float(scale / double(n_wavelengths) * double(f));
                if (k == 0) {
                    table.slices.push_back(std::move(slice));
                    continue;
                }
                ScatterTable::Slice& mean = table.slices.back();
                if (slice.polar != mean.polar || slice.azimuth != mean.azimuth)
                    return text.fail("angles", "those of the first wavelength",
                                     fmt::format("other ones at {:g} nm", wavelength[k]));
                for (std::size_t i = 0; i < mean.f.size(); ++i) mean.f[i] += slice.f[i];
            }
        table.first = {0, std::uint32_t(table.slices.size())};
        mask_gaps(table);
        if (n_wavelengths > 1) tint_speos(table, wavelength, percent);
    }
}

}  // namespace

bool is_speos(std::string_view text) {
    return text.starts_with(k_anisotropic_title) || text.starts_with(k_spectral_title);
}

Result<std::array<std::optional<ScatterTable>, 2>> read_speos(std::span<const std::byte> bytes,
                                                              const std::string& file_name) {
    const StandardArithmetic mode;
    ScatterText text(as_text(bytes), file_name, false);
    const auto title = text.raw_line();
    const bool is_spectral = title.starts_with(k_spectral_title);
    if (!is_speos(title)) text.fail("title", std::string(k_anisotropic_title), quoted(title));
    if (const auto flag = text.raw_line(); flag != "0")
        text.fail("second line", "0, a file of text", flag.starts_with('1') ? "1, a binary file" : quoted(flag));
    text.raw_line();  // a comment
    const auto length = text.number<std::uint32_t>("length of the description");
    text.raw_line();
    text.skip(length);
    text.raw_line();
    for (int i = 0; i < 3 && !is_spectral; ++i) text.number<double>("anisotropy vector");
    std::array<SpeosSide, 2> sides;
    for (std::size_t s = 0; s < 2; ++s) {
        sides[s].is_there = text.number<int>("flags of reflection and transmission") != 0;
        sides[s].is_transmission = s == 1;
    }
    const int type = text.number<int>("type of values");
    if (!text.error() && !(type == 0 || type == 1)) text.fail("type of values", "0 or 1", fmt::format("{}", type));
    if (!text.error() && !sides[0].is_there && !sides[1].is_there)
        text.fail("flags", "reflection or transmission", "neither");
    SpeosTables tables;
    (is_spectral ? read_spectral : read_anisotropic)(text, sides, type == 1, tables);
    if (text.error()) return *text.error();
    for (const auto& table : tables)
        if (table)
            if (auto error = check_values(*table, file_name)) return *std::move(error);
    // Files by wavelength from other software omit the end.
    if (const auto word = text.word(); word != "End" && !(is_spectral && word.empty()))
        text.fail("data", "End of file", word.empty() ? "the end of the file" : quoted(word));
    if (text.error()) return *text.error();
    return tables;
}

std::string write_speos(std::span<const ScatterTable* const> tables) {
    const auto has = [&](bool transmission) {
        return std::ranges::any_of(tables,
                                   [&](const ScatterTable* table) { return table->transmission == transmission; });
    };
    std::string text = fmt::format("{} v8.0\n0\nBSDF by srbf\n0\n\n1\t0\t0\n{}\t{}\n1\n", k_anisotropic_title,
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
        const double percent = 100 * scatter_integral(*table, table->slices.front());
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

Result<Measured> read_as_speos(std::span<const std::byte> bytes, const std::string& file_name, const ReadOptions&) {
    auto tables = read_speos(bytes, file_name);
    if (!tables) return tables.error();
    return measured_of(*std::move(tables), file_name, "Speos");
}

Result<std::vector<std::byte>> write_as_speos(const TableSource& source, const TableOptions& options) {
    const auto tables = scatter_tables(source, false, options.threads);
    std::vector<const ScatterTable*> pointers;
    for (const ScatterTable& table : tables) pointers.push_back(&table);
    return bytes_of(write_speos(pointers));
}

}  // namespace
