#include "measured/samples.h"

#include <algorithm>

#include "brdf/directions.h"
#include "measured/bytes.h"

namespace SRBF_NAMESPACE {

Result<ScatteredSamples> samples_of_rows(std::vector<SpectralRow>& rows, std::size_t bytes,
                                         const std::string& file_name, std::string description, bool isotropic) {
    std::vector<float> wavelengths, values;
    for (const SpectralRow& row : rows) values.push_back(row[k_value_column]);
    std::vector<std::string> notes;
    mask_missing(values, 1, &notes);
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i][k_value_column] = values[i];
    std::vector<float>().swap(values);
    std::ranges::sort(rows, {}, [](const SpectralRow& row) { return row[k_wavelength_column]; });
    for (const SpectralRow& row : rows)
        if (wavelengths.empty() || row[k_wavelength_column] != wavelengths.back())
            wavelengths.push_back(row[k_wavelength_column]);
    if (wavelengths.size() > k_max_columns || !are_wavelengths(wavelengths))
        return Error{file_name, {}, "wavelengths", fmt::format("at most {}, from 1e-7 to 1e-4 m", k_max_columns), {}};
    // Ties are ordered by their bits, so that sums have a fixed order; a number may be NaN.
    const auto key = [](const SpectralRow& row) {
        return std::array{std::bit_cast<std::uint32_t>(row[k_value_column]),
                          std::bit_cast<std::uint32_t>(row[k_weight_column])};
    };
    std::ranges::sort(rows, [&](const SpectralRow& a, const SpectralRow& b) {
        const auto [element_a, element_b] = std::mismatch(a.begin(), a.begin() + k_value_column, b.begin());
        return element_a == a.begin() + k_value_column ? key(a) < key(b) : *element_a < *element_b;
    });
    const std::size_t n = wavelengths.size();
    // The rows use memory beside the samples, so the limit for these is lower.
    SampleBuilder builder(Values::spectrum, wavelengths, bytes / 2, rows.size() / n + 1);
    std::vector<float> sum(n), count(n);
    for (std::size_t i = 0; i < rows.size();) {
        std::ranges::fill(sum, 0.f), std::ranges::fill(count, 0.f);
        const SpectralRow& first_row = rows[i];
        float weight = 0, number = 0;
        for (;
             i < rows.size() && std::equal(first_row.begin(), first_row.begin() + k_wavelength_column, rows[i].begin());
             ++i) {
            const auto k =
                std::size_t(std::ranges::lower_bound(wavelengths, rows[i][k_wavelength_column]) - wavelengths.begin());
            sum[k] += rows[i][k_value_column], ++count[k];
            weight += rows[i][k_weight_column], ++number;
        }
        for (std::size_t k = 0; k < n; ++k) sum[k] = count[k] > 0 ? sum[k] / count[k] : k_nan;
        builder.add(spherical(double(first_row[0]), double(first_row[1])),
                    spherical(double(first_row[2]), double(first_row[3])), sum, weight / number);
    }
    auto samples = std::move(builder).finish(file_name, std::move(description), isotropic);
    if (samples) samples->notes.insert(samples->notes.begin(), notes.begin(), notes.end());
    return samples;
}

}  // namespace
