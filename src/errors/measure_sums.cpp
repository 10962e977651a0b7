#include "errors/measure_sums.h"

#include <limits>

#include "srbf/elementary.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "errors/measure_sums.cpp"
#include <hwy/foreach_target.h>

#include "brdf/batch-inl.h"

HWY_BEFORE_NAMESPACE();
namespace SRBF_NAMESPACE {
namespace HWY_NAMESPACE {

static_assert(k_pair_block % (HWY_MAX_BYTES / sizeof(float)) == 0);

HWY_INLINE BatchMask is_below_infinity(Batch a) { return a < Batch(std::numeric_limits<float>::infinity()); }

// log(1 + x); NaN for x <= -1.
HWY_INLINE Batch log_of_1_plus(Batch x) {
    const Batch logarithm = select(is_below_infinity(x), log1p(x), x);
    return select(Batch(-1.0) < x, logarithm, Batch(std::numeric_limits<double>::quiet_NaN()));
}

// The cube root of x; x itself if |x| is infinite or below 2^-120. Two steps of Halley's method, as in
// elementary::cbrt.
HWY_INLINE Batch cube_root(Batch x) {
    const Batch::Bits bits;
    const Batch size = hn::Abs(x.v), quarter = Batch(0.25) * size;  // a quarter, since size + 2 y^3 may overflow
    const Batch third = Batch(hn::ConvertTo(Lanes(), hn::BitCast(bits, size.v))) * Batch(1 / 3.0) + Batch(0x2a508935);
    Batch y = hn::BitCast(Lanes(), hn::ConvertTo(bits, third.v));
    for (int i = 0; i < 2; ++i) {
        const Batch cube = Batch(0.25) * y * y * y;
        y = y + y * ((quarter - cube) / (quarter + cube + cube));
    }
    const Batch root = hn::CopySign(y.v, x.v);
    return select(Batch(0x1p-120) < size, select(is_below_infinity(size), root, x), x);
}

// log x, or log 2^-120 for smaller x.
HWY_INLINE Batch bounded_log(Batch x) {
    const Batch positive = select(Batch(0x1p-120) < x, x, Batch(0x1p-120));
    return select(is_below_infinity(x), log(positive), x);
}

void transform(const PairCosines& cosines, TransformedValues& values) {
    for (std::size_t i = 0; i < k_pair_block; i += Batch::size()) {
        const Batch f = Batch::load(&values.f[i]), f_cosine = f * Batch::load(&cosines.light[i]);
        log_of_1_plus(f_cosine).store(&values.log_1_plus[i]);
        cube_root(f).store(&values.root[i]);
        sqrt(cube_root(f_cosine)).store(&values.sixth_root[i]);
        bounded_log(f).store(&values.logarithm[i]);
    }
}

using Doubles = hn::ScalableTag<double>;
using DoubleBatch = hn::Vec<Doubles>;

HWY_INLINE DoubleBatch load(const PairColumn& column, std::size_t i) {
    return hn::PromoteTo(Doubles(), hn::Load(hn::Rebind<float, Doubles>(), &column[i]));
}

// A sum in eight lanes: lane k sums the numbers k, k + 8, k + 16, ..., whatever the width of a vector.
constexpr std::size_t k_lanes = 8;
HWY_INLINE double sum_of(const double* lanes) {
    return ((lanes[0] + lanes[4]) + (lanes[2] + lanes[6])) + ((lanes[1] + lanes[5]) + (lanes[3] + lanes[7]));
}
// The two sums of a measure, in the lanes of one vector.
struct SquareBatch {
    DoubleBatch error, reference;

    // GCC for ARM does not compile a constructor of its own for the instruction set.
    HWY_ATTR SquareBatch() : error(hn::Zero(Doubles())), reference(hn::Zero(Doubles())) {}
    HWY_INLINE void add(DoubleBatch weight, DoubleBatch squared_error, DoubleBatch squared_reference) {
        error = hn::Add(error, hn::Mul(weight, squared_error));
        reference = hn::Add(reference, hn::Mul(weight, squared_reference));
    }
};
ErrorSums error_sums(const PairCosines& cosines, const PairColumn& weight, const TransformedValues& f,
                     const TransformedValues& other) {
    constexpr Doubles d;
    const DoubleBatch one = hn::Set(d, 1.0);
    const double max_apart = -elementary::log(k_log_floor);
    HWY_ALIGN double error_lanes[k_measures.size()][k_lanes], reference_lanes[k_measures.size()][k_lanes];
    for (std::size_t lane = 0; lane < k_lanes; lane += hn::MaxLanes(d)) {
        SquareBatch sums[k_measures.size()];
        for (std::size_t i = lane; i < k_pair_block; i += k_lanes) {
            const DoubleBatch w = load(weight, i), cos_l = load(cosines.light, i);
            const auto counts = hn::Gt(w, hn::Zero(d));
            const DoubleBatch area = hn::Mul(w, load(cosines.viewer, i));
            const auto square_where_counted = [&](DoubleBatch x)
                                                  HWY_ATTR { return hn::IfThenElseZero(counts, hn::Mul(x, x)); };
            const auto squared_error = [&](PairColumn TransformedValues::*x) HWY_ATTR {
                return square_where_counted(hn::Sub(load(f.*x, i), load(other.*x, i)));
            };
            const auto ratio = [&](SquareBatch& sum, DoubleBatch factor, PairColumn TransformedValues::*x)
                                   HWY_ATTR { sum.add(factor, squared_error(x), square_where_counted(load(f.*x, i))); };
            static_assert(k_measures.size() == 6);  // one sum for each row, in the same order
            ratio(sums[0], w, &TransformedValues::f);
            ratio(sums[1], hn::Mul(area, hn::Mul(cos_l, cos_l)), &TransformedValues::f);
            sums[2].add(area, squared_error(&TransformedValues::log_1_plus), one);
            ratio(sums[3], w, &TransformedValues::root);
            ratio(sums[4], area, &TransformedValues::sixth_root);
            // log f where f > 0
            const DoubleBatch logarithm = load(f.logarithm, i);
            const DoubleBatch min = hn::Sub(logarithm, hn::Set(d, max_apart));
            const DoubleBatch error = hn::Sub(logarithm, hn::Max(load(other.logarithm, i), min));
            const auto is_above_0 = hn::And(counts, hn::Gt(load(f.f, i), hn::Zero(d)));
            sums[5].add(hn::IfThenElseZero(is_above_0, w), hn::IfThenElseZero(is_above_0, hn::Mul(error, error)), one);
        }
        for (std::size_t m = 0; m < k_measures.size(); ++m) {
            hn::Store(sums[m].error, d, &error_lanes[m][lane]);
            hn::Store(sums[m].reference, d, &reference_lanes[m][lane]);
        }
    }
    ErrorSums all;
    for (std::size_t m = 0; m < k_measures.size(); ++m)
        all.measures[m] = {sum_of(error_lanes[m]), sum_of(reference_lanes[m])};
    return all;
}

}  // namespace HWY_NAMESPACE
}  // namespace
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace SRBF_NAMESPACE {

HWY_EXPORT(transform);
HWY_EXPORT(error_sums);

void transform(const PairCosines& cosines, TransformedValues& values) {
    HWY_DYNAMIC_DISPATCH(transform)(cosines, values);
}
ErrorSums error_sums(const PairCosines& cosines, const PairColumn& weight, const TransformedValues& f,
                     const TransformedValues& other) {
    return HWY_DYNAMIC_DISPATCH(error_sums)(cosines, weight, f, other);
}

}  // namespace
#endif
