// The sums of which error measures consist, over blocks of pairs of directions. Float SIMD within a block, and
// sums in double.
#pragma once
#include <array>
#include <cstddef>

#include "errors/measure_names.h"
#include "srbf/metrics.h"

namespace srbf {

/// A number for each pair of a block, aligned for SIMD.
struct alignas(64) PairColumn : std::array<float, 256> {};
inline constexpr std::size_t k_pair_block = PairColumn().size();

/// The cosines of the pairs of a block.
struct PairCosines {
    PairColumn light, viewer;
};

/// One channel of f at the pairs of a block, and as the measures other than squares see it.
struct SeenValues {
    PairColumn f;
    PairColumn logarithm, root, sixth_root;  ///< log(1 + f cosθl), ∛f, ⁶√(f cosθl)
    PairColumn own_logarithm;                ///< log f, of f ≤ 0 a number below all others
};
/// Computes the rest of `seen` from its f: relative error 1e-6 for numbers above 1e-36.
void see(const PairCosines& cosines, SeenValues& seen);

/// The two sums of a measure: Σ w (x − x̂)², and Σ w x² or Σ w.
struct SquareSums {
    double error = 0, reference = 0;
};
inline constexpr double k_least_share = 1e-6;  // of f, that f̂ counts as at least where logarithms are compared
/// For each row of `k_measures`.
struct ErrorSums {
    std::array<SquareSums, k_measures.size()> of;
    ErrorSums& operator+=(const ErrorSums& s) {
        for (std::size_t m = 0; m < of.size(); ++m) of[m].error += s.of[m].error, of[m].reference += s.of[m].reference;
        return *this;
    }
};
/// The sums over a channel of f and of f̂ with the weights w ≥ 0. Where w is 0 the values may be anything, the cosines
/// any finite numbers.
ErrorSums error_sums(const PairCosines& cosines, const PairColumn& weight, const SeenValues& f,
                     const SeenValues& other);

}  // namespace srbf
