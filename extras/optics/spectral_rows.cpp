#include "extras/optics/spectral_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstdint>

#include "brdf/directions.h"
#include "measured/limits.h"

namespace srbf {

Result<ScatteredSamples> samples_of_rows(std::vector<SpectralRow>& rows, std::size_t bytes,
                                         const std::string& file_name, std::string description, bool isotropic) {
    std::vector<float> wavelengths;
    std::ranges::sort(rows, {}, [](const SpectralRow& row) { return row[k_of_wavelength]; });
    for (const SpectralRow& row : rows)
        if (wavelengths.empty() || row[k_of_wavelength] != wavelengths.back())
            wavelengths.push_back(row[k_of_wavelength]);
    if (wavelengths.size() > k_most_columns || !are_wavelengths(wavelengths))
        return Error{
            file_name, {}, "wavelengths", fmt::format("at most {}, from 1e-7 to 1e-4 m", k_most_columns), "others"};
    // By bits where all else is equal, so that sums have one order; a number may be NaN.
    const auto key = [](const SpectralRow& row) {
        return std::array{std::bit_cast<std::uint32_t>(row[k_of_value]),
                          std::bit_cast<std::uint32_t>(row[k_of_weight])};
    };
    std::ranges::sort(rows, [&](const SpectralRow& a, const SpectralRow& b) {
        const auto [of_a, of_b] = std::mismatch(a.begin(), a.begin() + k_of_value, b.begin());
        return of_a == a.begin() + k_of_value ? key(a) < key(b) : *of_a < *of_b;
    });
    const std::size_t n = wavelengths.size();
    // Rows take memory beside the samples: less is left for these.
    SampleBuilder builder(Values::spectrum, wavelengths, bytes / 2, rows.size() / n + 1);
    std::vector<float> sum(n), count(n);
    for (std::size_t i = 0; i < rows.size();) {
        std::ranges::fill(sum, 0.f), std::ranges::fill(count, 0.f);
        const SpectralRow& at = rows[i];
        float weight = 0, number = 0;
        for (; i < rows.size() && std::equal(at.begin(), at.begin() + k_of_wavelength, rows[i].begin()); ++i) {
            const auto k =
                std::size_t(std::ranges::lower_bound(wavelengths, rows[i][k_of_wavelength]) - wavelengths.begin());
            sum[k] += rows[i][k_of_value], ++count[k];
            weight += rows[i][k_of_weight], ++number;
        }
        for (std::size_t k = 0; k < n; ++k) sum[k] = count[k] > 0 ? sum[k] / count[k] : k_nan;
        builder.add(spherical(double(at[0]), double(at[1])), spherical(double(at[2]), double(at[3])), sum,
                    weight / number);
    }
    return std::move(builder).finish(file_name, std::move(description), isotropic);
}

}  // namespace srbf
