#include "errors/metrics_sums.h"

#include <limits>

#include "srbf/elementary.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "errors/metrics_sums.cpp"
#include <hwy/foreach_target.h>

#include "brdf/batch-inl.h"

HWY_BEFORE_NAMESPACE();
namespace srbf {
namespace HWY_NAMESPACE {

static_assert(k_pair_block % (HWY_MAX_BYTES / sizeof(float)) == 0);

HWY_INLINE BatchMask is_below_infinity(Batch a) { return a < Batch(std::numeric_limits<float>::infinity()); }

// log(1 + x), NaN where x <= -1.
HWY_INLINE Batch log_of_1_plus(Batch x) {
    const Batch of_all = select(is_below_infinity(x), log1p(x), x);
    return select(Batch(-1.0) < x, of_all, Batch(std::numeric_limits<double>::quiet_NaN()));
}

// The cube root of x, or x itself where |x| is infinite or below 2^-120: from a third of the exponent by Halley's
// iteration, twice.
HWY_INLINE Batch cube_root(Batch x) {
    const Batch::Bits bits;
    const Batch size = hn::Abs(x.v), quarter = Batch(0.25) * size;  // of all, since size + 2 y^3 may overflow
    const Batch third = Batch(hn::ConvertTo(Lanes(), hn::BitCast(bits, size.v))) * Batch(1 / 3.0) + Batch(0x2a508935);
    Batch y = hn::BitCast(Lanes(), hn::ConvertTo(bits, third.v));
    for (int i = 0; i < 2; ++i) {
        const Batch cube = Batch(0.25) * y * y * y;
        y = y + y * ((quarter - cube) / (quarter + cube + cube));
    }
    const Batch root = hn::CopySign(y.v, x.v);
    return select(Batch(0x1p-120) < size, select(is_below_infinity(size), root, x), x);
}

// log x; of x below 2^-120 that of 2^-120.
HWY_INLINE Batch log_of(Batch x) {
    const Batch positive = select(Batch(0x1p-120) < x, x, Batch(0x1p-120));
    return select(is_below_infinity(x), log(positive), x);
}

void see(const PairCosines& cosines, SeenValues& seen) {
    for (std::size_t i = 0; i < k_pair_block; i += Batch::size()) {
        const Batch f = Batch::load(&seen.f[i]), lit = f * Batch::load(&cosines.light[i]);
        log_of_1_plus(lit).store(&seen.logarithm[i]);
        cube_root(f).store(&seen.root[i]);
        sqrt(cube_root(lit)).store(&seen.sixth_root[i]);
        log_of(f).store(&seen.own_logarithm[i]);
    }
}

using Doubles = hn::ScalableTag<double>;
using DoubleBatch = hn::Vec<Doubles>;

HWY_INLINE DoubleBatch load(const PairColumn& column, std::size_t i) {
    return hn::PromoteTo(Doubles(), hn::Load(hn::Rebind<float, Doubles>(), &column[i]));
}

// A sum in eight lanes, of which lane k sums the numbers k, k + 8, k + 16, ..., as many at once as a vector holds.
struct LanesOfSum {
    HWY_ALIGN double lanes[8];
    HWY_INLINE double sum() const {
        return ((lanes[0] + lanes[4]) + (lanes[2] + lanes[6])) + ((lanes[1] + lanes[5]) + (lanes[3] + lanes[7]));
    }
};
// A SquareSums in such lanes, and those of them that a vector holds.
struct LanesOfSquares {
    LanesOfSum apart, whole;
    HWY_INLINE SquareSums sum() const { return {apart.sum(), whole.sum()}; }
};
struct SquareBatch {
    DoubleBatch apart, whole;

