#include "fit/solve/gram.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fit/solve/gram.cpp"
#include <hwy/foreach_target.h>

#include "batch-inl.h"
#include "fit/data/observations.h"

HWY_BEFORE_NAMESPACE();
namespace srbf {
namespace HWY_NAMESPACE {

Vec3<Batch> direction(const std::array<Aligned<float>, 3>& w, std::size_t at) {
    return {Batch::load(&w[0][at]), Batch::load(&w[1][at]), Batch::load(&w[2][at])};
}

void axial_feature(const Rows& rows, std::size_t block, float a, float b, float* s, float* s_by_angle) {
    using Formula = Formulas<Batch, PmModel>;
    const Batch a_(a), b_(b), one(1.0);
    const Vec3<Batch> up(Batch(0.0), Batch(0.0), one);
    const std::size_t first = block * k_block;
    for (std::size_t i = 0; i < rows.rows_in(block); i += Batch::size()) {
        const Vec3<Batch> wl = direction(rows.wl, first + i), wv = direction(rows.wv, first + i);
        Formula::gaussian_exponent(Formula::psi(wl, wv, a_, b_), up, one).store(s + i);
        Formula::psi_by_angle(wl, wv, a_, b_).z.store(s_by_angle + i);
    }
}

void general_features(const Rows& rows, std::size_t block, float a, float b, float* s, float* s_by_angle) {
    using Formula = Formulas<Batch, PmModel>;
    const Batch a_(a), b_(b), one(1.0);
    const Vec3<Batch> up(Batch(0.0), Batch(0.0), one);
    const std::size_t first = block * k_block;
    const auto store = [](Batch x, Batch y, Batch z, float* to) HWY_ATTR {
        x.store(to);
        y.store(to + k_block);
        z.store(to + 2 * k_block);
    };
    for (std::size_t i = 0; i < rows.rows_in(block); i += Batch::size()) {
        const Vec3<Batch> wl = direction(rows.wl, first + i), wv = direction(rows.wv, first + i);
        const Vec3<Batch> psi = Formula::psi(wl, wv, a_, b_), by_angle = Formula::psi_by_angle(wl, wv, a_, b_);
        store(psi.x, psi.y, Formula::gaussian_exponent(psi, up, one), s + i);
        store(by_angle.x, by_angle.y, by_angle.z, s_by_angle + i);
    }
}

void further_features(const Rows& rows, std::size_t block, int count, float* features) {
    const std::size_t first = block * k_block;
    for (std::size_t i = 0; i < rows.rows_in(block); i += Batch::size()) {
        const auto of = Formulas<Batch, PmModel>::pm_further_features(count, direction(rows.wl, first + i),
                                                                      direction(rows.wv, first + i));
        for (int k = 0; k < count; ++k) of.x[k].store(features + std::size_t(k) * k_block + i);
    }
}

// Processes four batches at once: a weight is broadcast and a column addressed once for all four.
constexpr std::size_t k_together = 4;
static_assert(k_row_multiple % (k_together * HWY_MAX_BYTES / sizeof(float)) == 0);

// Calls store(i, sum) for the rows from each i on, with sum = start(i) + Σ_n weight[n] s[n].
template <typename Start, typename Store>
HWY_INLINE void add_weighted(std::span<const float> weight, std::span<const float* const> s, std::size_t count,
                             const Start& start, const Store& store) {
    const std::size_t lanes = Batch::size();
    for (std::size_t i = 0; i < count; i += k_together * lanes) {
        Batch sum[k_together];
        for (std::size_t t = 0; t < k_together; ++t) sum[t] = start(i + t * lanes);
        for (std::size_t n = 0; n < weight.size(); ++n) {
            const Batch w{double(weight[n])};
            const float* const column = s[n] + i;
            for (std::size_t t = 0; t < k_together; ++t) sum[t] = sum[t] + w * Batch::load(column + t * lanes);
        }
        for (std::size_t t = 0; t < k_together; ++t) store(i + t * lanes, sum[t]);
    }
}
HWY_INLINE Batch zero(std::size_t) { return Batch(0.0); }

float exponent(const Rows& rows, std::size_t block, std::span<const float> weight, std::span<const float* const> s,
               float* x) {
    const float* root_weight = &rows.root_weight[block * k_block];
    const Batch lowest(-std::numeric_limits<float>::max());
    Batch largest = lowest;
    add_weighted(weight, s, rows.rows_in(block), zero, [&](std::size_t i, Batch sum) HWY_ATTR {
        sum.store(x + i);
        largest = max(largest, select(Batch(0.0) < Batch::load(root_weight + i), sum, lowest));
    });
    return largest.largest();
}

void exponentiate(const Rows& rows, std::size_t block, float offset, float* x) {
    const float* root_weight = &rows.root_weight[block * k_block];
    const Batch shift{double(offset)};
    for (std::size_t i = 0; i < rows.rows_in(block); i += Batch::size())
        Batch(Batch::load(root_weight + i) * exp(min(Batch::load(x + i) - shift, Batch(0.0)))).store(x + i);
}

void combine(std::span<const float> weight, std::span<const float* const> s, float* x, std::size_t count) {
    add_weighted(weight, s, count, zero, [&](std::size_t i, Batch sum) HWY_ATTR { sum.store(x + i); });
}

void combine_and_multiply(std::span<const float> weight, std::span<const float* const> s, const float* factor, float* x,
                          std::size_t count) {
    add_weighted(weight, s, count, zero,
                 [&](std::size_t i, Batch sum) HWY_ATTR { (Batch::load(factor + i) * sum).store(x + i); });
}

void multiply(const float* a, const float* b, float* out, std::size_t count) {
    for (std::size_t i = 0; i < count; i += Batch::size())
        Batch(Batch::load(a + i) * Batch::load(b + i)).store(out + i);
}

void add_product(const float* a, const float* b, float* out, std::size_t count) {
    for (std::size_t i = 0; i < count; i += Batch::size())
        (Batch::load(out + i) + Batch::load(a + i) * Batch::load(b + i)).store(out + i);
}

double sum(const float* column, std::size_t count) {
    return double(summed(count, [&](std::size_t i) HWY_ATTR { return Batch::load(column + i); }));
}

double sum_of_squares(const float* column, std::size_t count) {
    return double(summed(count, [&](std::size_t i) HWY_ATTR {
        const Batch x = Batch::load(column + i);
        return x * x;
    }));
}

double residual(const float* y, std::span<const float> beta, std::span<const float* const> columns, float* r,
                std::size_t count) {
    // The negative residual: Σ_j beta[j] columns[j] − y.
    const auto start = [&](std::size_t i) HWY_ATTR { return -Batch::load(y + i); };
    add_weighted(beta, columns, count, start, [&](std::size_t i, Batch rest) HWY_ATTR { (-rest).store(r + i); });
    return sum_of_squares(r, count);
}

// to[k] = Σ over the lanes of x[k], k < 4.
#if HWY_TARGET == HWY_SCALAR
HWY_INLINE void sum_lanes(const Batch (&x)[4], float* to) {
    for (std::size_t k = 0; k < 4; ++k) to[k] = folded_lanes(x[k]);
}
#else
// The matrix of four vectors of four lanes is transposed while lanes are added.
HWY_INLINE void sum_lanes(const Batch (&x)[4], float* to) {
    const hn::CappedTag<float, 4> d;
    const hn::RepartitionToWide<decltype(d)> pairs;
    const auto four = [&](Batch of) HWY_ATTR { return folded_to_four(Lanes(), of.v); };
    const auto halves = [&](Batch a, Batch b) HWY_ATTR {  // a b a b
        const auto x4 = four(a), y4 = four(b);
        return hn::BitCast(pairs, hn::Add(hn::InterleaveLower(d, x4, y4), hn::InterleaveUpper(d, x4, y4)));
    };
    const auto ab = halves(x[0], x[1]), cd = halves(x[2], x[3]);
    hn::Store(
        hn::Add(hn::BitCast(d, hn::InterleaveLower(pairs, ab, cd)), hn::BitCast(d, hn::InterleaveUpper(pairs, ab, cd))),
        d, to);
}
#endif

// Products in tiles of 4 columns and as many rows as leave registers for the sums, the rows' numbers and one column's.
#if HWY_TARGET <= HWY_AVX3 || HWY_ARCH_ARM_A64
constexpr std::size_t k_tile = 6;
#else
constexpr std::size_t k_tile = 3;
#endif
// For row i only the first `columns_of(i)` columns are computed.
template <typename ColumnsOf>
HWY_INLINE void add_tiles(std::span<const float* const> rows, std::span<const float* const> columns, double* G,
                          std::size_t count, const ColumnsOf& columns_of) {
    const std::size_t m = rows.size(), n = columns.size();
    for (std::size_t row = 0; row < m; row += k_tile) {
        const float* a[k_tile];
        for (std::size_t t = 0; t < k_tile; ++t) a[t] = rows[std::min(row + t, m - 1)];
        for (std::size_t column = 0; column < columns_of(std::min(row + k_tile, m) - 1); column += 4) {
            const float* b[4];
            for (std::size_t u = 0; u < 4; ++u) b[u] = columns[std::min(column + u, n - 1)];
            // One pass for each part of the sums, which fill the registers.
            Batch sums[k_sum_parts][k_tile][4];
            for (std::size_t p = 0; p < k_sum_parts; ++p) {
                Batch sum[k_tile][4];
                for (auto& of_row : sum)
                    for (Batch& x : of_row) x = Batch(0.0);
                for (std::size_t i = p * k_width; i < count; i += k_sum_lanes)
                    for (std::size_t u = 0; u < 4; ++u) {
                        const Batch of_column = Batch::load(b[u] + i);
                        for (std::size_t t = 0; t < k_tile; ++t)
                            sum[t][u] = sum[t][u] + Batch::load(a[t] + i) * of_column;
                    }
                for (std::size_t t = 0; t < k_tile; ++t)
                    for (std::size_t u = 0; u < 4; ++u) sums[p][t][u] = sum[t][u];
            }
            for (std::size_t t = 0; t < k_tile && row + t < m; ++t) {
                Batch whole[4];
                for (std::size_t u = 0; u < 4; ++u) {
                    Batch parts[k_sum_parts];
                    for (std::size_t p = 0; p < k_sum_parts; ++p) parts[p] = sums[p][t][u];
                    whole[u] = folded(parts);
                }
                HWY_ALIGN float sum[4];
                sum_lanes(whole, sum);
                double* const to = G + (row + t) * n + column;
                const std::size_t asked = columns_of(row + t);
                if (column + 4 <= asked)
                    for (std::size_t u = 0; u < 4; ++u) to[u] += double(sum[u]);
                else
                    for (std::size_t u = 0; column + u < asked; ++u) to[u] += double(sum[u]);
            }
        }
    }
}

void add_gram(std::span<const float* const> columns, double* G, std::size_t count) {
    add_tiles(columns, columns, G, count, [](std::size_t row) { return row + 1; });
}

void add_products(std::span<const float* const> rows, std::span<const float* const> columns, double* G,
                  std::size_t count) {
    add_tiles(rows, columns, G, count, [&](std::size_t) { return columns.size(); });
}

}  // namespace HWY_NAMESPACE
}  // namespace srbf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace srbf {

