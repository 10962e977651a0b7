// Low-discrepancy points.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {

/// The R_D sequence, low-discrepancy points in the D-dimensional unit cube: fractional parts of multiples of powers of
/// 1/g with g^(D+1) = g + 1 (Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018), offset by
/// `start`.
template <std::size_t D> class RSequence {
  public:
    explicit RSequence(const std::array<double, D>& start = {}) : current_(start) {
        double g = 1.5;
        for (int i = 0; i < 60; ++i) g = elementary::pow(1 + g, 1.0 / (D + 1));
        for (std::size_t d = 0; d < D; ++d) step_[d] = elementary::pow(1 / g, double(d + 1));
    }
    /// Point i after the current one, counted from 0.
    std::array<double, D> at(std::size_t i) const {
        std::array<double, D> point;
        for (std::size_t d = 0; d < D; ++d) point[d] = fraction(current_[d] + double(i + 1) * step_[d]);
        return point;
    }
    const std::array<double, D>& next() {
        for (std::size_t d = 0; d < D; ++d) current_[d] = fraction(current_[d] + step_[d]);
        return current_;
    }

  private:
    static double fraction(double x) { return x - double(std::int64_t(x)); }  // for x ≥ 0
    std::array<double, D> step_{}, current_{};
};

}  // namespace