    HWY_INLINE SquareBatch() : apart(hn::Zero(Doubles())), whole(apart) {}
    HWY_INLINE void add(DoubleBatch weight, DoubleBatch apart_squared, DoubleBatch x_squared) {
        apart = hn::Add(apart, hn::Mul(weight, apart_squared));
        whole = hn::Add(whole, hn::Mul(weight, x_squared));
    }
    HWY_INLINE void store(LanesOfSquares& sums, std::size_t lane) const {
        hn::Store(apart, Doubles(), sums.apart.lanes + lane);
        hn::Store(whole, Doubles(), sums.whole.lanes + lane);
    }
};

ErrorSums error_sums(const PairCosines& cosines, const PairColumn& weight, const SeenValues& f,
                     const SeenValues& other) {
    constexpr Doubles d;
    const double most_apart = -elementary::log(k_least_share);
    LanesOfSquares plain, cosine, logarithm, root, sixth_root, decades;
    LanesOfSum whole_area;
    for (std::size_t lane = 0; lane < std::size(whole_area.lanes); lane += hn::MaxLanes(d)) {
        SquareBatch of_plain, of_cosine, of_logarithm, of_root, of_sixth_root, of_decades;
        DoubleBatch of_area = hn::Zero(d);
        for (std::size_t i = lane; i < k_pair_block; i += std::size(whole_area.lanes)) {
            const DoubleBatch w = load(weight, i), cos_l = load(cosines.light, i);
            const auto counts = hn::Gt(w, hn::Zero(d));
            const DoubleBatch area = hn::Mul(w, load(cosines.viewer, i));
            const auto square_where_counted = [&](DoubleBatch x)
                                                  HWY_ATTR { return hn::IfThenElseZero(counts, hn::Mul(x, x)); };
            const auto add = [&](DoubleBatch factor, const PairColumn& x, const PairColumn& y,
                                 SquareBatch& sums) HWY_ATTR {
                const DoubleBatch a = load(x, i);
                sums.add(factor, square_where_counted(hn::Sub(a, load(y, i))), square_where_counted(a));
            };
            add(w, f.f, other.f, of_plain);
            add(hn::Mul(area, hn::Mul(cos_l, cos_l)), f.f, other.f, of_cosine);
            add(area, f.logarithm, other.logarithm, of_logarithm);
            add(w, f.root, other.root, of_root);
            add(area, f.sixth_root, other.sixth_root, of_sixth_root);
            const DoubleBatch own = load(f.own_logarithm, i);
            const DoubleBatch least = hn::Sub(own, hn::Set(d, most_apart));
            const DoubleBatch apart = hn::Sub(own, hn::Max(load(other.own_logarithm, i), least));
            const auto is_above_0 = hn::And(counts, hn::Gt(load(f.f, i), hn::Zero(d)));
            of_decades.add(hn::IfThenElseZero(is_above_0, w), hn::IfThenElseZero(is_above_0, hn::Mul(apart, apart)),
                           hn::Set(d, 1.0));
            of_area = hn::Add(of_area, area);
        }
        of_plain.store(plain, lane), of_cosine.store(cosine, lane), of_logarithm.store(logarithm, lane);
        of_root.store(root, lane), of_sixth_root.store(sixth_root, lane);
        of_decades.store(decades, lane);
        hn::Store(of_area, d, whole_area.lanes + lane);
    }
    return {plain.sum(), cosine.sum(), logarithm.sum(), root.sum(), sixth_root.sum(), decades.sum(), whole_area.sum()};
}

}  // namespace HWY_NAMESPACE
}  // namespace srbf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace srbf {

HWY_EXPORT(see);
HWY_EXPORT(error_sums);

void see(const PairCosines& cosines, SeenValues& seen) { HWY_DYNAMIC_DISPATCH(see)(cosines, seen); }
ErrorSums error_sums(const PairCosines& cosines, const PairColumn& weight, const SeenValues& f,
                     const SeenValues& other) {
    return HWY_DYNAMIC_DISPATCH(error_sums)(cosines, weight, f, other);
}

}  // namespace srbf
#endif