HWY_EXPORT(axial_feature);
HWY_EXPORT(general_features);
HWY_EXPORT(further_features);
HWY_EXPORT(exponent);
HWY_EXPORT(exponentiate);
HWY_EXPORT(combine);
HWY_EXPORT(combine_and_multiply);
HWY_EXPORT(multiply);
HWY_EXPORT(add_product);
HWY_EXPORT(residual);
HWY_EXPORT(sum);
HWY_EXPORT(sum_of_squares);
HWY_EXPORT(add_gram);
HWY_EXPORT(add_products);

void axial_feature(const Rows& rows, std::size_t block, float a, float b, float* s, float* s_by_angle) {
    HWY_DYNAMIC_DISPATCH(axial_feature)(rows, block, a, b, s, s_by_angle);
}
void general_features(const Rows& rows, std::size_t block, float a, float b, float* s, float* s_by_angle) {
    HWY_DYNAMIC_DISPATCH(general_features)(rows, block, a, b, s, s_by_angle);
}
void further_features(const Rows& rows, std::size_t block, int count, float* features) {
    HWY_DYNAMIC_DISPATCH(further_features)(rows, block, count, features);
}
float exponent(const Rows& rows, std::size_t block, std::span<const float> weight, std::span<const float* const> s,
               float* x) {
    return HWY_DYNAMIC_DISPATCH(exponent)(rows, block, weight, s, x);
}
void exponentiate(const Rows& rows, std::size_t block, float offset, float* x) {
    HWY_DYNAMIC_DISPATCH(exponentiate)(rows, block, offset, x);
}
void combine(std::span<const float> weight, std::span<const float* const> s, float* x, std::size_t count) {
    HWY_DYNAMIC_DISPATCH(combine)(weight, s, x, count);
}
void combine(std::span<const float> weight, std::span<const float* const> s, const float* factor, float* x,
             std::size_t count) {
    HWY_DYNAMIC_DISPATCH(combine_and_multiply)(weight, s, factor, x, count);
}
void multiply(const float* a, const float* b, float* out, std::size_t count) {
    HWY_DYNAMIC_DISPATCH(multiply)(a, b, out, count);
}
void add_product(const float* a, const float* b, float* out, std::size_t count) {
    HWY_DYNAMIC_DISPATCH(add_product)(a, b, out, count);
}
double residual(const float* y, std::span<const float> beta, std::span<const float* const> columns, float* r,
                std::size_t count) {
    return HWY_DYNAMIC_DISPATCH(residual)(y, beta, columns, r, count);
}
double sum(const float* column, std::size_t count) { return HWY_DYNAMIC_DISPATCH(sum)(column, count); }
double sum_of_squares(const float* column, std::size_t count) {
    return HWY_DYNAMIC_DISPATCH(sum_of_squares)(column, count);
}
void add_gram(std::span<const float* const> columns, double* G, std::size_t count) {
    HWY_DYNAMIC_DISPATCH(add_gram)(columns, G, count);
}
void add_products(std::span<const float* const> rows, std::span<const float* const> columns, double* G,
                  std::size_t count) {
    HWY_DYNAMIC_DISPATCH(add_products)(rows, columns, G, count);
}

