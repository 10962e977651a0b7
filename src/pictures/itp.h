// The colour space of ITU-R BT.2100 in which differences are seen: level 1.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

namespace srbf {

using Matrix3 = std::array<std::array<double, 3>, 3>;
constexpr Matrix3 product(const Matrix3& a, const Matrix3& b, double factor) {
    Matrix3 c{};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
            for (std::size_t k = 0; k < 3; ++k) c[i][j] += factor * a[i][k] * b[k][j];
    return c;
}

/// (I, C_T / 2, C_P) times 720, in which a distance is ΔE_ITP (ITU-R BT.2124), of a linear sRGB colour that is
/// displayed with white at 100 cd/m².
class Itp {
  public:
    using Triplet = std::array<double, 3>;
    using Matrix = Matrix3;

    explicit Itp(const Triplet& colour) {
        const Triplet lms = times(k_to_lms, colour);
        Triplet encoded;
        for (std::size_t i = 0; i < 3; ++i) std::tie(encoded[i], slope_[i]) = quantised(lms[i]);
        value_ = times(k_to_itp, encoded);
    }
    const Triplet& value() const { return value_; }
    /// Derivatives of the value, [of][by].
    Matrix by_colour() const {
        Matrix by{};
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t c = 0; c < 3; ++c)
                for (std::size_t k = 0; k < 3; ++k) by[i][c] += k_to_itp[i][k] * slope_[k] * k_to_lms[k][c];
        return by;
    }

  private:
    static Triplet times(const Matrix& m, const Triplet& x) {
        Triplet y;
        for (std::size_t i = 0; i < 3; ++i) y[i] = m[i][0] * x[0] + m[i][1] * x[1] + m[i][2] * x[2];
        return y;
    }
    /// The perceptual quantiser of `x` times 100 cd/m², and its derivative.
    static std::pair<double, double> quantised(double x) {
        constexpr double m1 = 2610.0 / 16384, m2 = 128 * 2523.0 / 4096, c1 = 3424.0 / 4096, c2 = 32 * 2413.0 / 4096,
                         c3 = 32 * 2392.0 / 4096, white = 100.0 / 10000, least = 1e-9;
        const double of = std::max(x, least) * white, y = std::pow(of, m1), ratio = (c1 + c2 * y) / (1 + c3 * y);
        const double encoded = std::pow(ratio, m2);
        const double slope =
            m2 * encoded / ratio * (c2 - c1 * c3) / ((1 + c3 * y) * (1 + c3 * y)) * m1 * y / of * white;
        return {encoded, slope};
    }
    static constexpr Matrix k_to_lms = product({{{1688, 2146, 262}, {683, 2951, 462}, {99, 309, 3688}}},
                                               {{{0.627403896, 0.329283038, 0.043313066},
                                                 {0.069097289, 0.919540395, 0.011362316},
                                                 {0.016391439, 0.088013308, 0.895595253}}},
                                               1.0 / 4096);
    static constexpr Matrix k_to_itp =
        product({{{720, 0, 0}, {0, 360, 0}, {0, 0, 720}}},
                {{{2048, 2048, 0}, {6610, -13613, 7003}, {17933, -17390, -543}}}, 1.0 / 4096);

    Triplet value_, slope_;
};

}  // namespace srbf
