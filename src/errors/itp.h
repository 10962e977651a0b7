// The colour space of ΔE_ITP, a difference of colours (ITU-R BT.2100 and BT.2124).
#pragma once
#include <array>

#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {

using Matrix3 = std::array<std::array<double, 3>, 3>;
/// The matrix product a b, times `factor`.
constexpr Matrix3 product(const Matrix3& a, const Matrix3& b, double factor) {
    Matrix3 c{};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
            for (std::size_t k = 0; k < 3; ++k) c[i][j] += factor * a[i][k] * b[k][j];
    return c;
}
/// The matrix from linear sRGB to BT.2020 (BT.2087) and on to LMS.
inline constexpr Matrix3 k_to_lms = product({{{1688, 2146, 262}, {683, 2951, 462}, {99, 309, 3688}}},
                                            {{{0.627403896, 0.329283038, 0.043313066},
                                              {0.069097289, 0.919540395, 0.011362316},
                                              {0.016391439, 0.088013308, 0.895595253}}},
                                            1.0 / 4096);
/// The matrix from encoded LMS to I, C_T, C_P and on to the scaled coordinates of ΔE_ITP.
inline constexpr Matrix3 k_to_itp =
    product({{{720, 0, 0}, {0, 360, 0}, {0, 0, 720}}}, {{{2048, 2048, 0}, {6610, -13613, 7003}, {17933, -17390, -543}}},
            1.0 / 4096);

#include "errors/itp.inl"

}  // namespace