template <typename Value> void Rows::set(std::size_t i, Vec3f l, Vec3f v, double factor, const Value& f) {
    wl[0][i] = l.x, wl[1][i] = l.y, wl[2][i] = l.z;
    wv[0][i] = v.x, wv[1][i] = v.y, wv[2][i] = v.z;
    root_weight[i] = float(factor * scale);
    for (std::size_t c = 0; c < y.size(); ++c) y[c][i] = float(factor * double(f(c)));
}

Rows::Rows(const Observations& observations, const Extent& extent) {
    const std::size_t count = observations.fitted();
    blocks = blocks_for(count), pairs = count;
    const std::size_t every = extent.roughly ? 2 : 1, step = extent.roughly ? 9 : 1;
    if (extent.radiance_importance > 0) radiances = (observations.radiances.size() + every - 1) / every;
    for (std::size_t k = 0; k < radiances; ++k)
        radiance_blocks =
            std::max(radiance_blocks, blocks_for((observations.radiances[k * every].wl.size() + step - 1) / step));
    const auto has_pixels = [](const ObservedView& view) { return !view.pixels.empty(); };
    if (extent.picture_importance > 0 && !extent.spectra && std::ranges::any_of(observations.views, has_pixels)) {
        picture_importance = extent.picture_importance;
        views = observations.views.size(), view_rows = k_row_multiple;
        for (const ObservedView& view : observations.views)
            view_rows = std::max(view_rows, std::bit_ceil(view.wl.size()));
    }
    // Padding rows: any direction is fine, the weight is 0.
    const std::size_t rows = whole_blocks() * k_block;
    for (std::size_t k = 0; k < 3; ++k) {
        wl[k].assign(rows, k == 2 ? 1.f : 0.f);
        wv[k].assign(rows, k == 2 ? 1.f : 0.f);
    }
    const std::size_t C = extent.spectra ? observations.wavelengths.size() : 3;
    y.assign(C, Aligned<float>(rows, 0.f));
    // Channel c of an observation or of a light direction of a radiance.
    const auto value_of = [C, spectra = extent.spectra](const auto& of, std::size_t i) {
        return [&of, i, C, spectra](std::size_t c) { return spectra ? of.spectrum[i * C + c] : of.f[i][int(c)]; };
    };
    root_weight.assign(rows, 0.f);
    double sum = 0;
    for (std::size_t i = 0; i < count; ++i) sum += observations.weight[i];
    if (sum > 0) scale = 1 / std::sqrt(sum);
    for (std::size_t i = 0; i < count; ++i)
        set(i, observations.wl[i], observations.wv[i], std::sqrt(observations.weight[i]), value_of(observations, i));
    for (std::size_t k = 0; k < radiances; ++k) {
        const RadianceObservation& seen = observations.radiances[k * every];
        double whole = 0;
        for (std::size_t i = 0; i < seen.wl.size(); i += step) whole += seen.weight[i] * double(luminance(seen.f[i]));
        if (!(whole > 0)) continue;
        const double factor = std::sqrt(extent.radiance_importance / double(radiances)) / whole;
        std::size_t row = (blocks + k * radiance_blocks) * k_block;
        for (std::size_t i = 0; i < seen.wl.size(); i += step)
            set(row++, seen.wl[i], seen.wv, factor * seen.weight[i], value_of(seen, i));
    }
    if (views > 0) add_views(observations.views);
}

