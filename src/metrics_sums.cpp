#include "metrics_sums.h"

#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "metrics_sums.cpp"
#include <hwy/foreach_target.h>

#include "batch-inl.h"

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

void see(const PairCosines& cosines, SeenValues& seen) {
    for (std::size_t i = 0; i < k_pair_block; i += Batch::size()) {
        const Batch f = Batch::load(&seen.f[i]), lit = f * Batch::load(&cosines.light[i]);
        log_of_1_plus(lit).store(&seen.logarithm[i]);
        cube_root(f).store(&seen.root[i]);
        sqrt(cube_root(lit)).store(&seen.sixth_root[i]);
    }
}

using Doubles = hn::ScalableTag<double>;
using DoubleBatch = hn::Vec<Doubles>;

HWY_INLINE DoubleBatch load(const PairColumn& column, std::size_t i) {
    return hn::PromoteTo(Doubles(), hn::Load(hn::Rebind<float, Doubles>(), &column[i]));
}

// A SquareSums in lanes.
struct SquareLanes {
    DoubleBatch apart, whole;

    HWY_INLINE SquareLanes() : apart(hn::Zero(Doubles())), whole(apart) {}
    HWY_INLINE void add(DoubleBatch weight, DoubleBatch apart_squared, DoubleBatch x_squared) {
        apart = hn::MulAdd(weight, apart_squared, apart);
        whole = hn::MulAdd(weight, x_squared, whole);
    }
    HWY_INLINE SquareSums sum() const {
        const Doubles d;
        return {hn::GetLane(hn::SumOfLanes(d, apart)), hn::GetLane(hn::SumOfLanes(d, whole))};
    }
};

ErrorSums error_sums(const PairCosines& cosines, const PairColumn& weight, const SeenValues& f,
                     const SeenValues& other) {
    const Doubles d;
    SquareLanes plain, cosine, logarithm, root, sixth_root;
    DoubleBatch whole_area = hn::Zero(d);
    for (std::size_t i = 0; i < k_pair_block; i += hn::Lanes(d)) {
        const DoubleBatch w = load(weight, i), cos_l = load(cosines.light, i);
        const auto counts = hn::Gt(w, hn::Zero(d));
        const DoubleBatch area = hn::Mul(w, load(cosines.viewer, i));
        const auto square_where_counted = [&](DoubleBatch x)
                                              HWY_ATTR { return hn::IfThenElseZero(counts, hn::Mul(x, x)); };
        const auto add = [&](DoubleBatch factor, const PairColumn& x, const PairColumn& y, SquareLanes& sums) HWY_ATTR {
            const DoubleBatch a = load(x, i);
            sums.add(factor, square_where_counted(hn::Sub(a, load(y, i))), square_where_counted(a));
        };
        add(w, f.f, other.f, plain);
        add(hn::Mul(area, hn::Mul(cos_l, cos_l)), f.f, other.f, cosine);
        add(area, f.logarithm, other.logarithm, logarithm);
        add(w, f.root, other.root, root);
        add(area, f.sixth_root, other.sixth_root, sixth_root);
        whole_area = hn::Add(whole_area, area);
    }
    return {plain.sum(), cosine.sum(),     logarithm.sum(),
            root.sum(),  sixth_root.sum(), hn::GetLane(hn::SumOfLanes(d, whole_area))};
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
