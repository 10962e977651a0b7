#include "brdf/colour.h"

#include <algorithm>
#include <cassert>

#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {

namespace {

/// Every 5 nm from 360 nm: x̄, ȳ, z̄ of CIE 1931 (2°), and the spectral power of D65.
constexpr int k_first = 360, k_step = 5;
constexpr std::size_t k_rows = 95;
constexpr double k_observer[3][k_rows] = {
    {0.0001299,    0.0002321,    0.0004149,    0.0007416,    0.001368,     0.002236,     0.004243,     0.00765,
     0.01431,      0.02319,      0.04351,      0.07763,      0.13438,      0.21477,      0.2839,       0.3285,
     0.34828,      0.34806,      0.3362,       0.3187,       0.2908,       0.2511,       0.19536,      0.1421,
     0.09564,      0.05795001,   0.03201,      0.0147,       0.0049,       0.0024,       0.0093,       0.0291,
     0.06327,      0.1096,       0.1655,       0.2257499,    0.2904,       0.3597,       0.4334499,    0.5120501,
     0.5945,       0.6784,       0.7621,       0.8425,       0.9163,       0.9786,       1.0263,       1.0567,
     1.0622,       1.0456,       1.0026,       0.9384,       0.8544499,    0.7514,       0.6424,       0.5419,
     0.4479,       0.3608,       0.2835,       0.2187,       0.1649,       0.1212,       0.0874,       0.0636,
     0.04677,      0.0329,       0.0227,       0.01584,      0.01135916,   0.008110916,  0.005790346,  0.004109457,
     0.002899327,  0.00204919,   0.001439971,  0.0009999493, 0.0006900786, 0.0004760213, 0.0003323011, 0.0002348261,
     0.0001661505, 0.000117413,  8.307527e-05, 5.870652e-05, 4.150994e-05, 2.935326e-05, 2.067383e-05, 1.455977e-05,
     1.025398e-05, 7.221456e-06, 5.085868e-06, 3.581652e-06, 2.522525e-06, 1.776509e-06, 1.251141e-06},
    {3.917e-06,  6.965e-06,  1.239e-05,  2.202e-05,  3.9e-05,   6.4e-05,    0.00012,    0.000217,   0.000396,
     0.00064,    0.00121,    0.00218,    0.004,      0.0073,    0.0116,     0.01684,    0.023,      0.0298,
     0.038,      0.048,      0.06,       0.0739,     0.09098,   0.1126,     0.13902,    0.1693,     0.20802,
     0.2586,     0.323,      0.4073,     0.503,      0.6082,    0.71,       0.7932,     0.862,      0.9148501,
     0.954,      0.9803,     0.9949501,  1,          0.995,     0.9786,     0.952,      0.9154,     0.87,
     0.8163,     0.757,      0.6949,     0.631,      0.5668,    0.503,      0.4412,     0.381,      0.321,
     0.265,      0.217,      0.175,      0.1382,     0.107,     0.0816,     0.061,      0.04458,    0.032,
     0.0232,     0.017,      0.01192,    0.00821,    0.005723,  0.004102,   0.002929,   0.002091,   0.001484,
     0.001047,   0.00074,    0.00052,    0.0003611,  0.0002492, 0.0001719,  0.00012,    8.48e-05,   6e-05,
     4.24e-05,   3e-05,      2.12e-05,   1.499e-05,  1.06e-05,  7.4657e-06, 5.2578e-06, 3.7029e-06, 2.6078e-06,
     1.8366e-06, 1.2934e-06, 9.1093e-07, 6.4153e-07, 4.5181e-07},
    {0.0006061,    0.001086, 0.001946,    0.003486,    0.006450001, 0.01054999,  0.02005001, 0.03621, 0.06785001,
     0.1102,       0.2074,   0.3713,      0.6456,      1.03905,     1.3856,      1.62296,    1.74706, 1.7826,
     1.77211,      1.7441,   1.6692,      1.5281,      1.28764,     1.0419,      0.8129501,  0.6162,  0.46518,
     0.3533,       0.272,    0.2123,      0.1582,      0.1117,      0.07824999,  0.05725001, 0.04216, 0.02984,
     0.0203,       0.0134,   0.008749999, 0.005749999, 0.0039,      0.002749999, 0.0021,     0.0018,  0.001650001,
     0.0014,       0.0011,   0.001,       0.0008,      0.0006,      0.00034,     0.00024,    0.00019, 0.0001,
     4.999999e-05, 3e-05,    2e-05,       1e-05}};  // z̄ is 0 beyond
constexpr double k_d65[k_rows] = {
    46.6383, 49.3637, 52.0891, 51.0323, 49.9755, 52.3118, 54.6482, 68.7015, 82.7549, 87.1204, 91.486,  92.4589,
    93.4318, 90.057,  86.6823, 95.7736, 104.865, 110.936, 117.008, 117.41,  117.812, 116.336, 114.861, 115.392,
    115.923, 112.367, 108.811, 109.082, 109.354, 108.578, 107.802, 106.296, 104.79,  106.239, 107.689, 106.047,
    104.405, 104.225, 104.046, 102.023, 100,     98.1671, 96.3342, 96.0611, 95.788,  92.2368, 88.6856, 89.3459,
    90.0062, 89.8026, 89.5991, 88.6489, 87.6987, 85.4936, 83.2886, 83.4939, 83.6992, 81.863,  80.0268, 80.1207,
    80.2146, 81.2462, 82.2778, 80.281,  78.2842, 74.0027, 69.7213, 70.6652, 71.6091, 72.979,  74.349,  67.9765,
    61.604,  65.7448, 69.8856, 72.4863, 75.087,  69.3398, 63.5927, 55.0054, 46.4182, 56.6118, 66.8054, 65.0941,
    63.3828, 63.8434, 64.304,  61.8779, 59.4519, 55.7054, 51.959,  54.6998, 57.4406, 58.8765, 60.3125};
constexpr int k_last = k_first + k_step * (int(k_rows) - 1);

/// D65 (x̄, ȳ, z̄) at an integer wavelength [nm] of the range, linear between the rows.
Xyz weighted_observer(int nm) {
    const std::size_t i = std::min(std::size_t((nm - k_first) / k_step), k_rows - 2);
    const double t = double(nm - k_first) / k_step - double(i);
    const auto weighted = [](std::size_t k) {
        return Xyz{k_d65[k] * k_observer[0][k], k_d65[k] * k_observer[1][k], k_d65[k] * k_observer[2][k]};
    };
    const Xyz a = weighted(i), b = weighted(i + 1);
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

}  // namespace srbf