void Rows::add_views(const std::vector<ObservedView>& all) {
    const std::size_t begin = first_view_block() * k_block;
    std::vector<Pixels::Triplet> colours;
    for (std::size_t k = 0; k < views; ++k) {
        const ObservedView& view = all[k];
        const std::size_t first = begin + k * view_rows;
        for (std::size_t i = 0; i < view.wl.size(); ++i)
            set(first + i, view.wl[i], view.wv, 1, [&](std::size_t c) { return view.f[i][int(c)]; });
        first_pixel.push_back(pixel.size());
        for (const ObservedPixel& seen : view.pixels) {
            const bool single = seen.weight.size() == 1;
            pixel.push_back({single ? first + seen.first : first, single, seen.weight[0], light.size()});
            if (!single) light.resize(light.size() + view_rows);
            Pixels::Triplet colour{};
            for (std::size_t i = 0; i < seen.weight.size(); ++i) {
                if (!single) light[pixel.back().light + seen.first + i] = seen.weight[i];
                for (std::size_t c = 0; c < 3; ++c)
                    colour[c] += double(seen.weight[i]) * double(view.f[seen.first + i][int(c)]);
            }
            colours.push_back(colour);
        }
    }
    first_pixel.push_back(pixel.size());
    pixels = Pixels(colours);
}

}  // namespace srbf
#endif
