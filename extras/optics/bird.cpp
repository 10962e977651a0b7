// BRDFs of national metrology institutes in JSON, in the format of the project BiRD.

#include "base/floating_point.h"
#include "extras/optics/formats.h"
#include "extras/optics/json_rows.h"
#include "measured/bytes.h"
#include "measured/samples.h"

namespace SRBF_NAMESPACE {
namespace {

/// The arrays of "data" that are read, in the order of a row. Each has one number for each point.
constexpr std::array<std::string_view, std::tuple_size_v<SpectralRow>> k_names{
    "theta_i", "phi_i", "theta_r", "phi_r", "wavelength_i", "BRDF", "uBRDF"};

/// Collects "unit" and "values" of these arrays in "data", and "description" in "metadata", and ignores everything
/// else.
struct BirdRows : JsonRows {
    struct Array {
        std::string unit;
        std::vector<float> values;
    };
    std::string description;
    std::array<Array, k_names.size()> arrays;
    Array* filled = nullptr;  ///< the array that receives numbers

    /// The array whose object is open.
    Array* array() {
        if (path.size() != 3 || path[1] != "data") return nullptr;
        const auto column = std::ranges::find(k_names, path[2]);
        return column == k_names.end() ? nullptr : &arrays[std::size_t(column - k_names.begin())];
    }
    bool take(double x) override {
        if (filled) filled->values.push_back(float(x));
        return true;
    }
    bool take_text(const std::string& text) override {
        if (filled) return refuse("a text among values");
        if (Array* target = array(); target && last_key == "unit") target->unit = text.substr(0, 20);
        if (path.size() == 2 && path[1] == "metadata" && last_key == "description") description = text.substr(0, 200);
        return true;
    }
    bool open(bool is_array) override {
        if (filled) return refuse("something else than numbers among values");
        Array* const target = array();
        if (!is_array || !target || last_key != "values") return true;
        if (!target->values.empty()) return refuse("the same values again");
        filled = target;
        return true;
    }
    bool close(bool) override { return filled = nullptr, true; }
};

/// The factor that converts values to radians, nanometres or 1/sr; 0: unknown unit.
double factor_of(std::size_t column, const std::string& unit) {
    switch (column) {
        case k_wavelength_column:
            return unit == "nm" ? 1 : unit == "\u03bcm" || unit == "\u00b5m" ? 1000 : 0;  // Greek mu, micro sign
        case k_value_column:
            return unit == "1/sr" || unit == "sr^-1" ? 1 : 0;
        case k_weight_column:
            return unit == "1/sr" || unit == "sr^-1" ? 1 : unit == "%" ? 0.01 : 0;
        default:
            return unit == "rad" ? 1 : unit == "deg" || unit == "\u00b0" ? k_degree : 0;
    }
}

/// Computes the weights of rows, which hold their relative uncertainties u so far: 2 / (1 + (u / ū)²) with the
/// median ū, so that no row weighs more than twice as much as a typical one. An unknown uncertainty counts as ū.
void weigh(std::vector<SpectralRow>& rows) {
    std::vector<float> known;
    for (const SpectralRow& row : rows)
        if (row[k_weight_column] > 0 && std::isfinite(row[k_weight_column])) known.push_back(row[k_weight_column]);
    const auto middle = known.begin() + std::ptrdiff_t(known.size() / 2);
    if (!known.empty()) std::nth_element(known.begin(), middle, known.end());
    for (SpectralRow& row : rows) {
        float& u = row[k_weight_column];
        const double ratio = known.empty() || !std::isfinite(u) ? 1 : double(u) / double(*middle);
        u = float(2 / (1 + ratio * ratio));
    }
}

}  // namespace

bool is_bird(std::string_view text) {
    const auto first = text.find_first_not_of(" \t\r\n\xef\xbb\xbf");
    const std::string_view head = text.substr(0, 4096);
    return first != text.npos && text[first] == '{' &&
           (head.find("brdf_json_schema") != head.npos || head.find("\"theta_i\"") != head.npos);
}

Result<ScatteredSamples> read_bird(std::span<const std::byte> bytes, const std::string& file_name) {
    BirdRows sax;
    const std::string_view text = as_text(bytes);
    const auto error = [&](std::string what, std::string expected, std::string found) {
        return Error{file_name, {}, std::move(what), std::move(expected), std::move(found)};
    };
    if (!nlohmann::json::sax_parse(text.begin(), text.end(), &sax))
        return error("BiRD", "JSON with arrays of numbers in data", sax.wrong);
    const std::size_t n = sax.arrays[k_value_column].values.size();
    for (std::size_t c = 0; c < k_names.size(); ++c) {
        auto& [unit, values] = sax.arrays[c];
        const std::string name(k_names[c]);
        if (c == k_weight_column && values.empty()) continue;
        if (values.empty() || values.size() != n)
            return error("data." + name, fmt::format("{} values", n ? fmt::format("{}", n) : "some"),
                         fmt::format("{}", values.size()));
        const double factor = factor_of(c, unit);
        if (!(factor > 0)) return error("unit of data." + name, "one of the format", srbf::quoted(unit));
        if (c < k_wavelength_column)
            for (std::size_t i = 0; i < n; ++i)
                if (auto expected =
                        expected_angle(k_angle_kinds[c], double(values[i]), factor == 1 ? k_in_radians : k_in_degrees);
                    !expected.empty())
                    return error(fmt::format("data.{}, value {}", name, i + 1), std::move(expected),
                                 fmt::format("{:g}", values[i]));
        for (float& x : values) x = float(double(x) * factor);
        if (c <= k_wavelength_column && !std::ranges::all_of(values, [](float x) { return std::isfinite(x); }))
            return error("data." + name, "finite numbers", "");
    }
    std::vector<SpectralRow> rows(n);
    const auto& u = sax.arrays[k_weight_column];
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t c = 0; c < k_weight_column; ++c) rows[i][c] = sax.arrays[c].values[i];
        rows[i][k_weight_column] = u.values.empty() ? k_nan
                                   : u.unit == "%"  ? u.values[i]
                                                    : u.values[i] / std::abs(rows[i][k_value_column]);
    }
    for (auto& [unit, values] : sax.arrays) std::vector<float>().swap(values);
    weigh(rows);
    return samples_of_rows(rows, bytes.size(), file_name, std::move(sax.description));
}

}  // namespace
