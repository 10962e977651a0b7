#include "brdf/colour.h"

#include <algorithm>
#include <cassert>

#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {

namespace {

/// Every 5 nm from 360 nm: x̄, ȳ, z̄ of CIE 1931 (2°), and the spectral power of D65.
constexpr int k_first = 360, k_step = 5;
constexpr std::size_t k_rows = 95;
constexpr double k_observer[k_rows][4] = {
#include "brdf/observer.csv"
};
constexpr int k_last = k_first + k_step * (int(k_rows) - 1);

/// D65 (x̄, ȳ, z̄) at an integer wavelength [nm] of the range, linear between the rows.
Xyz weighted_observer(int nm) {
    const std::size_t i = std::min(std::size_t((nm - k_first) / k_step), k_rows - 2);
    const double t = double(nm - k_first) / k_step - double(i);
    const auto weighted = [](const double(&row)[4]) { return Xyz{row[3] * row[0], row[3] * row[1], row[3] * row[2]}; };
    const Xyz a = weighted(k_observer[i]), b = weighted(k_observer[i + 1]);
    return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), a.z + t * (b.z - a.z)};
}

/// Σ D65 (x̄, ȳ, z̄) factor(nm) / Σ D65 ȳ over the range, in steps of 1 nm.
template <typename Factor> Xyz tristimulus(Factor factor) {
    Xyz sum;
    double total_y = 0;
    for (int nm = k_first; nm <= k_last; ++nm) {
        const Xyz weight = weighted_observer(nm);
        const double f = factor(nm);
        sum = {sum.x + f * weight.x, sum.y + f * weight.y, sum.z + f * weight.z};
        total_y += weight.y;
    }
    return {sum.x / total_y, sum.y / total_y, sum.z / total_y};
}

/// The inverse of the matrix of the primaries, scaled so that they sum to white (see `to_rgb`).
constexpr double k_rgb_of_xyz[3][3] = {{3.2407148205543104, -1.5372621584680703, -0.49857151085450924},
                                       {-0.96925666432303126, 1.8759927172355, 0.041555615967499598},
                                       {0.055635572153487439, -0.20399709789612042, 1.0570758709162607}};

/// R_r, R_g, R_b of `reflectance_spectrum` at k_primary_wavelengths.
constexpr float k_primaries[3][18] = {
    {0.05623f, 0.05598f, 0.05240f, 0.02935f, 0.00569f, 0, 0, 0, 0, 0, 0.13431f, 0.79719f, 1, 1, 1, 1, 1, 1},
    {0, 0, 0, 0, 0, 0.25793f, 0.74881f, 1, 1, 1, 0.79132f, 0.20281f, 0, 0, 0, 0, 0, 0},
    {0.94377f, 0.94402f, 0.94760f, 0.97065f, 0.99431f, 0.74207f, 0.25119f, 0, 0, 0, 0.07437f, 0, 0, 0, 0, 0, 0, 0}};

}  // namespace

Xyz white_point() {
    return tristimulus([](int) { return 1.0; });
}

Rgb to_rgb(const Xyz& colour) {
    const auto channel = [&](const double(&row)[3]) {
        return float(row[0] * colour.x + row[1] * colour.y + row[2] * colour.z);
    };
    return {channel(k_rgb_of_xyz[0]), channel(k_rgb_of_xyz[1]), channel(k_rgb_of_xyz[2])};
}

std::vector<Rgb> rgb_weights(std::span<const float> wavelengths) {
    assert(!wavelengths.empty());
    std::vector<Rgb> weights;
    for (std::size_t i = 0; i < wavelengths.size(); ++i) {
        const double centre = double(wavelengths[i]);
        // The hat function of a sample: 1 at its wavelength, 0 at its neighbours'. The first and the last are constant
        // beyond the range.
        const auto hat = [&](int nm) {
            const bool is_below = nm < centre;
            if (is_below ? i == 0 : i + 1 == wavelengths.size()) return 1.0;
            const double neighbour = double(wavelengths[is_below ? i - 1 : i + 1]);
            return std::max(0.0, 1 - (nm - centre) / (neighbour - centre));
        };
        weights.push_back(to_rgb(tristimulus(hat)));
    }
    return weights;
}

bool are_wavelengths(std::span<const float> wavelengths) {
    float last = 99.999f;
    for (const float nm : wavelengths) {
        if (!(nm > last && nm <= 1e5f)) return false;
        last = nm;
    }
    return !wavelengths.empty();
}

Rgb to_rgb(std::span<const float> spectrum, std::span<const Rgb> weights) {
    assert(spectrum.size() == weights.size());
    double sum[3] = {0, 0, 0};
    for (std::size_t i = 0; i < spectrum.size(); ++i)
        for (int c = 0; c < 3; ++c) sum[c] += double(spectrum[i]) * double(weights[i][c]);
    return {float(sum[0]), float(sum[1]), float(sum[2])};
}

double srgb_encoded(double x) { return x <= 0.0031308 ? 12.92 * x : 1.055 * elementary::pow(x, 1 / 2.4) - 0.055; }

double srgb_decoded(double x) { return x <= 0.04045 ? x / 12.92 : elementary::pow((x + 0.055) / 1.055, 2.4); }

std::array<float, 18> reflectance_spectrum(const Rgb& colour) {
    std::array<float, 18> spectrum{};
    for (std::size_t i = 0; i < spectrum.size(); ++i)
        spectrum[i] = colour.r * k_primaries[0][i] + colour.g * k_primaries[1][i] + colour.b * k_primaries[2][i];
    return spectrum;
}

}  // namespace
