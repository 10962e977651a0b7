// The sums of error measures over blocks of pairs of directions: SIMD, with values in float and sums in double.
#pragma once
#include <cstddef>

#include "errors/measures.h"
#include "srbf/metrics.h"

namespace SRBF_NAMESPACE {

/// A number for each pair of a block, aligned for SIMD.
struct alignas(64) PairColumn : std::array<float, 256> {};
inline constexpr std::size_t k_pair_block = PairColumn().size();

struct PairCosines {
    PairColumn light, viewer;
};

/// One channel of f at the pairs of a block, and the functions of f that measures compare.
struct TransformedValues {
    PairColumn f;
    PairColumn log_1_plus;  ///< log(1 + f cosθl)
    PairColumn root;        ///< ∛f
    PairColumn sixth_root;  ///< ⁶√(f cosθl)
    PairColumn logarithm;   ///< log f; for f ≤ 2⁻¹²⁰ log 2⁻¹²⁰
};
/// Computes the other members from `f`, with a relative error of 1e-6 for numbers above 1e-36.
void transform(const PairCosines& cosines, TransformedValues& values);

/// The two sums of a measure: Σ w (x − x̂)², and Σ w x² or Σ w.
struct SquareSums {
    double error = 0, reference = 0;
};
/// Where log f and log f̂ are compared, f̂ counts as at least this fraction of f.
inline constexpr double k_log_floor = 1e-6;
/// The sums of all measures, in the order of `k_measures`, and the numbers of pairs.
struct ErrorSums {
    std::array<SquareSums, k_measures.size()> measures = {};
    std::uint64_t pairs = 0, masked = 0;
    ErrorSums& operator+=(const ErrorSums& other) {
        for (std::size_t m = 0; m < measures.size(); ++m) {
            measures[m].error += other.measures[m].error;
            measures[m].reference += other.measures[m].reference;
        }
        pairs += other.pairs, masked += other.masked;
        return *this;
    }
};
/// The sums over a channel of f and of f̂ with weights w ≥ 0. Where w = 0, values may be NaN, but cosines must be
/// finite.
ErrorSums error_sums(const PairCosines& cosines, const PairColumn& weight, const TransformedValues& f,
                     const TransformedValues& other);

}  // namespace
