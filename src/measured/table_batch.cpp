// Evaluates isotropic RGL measurements, by the steps of rgl.cpp and warp.h, and MERL tables in SIMD batches.
#include "measured/tables.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "measured/table_batch.cpp"
#include <hwy/foreach_target.h>

#include "base/floating_point.h"
#include "brdf/batch-inl.h"
#include "measured/angles.h"
#include "measured/bytes.h"

HWY_BEFORE_NAMESPACE();
namespace SRBF_NAMESPACE {
namespace HWY_NAMESPACE {

using Indices = hn::Vec<hn::RebindToSigned<Lanes>>;

HWY_INLINE Batch abs(Batch a) { return hn::Abs(a.v); }
HWY_INLINE Batch copysign(Batch magnitude, Batch sign) { return hn::CopySign(magnitude.v, sign.v); }
HWY_INLINE Batch mix(Batch a, Batch b, Batch t) { return a + t * (b - a); }
HWY_INLINE Indices index(Batch whole) { return hn::ConvertTo(hn::RebindToSigned<Lanes>(), whole.v); }
HWY_INLINE Indices added(Indices i, Indices j) { return hn::Add(i, j); }
HWY_INLINE BatchMask is_number(Batch a) { return hn::Eq(a.v, a.v); }
HWY_INLINE Batch floor(Batch a) { return hn::Floor(a.v); }
// numbers[i]. AVX2's own instruction is left out: QEMU 7.2 ignores the indices that the fifth register holds.
HWY_INLINE Batch gather(const float* numbers, Indices i) {
#if HWY_TARGET == HWY_AVX2
    HWY_ALIGN std::int32_t at[k_width];
    hn::Store(i, hn::RebindToSigned<Lanes>(), at);
    return hn::Vec<Lanes>{_mm256_setr_ps(numbers[at[0]], numbers[at[1]], numbers[at[2]], numbers[at[3]], numbers[at[4]],
                                         numbers[at[5]], numbers[at[6]], numbers[at[7]])};
#else
    return hn::GatherIndex(Lanes(), numbers, i);
#endif
}
HWY_INLINE Indices scale(Indices i, std::size_t factor) {
    return hn::Mul(i, hn::Set(hn::RebindToSigned<Lanes>(), std::int32_t(factor)));
}

#include "measured/angles.inl"

/// As in warp.h.
struct GridPosition {
    Indices first;
    Batch fraction;
};
HWY_INLINE GridPosition grid_position(Batch u, std::size_t size) {
    const Batch x = min(max(Batch(0.0), u), Batch(1.0)) * Batch(double(size - 1));
    const Batch first = min(floor(x), Batch(double(size - 2)));
    return {index(first), x - first};
}

HWY_INLINE Batch to_unit(Batch theta) { return sqrt(theta * Batch(2 / k_pi)); }

HWY_INLINE Batch interpolate(const std::vector<float>& profile, Batch u) {
    const GridPosition node = grid_position(u, profile.size());
    return mix(gather(profile.data(), node.first), gather(profile.data() + 1, node.first), node.fraction);
}

/// f_r without clamping, for isotropic tables whose indices fit in 32 bits.
HWY_INLINE Vec3<Batch> rgl_value(const RglTable& table, Vec3<Batch> wl, Vec3<Batch> wv) {
    const Vec3<Batch> h = wl + wv;
    const Batch u_h = to_unit(polar_angle(h.x * h.x + h.y * h.y, h.z));
    const Batch theta_l = polar_angle(wl.x * wl.x + wl.y * wl.y, wl.z);
    const Batch phi = azimuth(wl.x * h.y - wl.y * h.x, wl.x * h.x + wl.y * h.y);

    Batch after(0.0);
    for (const float t : table.theta_l) after = after + select(theta_l < Batch(double(t)), Batch(0.0), Batch(1.0));
    const Indices slice = index(max(after, Batch(1.0)) - Batch(1.0));
    const Indices next = index(min(after, Batch(double(table.theta_l.size() - 1))));
    const Batch t0 = gather(table.theta_l.data(), slice), t1 = gather(table.theta_l.data(), next);
    const Batch fraction = select(t0 < t1, (theta_l - t0) / max(t1 - t0, Batch(1e-30)), Batch(0.0));

    // The warp, see `unwarp`.
    const RglTable::VisibleNormals& visible = table.visible;
    const std::size_t width = visible.width, height = visible.height;
    const GridPosition column = grid_position(u_h, width);
    const GridPosition row = grid_position((phi + Batch(k_pi)) * Batch(0.5 / k_pi), height);
    const Batch x = column.fraction, y = row.fraction;
    const Indices row0 = hn::Add(scale(slice, height), row.first), row1 = hn::Add(scale(next, height), row.first);
    const float* const nodes = &visible.nodes[0].density;
    const Indices node0 = scale(hn::Add(scale(row0, width), column.first), 2);
    const Indices node1 = scale(hn::Add(scale(row1, width), column.first), 2);
    const auto node = [&](std::size_t k) { return mix(gather(nodes + k, node0), gather(nodes + k, node1), fraction); };
    const Batch p0 = mix(node(0), node(2 * width), y), p1 = mix(node(2), node(2 * width + 2), y);
    const Batch left = mix(node(1), node(2 * width + 1), y) + x * (p0 + Batch(0.5) * x * (p1 - p0));
    const float* const rows = &visible.rows[0].whole;
    const Indices i0 = scale(row0, 2), i1 = scale(row1, 2);
    const auto row_number = [&](std::size_t k) { return mix(gather(rows + k, i0), gather(rows + k, i1), fraction); };
    const Batch w0 = row_number(0), w1 = row_number(2), total = mix(w0, w1, y);
    const Batch below = row_number(1) + y * (w0 + Batch(0.5) * y * (w1 - w0));
    const Batch w_x = select(Batch(0.0) < total, min(left / max(total, Batch(1e-37)), Batch(1.0)), u_h);

    // The colour.
    const std::size_t wide = table.colour.width, high = table.colour.height;
    const GridPosition c = grid_position(w_x, wide), r = grid_position(min(below, Batch(1.0)), high);
    const float* const colours = &table.colour.nodes[0].r;
    const auto first_node = [&](Indices s) {
        return scale(hn::Add(scale(hn::Add(scale(s, high), r.first), wide), c.first), 3);
    };
    const Indices colour0 = first_node(slice), colour1 = first_node(next);
    const auto channel = [&](std::size_t k) {
        const auto in_slice = [&](Indices i) {
            return mix(mix(gather(colours + k, i), gather(colours + k + 3, i), c.fraction),
                       mix(gather(colours + k + 3 * wide, i), gather(colours + k + 3 * wide + 3, i), c.fraction),
                       r.fraction);
        };
        return mix(in_slice(colour0), in_slice(colour1), fraction);
    };
    const Batch largest(3.4028234e38);
    const Batch factor =
        table.jacobian
            ? min(interpolate(table.ndf.nodes, u_h) / (Batch(4.0) * interpolate(table.sigma.nodes, to_unit(theta_l))),
                  largest)
            : Batch(1.0);
    const auto finite = [&](Batch f) { return max(min(f * factor / wv.z, largest), -largest); };
    return {finite(channel(0)), finite(channel(1)), finite(channel(2))};
}

// For tables whose indices fit in 32 bits.
#include "measured/merl.inl"

void evaluate_rgl(const RglTable& table, const Vec3f* wl, const Vec3f* wv, Rgb* f, std::size_t count) {
    evaluate_pairs(wl, wv, f, count, [&](Vec3<Batch> l, Vec3<Batch> v) HWY_ATTR { return rgl_value(table, l, v); });
}

void evaluate_merl(const MerlTable& table, const Vec3f* wl, const Vec3f* wv, Rgb* f, std::size_t count) {
    evaluate_pairs(wl, wv, f, count, [&](Vec3<Batch> l, Vec3<Batch> v) HWY_ATTR { return merl_value(table, l, v); });
}

}  // namespace HWY_NAMESPACE
}  // namespace
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace SRBF_NAMESPACE {

HWY_EXPORT(evaluate_rgl);
HWY_EXPORT(evaluate_merl);

namespace {
constexpr std::size_t k_max_numbers = std::size_t(1) << 29;  // indices of bytes fit in 32 bits
}

void evaluate_signed(const RglTable& table, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f) {
    const StandardArithmetic mode;
    require_equal_lengths(wl.size(), wv.size(), f.size());
    if (table.phi_l.empty() && 2 * table.visible.nodes.size() < k_max_numbers &&
        3 * table.colour.nodes.size() < k_max_numbers)
        return HWY_DYNAMIC_DISPATCH(evaluate_rgl)(table, wl.data(), wv.data(), f.data(), f.size());
    for (std::size_t i = 0; i < f.size(); ++i) f[i] = signed_value(table, wl[i], wv[i]);
}

void evaluate_signed(const MerlTable& table, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f) {
    const StandardArithmetic mode;
    require_equal_lengths(wl.size(), wv.size(), f.size());
    if (3 * table.cells.size() < k_max_numbers)
        return HWY_DYNAMIC_DISPATCH(evaluate_merl)(table, wl.data(), wv.data(), f.data(), f.size());
    for (std::size_t i = 0; i < f.size(); ++i) f[i] = signed_value(table, wl[i], wv[i]);
}

}  // namespace
#endif
