// Evaluation of a multivariate model. Arrays of pairs use the formulas of kernel.glsl in SIMD batches; a single
// pair has its lobes in the lanes of a vector.
#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>

#include "models/pm/pm_lanes.h"
#include "srbf/models/pm.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "models/pm/evaluate.cpp"
#include <hwy/foreach_target.h>

#include "base/floating_point.h"
#include "brdf/batch-inl.h"
#include "models/pm/pm_functions.h"

HWY_BEFORE_NAMESPACE();
namespace SRBF_NAMESPACE {
namespace HWY_NAMESPACE {

// Two batches processed together, which hides latency.
struct TwoBatches {
    Batch a, b;
    TwoBatches() = default;
    HWY_INLINE TwoBatches(Batch a_, Batch b_) : a(a_), b(b_) {}
    HWY_INLINE explicit TwoBatches(double x) : a(x), b(x) {}
};
struct TwoMasks {
    BatchMask a, b;
};
HWY_INLINE TwoBatches operator+(TwoBatches x, TwoBatches y) { return {x.a + y.a, x.b + y.b}; }
HWY_INLINE TwoBatches operator-(TwoBatches x, TwoBatches y) { return {x.a - y.a, x.b - y.b}; }
HWY_INLINE TwoBatches operator*(TwoBatches x, TwoBatches y) { return {x.a * y.a, x.b * y.b}; }
HWY_INLINE TwoBatches operator/(TwoBatches x, TwoBatches y) { return {x.a / y.a, x.b / y.b}; }
HWY_INLINE TwoBatches operator-(TwoBatches x) { return {-x.a, -x.b}; }
HWY_INLINE TwoMasks operator<(TwoBatches x, TwoBatches y) { return {x.a < y.a, x.b < y.b}; }
HWY_INLINE TwoBatches exp(TwoBatches x) { return {exp(x.a), exp(x.b)}; }
HWY_INLINE TwoBatches exp2(TwoBatches x) { return {exp2(x.a), exp2(x.b)}; }
HWY_INLINE TwoBatches log(TwoBatches x) { return {log(x.a), log(x.b)}; }
HWY_INLINE TwoBatches sqrt(TwoBatches x) { return {sqrt(x.a), sqrt(x.b)}; }
HWY_INLINE TwoBatches inversesqrt(TwoBatches x) { return {inversesqrt(x.a), inversesqrt(x.b)}; }
HWY_INLINE TwoBatches min(TwoBatches x, TwoBatches y) { return {min(x.a, y.a), min(x.b, y.b)}; }
HWY_INLINE TwoBatches max(TwoBatches x, TwoBatches y) { return {max(x.a, y.a), max(x.b, y.b)}; }
HWY_INLINE TwoBatches select(TwoMasks where, TwoBatches x, TwoBatches y) {
    return {select(where.a, x.a, y.a), select(where.b, x.b, y.b)};
}

// A model for pm_value whose number of variates, kind and sides are known at compile time, so that loops are unrolled.
template <int N, bool is_axial, bool reciprocal> struct Sized {
    static constexpr int variates = N;
    static constexpr bool axial = is_axial, is_reciprocal = reciprocal;
    const PmLanes& numbers;
    PmForm form = numbers.form();
    int lobes = numbers.lobes();

    float at(int j, int row) const { return *PmLanes::row(numbers.lobe(j), row); }
    float weight_l(int n) const { return *numbers.weight_l(n); }
    float weight_v(int n) const { return *numbers.weight_v(n); }
    float log2_scale(int j) const { return at(j, PmLanes::log2_scale()); }
    float log2_falloff(int j, int n) const { return at(j, PmLanes::log2_falloff(axial, n)); }
    float exponent(int j, int k) const { return at(j, PmLanes::exponent(axial, N, k)); }
    bool down(int j, int n) const { return std::bit_cast<std::int32_t>(at(j, PmLanes::pole(n))) < 0; }
    Vec3f centre(int j, int n) const {
        return {at(j, PmLanes::centre(n, 0)), at(j, PmLanes::centre(n, 1)), at(j, PmLanes::centre(n, 2))};
    }
    Vec3f coefficient(int j) const {
        return {at(j, PmLanes::coefficient(0)), at(j, PmLanes::coefficient(1)), at(j, PmLanes::coefficient(2))};
    }
};

static_assert(sizeof(Vec3f) == 3 * sizeof(float) && sizeof(Rgb) == 3 * sizeof(float));

// `count` must be a multiple of two batches.
template <int N, bool axial, bool reciprocal>
void evaluate_sized(const PmLanes& model, const Vec3f* wl, const Vec3f* wv, Rgb* f, std::size_t count) {
    using Model = Sized<N, axial, reciprocal>;
    const Model sized{model};
    const std::size_t width = Batch::size();
    const TwoBatches zero(0.0);
    for (std::size_t i = 0; i < count; i += 2 * width) {
        const Vec3<Batch> la = load_triples(&wl[i].x), lb = load_triples(&wl[i + width].x), va = load_triples(&wv[i].x),
                          vb = load_triples(&wv[i + width].x);
        const Vec3<TwoBatches> l({la.x, lb.x}, {la.y, lb.y}, {la.z, lb.z}), v({va.x, vb.x}, {va.y, vb.y}, {va.z, vb.z});
        const TwoMasks above{above_horizon(la, va), above_horizon(lb, vb)};
        const Vec3<TwoBatches> value = Formulas<TwoBatches, Model>::pm_value(sized, l, v);
        const TwoBatches r = select(above, value.x, zero), g = select(above, value.y, zero),
                         b = select(above, value.z, zero);
        store_triples({r.a, g.a, b.a}, &f[i].r);
        store_triples({r.b, g.b, b.b}, &f[i + width].r);
    }
}

/// Calls choose.operator()<N, axial>() for the model's N and kind.
template <int N = 1, typename Choose> auto for_size_of(const PmLanes& model, const Choose& choose) {
    if constexpr (N < k_max_variates)
        if (model.variates() > N) return for_size_of<N + 1>(model, choose);
    if constexpr (PmLanes::padded_variates(N, false) == N)
        if (!model.axial()) return choose.template operator()<N, false>();
    return choose.template operator()<PmLanes::padded_variates(N, true), true>();
}

using Evaluator = void (*)(const PmLanes&, const Vec3f*, const Vec3f*, Rgb*, std::size_t);
Evaluator evaluator_of(const PmLanes& model) {
    return for_size_of(model, [&]<int N, bool axial>() -> Evaluator {
        return is_reciprocal(model.form()) ? evaluate_sized<N, axial, true> : evaluate_sized<N, axial, false>;
    });
}

void evaluate(const PmLanes& model, const Vec3f* wl, const Vec3f* wv, Rgb* f, std::size_t count) {
    const Evaluator evaluator = evaluator_of(model);
    evaluate_padded(2 * Batch::size(), wl, wv, f, count,
                    [&](const Vec3f* batch_wl, const Vec3f* batch_wv, Rgb* batch_f, std::size_t n)
                        HWY_ATTR { evaluator(model, batch_wl, batch_wv, batch_f, n); });
}

// A model whose lobe j is a group of lobes, one in each lane of a vector.
template <int N, bool is_axial, PmForm form_value> struct Grouped {
    static constexpr int variates = N;
    static constexpr bool axial = is_axial;
    static constexpr PmForm form = form_value;
    const PmLanes& numbers;
    int lanes = int(Group::size());

    HWY_INLINE Group at(int j, int row) const { return Group::load(PmLanes::row(numbers.lobe(j * lanes), row)); }
    HWY_INLINE Group log2_scale(int j) const { return at(j, PmLanes::log2_scale()); }
    HWY_INLINE Group log2_falloff(int j, int n) const { return at(j, PmLanes::log2_falloff(axial, n)); }
    HWY_INLINE Group exponent(int j, int k) const { return at(j, PmLanes::exponent(axial, N, k)); }
    HWY_INLINE Group pole(int j, int n) const { return at(j, PmLanes::pole(n)); }
    HWY_INLINE Group place(int j, int n) const { return at(j, PmLanes::place(n)); }
    HWY_INLINE Vec3<Group> centre(int j, int n) const {
        return {at(j, PmLanes::centre(n, 0)), at(j, PmLanes::centre(n, 1)), at(j, PmLanes::centre(n, 2))};
    }
    HWY_INLINE Vec3<Group> coefficient(int j) const {
        return {at(j, PmLanes::coefficient(0)), at(j, PmLanes::coefficient(1)), at(j, PmLanes::coefficient(2))};
    }
};

HWY_INLINE Group broadcast(float x) { return Group(double(x)); }
HWY_INLINE Vec3<Group> broadcast(const Vec3f& w) { return {broadcast(w.x), broadcast(w.y), broadcast(w.z)}; }

#if HWY_TARGET == HWY_SCALAR
HWY_INLINE void store_colour(const Vec3<Group>& sum, float* colour) {
    colour[0] = std::max(sum.x.sum(), 0.f), colour[1] = std::max(sum.y.sum(), 0.f),
    colour[2] = std::max(sum.z.sum(), 0.f);
}
#else
using Four = hn::CappedTag<float, 4>;
HWY_INLINE hn::Vec<Four> fold_to_four(Group a) {
#if HWY_MAX_BYTES >= 32
    return hn::Add(hn::LowerHalf(Four(), a.v), hn::UpperHalf(Four(), a.v));
#else
    return a.v;
#endif
}
// Stores the sums of the lanes of x, y and z, clamped to at least 0. One instruction avoids store-forwarding stalls
// of a later vector load.
HWY_INLINE void store_colour(const Vec3<Group>& sum, float* colour) {
    const Four d;
    const auto x = fold_to_four(sum.x), y = fold_to_four(sum.y), z = fold_to_four(sum.z), zero = hn::Zero(d);
    const auto xz = hn::Add(hn::InterleaveLower(d, x, z), hn::InterleaveUpper(d, x, z));
    const auto y_ = hn::Add(hn::InterleaveLower(d, y, zero), hn::InterleaveUpper(d, y, zero));
    hn::Store(hn::Max(hn::Add(hn::InterleaveLower(d, xz, y_), hn::InterleaveUpper(d, xz, y_)), zero), d, colour);
}
#endif

// The variates of a pair, computed in lanes, and their squared distances from the centres of lobes in lanes.
template <typename Formula, int N, bool axial> struct LaneVariates {
    HWY_ALIGN float x[PmLanes::k_lanes], y[PmLanes::k_lanes], z[PmLanes::k_lanes];

    HWY_INLINE LaneVariates(const PmLanes& numbers, const Vec3<Group>& wl, const Vec3<Group>& wv) {
        for (int n = 0; n < N; n += int(Group::size())) {
            const Vec3<Group> psi =
                Formula::psi(wl, wv, Group::load(numbers.weight_l(n)), Group::load(numbers.weight_v(n)));
            psi.x.store(x + n), psi.y.store(y + n), psi.z.store(z + n);
        }
    }
    template <typename Model> HWY_INLINE Group squared_distance(const Model& pm, int j, int n) const {
        return Formula::squared_distance({broadcast(x[n]), broadcast(y[n]), broadcast(z[n])}, pm.centre(j, n));
    }
};
#if HWY_MAX_BYTES >= 32
// The distances of four variates from both poles fill eight lanes, from which each lobe selects its own.
template <typename Formula, int N> struct LaneVariates<Formula, N, true> {
    Group distance[(N + 3) / 4];

    HWY_INLINE LaneVariates(const PmLanes& numbers, const Vec3<Group>& wl, const Vec3<Group>& wv) {
        const Group pole = Group::load(PmLanes::k_poles);
        for (int n = 0; n < N; n += 4)
            distance[n / 4] =
                Formula::squared_distance_from_pole(Formula::axial_psi(wl, wv, Group::load(numbers.four_weights_l(n)),
                                                                       Group::load(numbers.four_weights_v(n))),
                                                    pole);
    }
    template <typename Model> HWY_INLINE Group squared_distance(const Model& pm, int j, int n) const {
        const hn::CappedTag<float, 8> d;
        const auto lanes = hn::IndicesFromVec(d, hn::BitCast(Group::Bits(), pm.place(j, n).v));
        return hn::TableLookupLanes(distance[n / 4].v, lanes);
    }
};
#else
template <typename Formula, int N> struct LaneVariates<Formula, N, true> {
    HWY_ALIGN float across[PmLanes::k_lanes], along[PmLanes::k_lanes];

    HWY_INLINE LaneVariates(const PmLanes& numbers, const Vec3<Group>& wl, const Vec3<Group>& wv) {
        for (int n = 0; n < N; n += int(Group::size())) {
            const auto psi =
                Formula::axial_psi(wl, wv, Group::load(numbers.weight_l(n)), Group::load(numbers.weight_v(n)));
            psi.across.store(across + n), psi.along.store(along + n);
        }
    }
    template <typename Model> HWY_INLINE Group squared_distance(const Model& pm, int j, int n) const {
        return Formula::squared_distance_from_pole({broadcast(across[n]), broadcast(along[n])}, pm.pole(j, n));
    }
};
#endif

// Evaluates first the variates in lanes, then the lobes. `f` has four elements: R, G, B and padding.
template <int N, bool axial, PmForm form>
void value_sized(const void* model, const Vec3f& l, const Vec3f& v, float* f) {
    using Formula = Formulas<Group, Grouped<N, axial, form>>;
    const PmLanes& numbers = *static_cast<const PmLanes*>(model);
    const Grouped<N, axial, form> pm{numbers};
    const Vec3<Group> wl = broadcast(l), wv = broadcast(v);
    const LaneVariates<Formula, N, axial> variates(numbers, wl, wv), exchanged(numbers, wv, wl);
    const auto further = Formula::pm_further_features(features(form), wl, wv);
    Vec3<Group> sum(Group(0.0), Group(0.0), Group(0.0));
    for (int j = 0; j * pm.lanes < numbers.lobes(); ++j) {
        // The features take longer than the variates.
        const Group feature_sum = Formula::pm_with_features(pm, j, Group(0.0), further);
        const auto power_of = [&](const auto& side) HWY_ATTR {
            Group exponent = pm.log2_scale(j);
            for (int n = 0; n < N; ++n)
                exponent = Formula::pm_with_variate(pm, j, n, exponent, side.squared_distance(pm, j, n));
            return Formula::pm_power(exponent + feature_sum);
        };
        Group power = power_of(variates);
        if constexpr (is_reciprocal(form)) power = Group(0.5) * (power + power_of(exchanged));
        sum = sum + power * pm.coefficient(j);
    }
    store_colour(sum, f);
}

template <int N, bool axial, std::size_t row = 0> PairEvaluator select_evaluator(PmForm form) {
    if constexpr (row + 1 < k_forms.size())
        if (form != k_forms[row]) return select_evaluator<N, axial, row + 1>(form);
    return value_sized<N, axial, k_forms[row]>;
}
PairEvaluator pair_evaluator(const PmLanes& model) {
    return for_size_of(model, [&]<int N, bool axial>() { return select_evaluator<N, axial>(model.form()); });
}

}  // namespace HWY_NAMESPACE
}  // namespace
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace SRBF_NAMESPACE {

HWY_EXPORT(evaluate);
HWY_EXPORT(pair_evaluator);

PmLanes::PmLanes(const PmModel& model)
    : form_(model.form),
      axial_(model.axial),
      lobes_(model.lobes),
      variates_(padded_variates(model.variates, model.axial)),
      rows_(exponent(axial_, variates_, features(form_))),
      numbers_(std::size_t(k_first + (lobes_ + k_lanes - 1) / k_lanes * rows_)) {
    assert(1 <= lobes_ && lobes_ <= k_max_lobes && 1 <= model.variates && model.variates <= k_max_variates);
    const StandardArithmetic mode;
    const auto N = std::size_t(model.variates), F = std::size_t(features(form_));
    for (std::size_t n = 0; n < k_lanes; ++n) {
        const Parameterization p = n < N ? model.parameterization[n] : Parameterization{};
        numbers_[0].lane[n] = p.a, numbers_[1].lane[n] = p.b;
        for (const std::size_t lane : {n % 4, n % 4 + 4})
            numbers_[2 + n / 4].lane[lane] = p.a, numbers_[4 + n / 4].lane[lane] = p.b;
    }
    using K = Kernel<float>;
    for (std::size_t j = 0; j < std::size_t(lobes_); ++j) {
        Row* const rows = &numbers_[k_first + j / k_lanes * std::size_t(rows_)];
        const auto set = [&](int row, float x) { rows[row].lane[j % k_lanes] = x; };
        set(log2_scale(), float(K::pm_log2_scale(model, int(j))));
        set_coefficient(j, model.coefficient[j]);
        for (std::size_t n = 0; n < std::size_t(variates_); ++n) {
            const Vec3f xi = n < N ? model.centre[j * N + n] : Vec3f(0, 0, 1);
            set(log2_falloff(axial_, int(n)), n < N ? float(K::pm_log2_falloff(model, int(j), int(n))) : 0);
            if (axial_)
                set(pole(int(n)), xi.z < 0 ? -1.f : 1.f),
                    set(place(int(n)), std::bit_cast<float>(std::int32_t(n % 4 + (xi.z < 0 ? 4 : 0))));
            else
                set(centre(int(n), 0), xi.x), set(centre(int(n), 1), xi.y), set(centre(int(n), 2), xi.z);
        }
        for (std::size_t k = 0; k < F; ++k)
            set(exponent(axial_, variates_, int(k)), float(K::pm_exponent(model, int(j), int(k))));
    }
}

void PmLanes::set_coefficient(std::size_t j, const Rgb& beta) {
    // Smaller values occur only in spectra, below the resolution of 16 bits; their products might be subnormal.
    for (int c = 0; c < 3; ++c)
        numbers_[k_first + j / k_lanes * std::size_t(rows_) + std::size_t(coefficient(c))].lane[j % k_lanes] =
            std::abs(beta[c]) < 0x1p-26f ? 0 : beta[c];
}

PmLanes PmLanes::with_coefficients(std::span<const Rgb> coefficient) const {
    assert(coefficient.size() == std::size_t(lobes_));
    PmLanes copy = *this;
    for (std::size_t j = 0; j < coefficient.size(); ++j) copy.set_coefficient(j, coefficient[j]);
    return copy;
}

PairEvaluator pair_evaluator(const PmLanes& model) { return HWY_DYNAMIC_DISPATCH(pair_evaluator)(model); }

void evaluate(const PmLanes& model, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f) {
    const StandardArithmetic mode;
    require_equal_lengths(wl.size(), wv.size(), f.size());
    HWY_DYNAMIC_DISPATCH(evaluate)(model, wl.data(), wv.data(), f.data(), f.size());
}
void evaluate(const PmModel& model, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f) {
    evaluate(PmLanes(model), wl, wv, f);
}

Evaluate evaluator(const PmModel& model) {
    return [&model](auto wl, auto wv, auto f) { evaluate(model, wl, wv, f); };
}

Channels spectra(const PmModel& model) {
    return {model.wavelength, [&model](auto wl, auto wv, auto f) {
                const std::size_t C = model.wavelength.size();
                require_equal_lengths(C * wl.size(), C * wv.size(), f.size());
                PmModel three = model;  // a model with three of the wavelengths as R, G, B
                std::vector<Rgb> rgb(wl.size());
                for (std::size_t first = 0; first < C; first += 3) {
                    const std::size_t count = std::min<std::size_t>(3, C - first);
                    for (std::size_t j = 0; j < three.coefficient.size(); ++j)
                        for (std::size_t c = 0; c < count; ++c)
                            three.coefficient[j][int(c)] = model.spectrum[j * C + first + c];
                    evaluate(three, wl, wv, rgb);
                    for (std::size_t i = 0; i < rgb.size(); ++i)
                        for (std::size_t c = 0; c < count; ++c) f[i * C + first + c] = rgb[i][int(c)];
                }
            }};
}

}  // namespace
#endif
