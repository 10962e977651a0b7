// The sums of which error measures consist, over blocks of pairs of directions. Float SIMD within a block, and
// sums in double.
#pragma once
#include <array>
#include <cstddef>

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

/// Σ w (x − x̂)² and Σ w x²; of `decades` the second is Σ w.
struct SquareSums {
    double apart = 0, whole = 0;
    SquareSums& operator+=(const SquareSums& s) {
        apart += s.apart, whole += s.whole;
        return *this;
    }
};
inline constexpr double k_least_share = 1e-6;
struct ErrorSums {
    SquareSums plain, cosine, logarithm, root, sixth_root;
    SquareSums decades;  ///< of log f, over the pairs where f > 0; f̂ is at least `k_least_share` of f
    double area = 0;     ///< Σ w cosθv
    ErrorSums& operator+=(const ErrorSums& s) {
        plain += s.plain, cosine += s.cosine, logarithm += s.logarithm, root += s.root, sixth_root += s.sixth_root;
        decades += s.decades;
        area += s.area;
        return *this;
    }
};
/// The sums over a channel of f and of f̂ with the weights w ≥ 0. Where w is 0 the values may be anything, the cosines
/// any finite numbers. All but `plain`, `root` and `decades` weigh the pairs by w cosθv.
ErrorSums error_sums(const PairCosines& cosines, const PairColumn& weight, const SeenValues& f,
                     const SeenValues& other);

}  // namespace srbf
