#include "models/pm/solve/simd_columns.h"

#include <algorithm>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "models/pm/solve/simd_columns.cpp"
#include <hwy/foreach_target.h>

#include "brdf/batch-inl.h"

HWY_BEFORE_NAMESPACE();
namespace SRBF_NAMESPACE {
namespace HWY_NAMESPACE {

// Four vectors are processed together, so that a weight is broadcast and a column addressed only once for all four.
constexpr std::size_t k_vectors = 4;
static_assert(k_row_multiple % (k_vectors * HWY_MAX_BYTES / sizeof(float)) == 0);

// Calls store(i, sum) for the vector of rows at each i, where sum = start(i) + Σ_n weight[n] s[n].
template <typename Start, typename Store>
HWY_INLINE void add_weighted(std::span<const float> weight, std::span<const float* const> s, std::size_t count,
                             const Start& start, const Store& store) {
    const std::size_t lanes = Batch::size();
    for (std::size_t i = 0; i < count; i += k_vectors * lanes) {
        Batch sum[k_vectors];
        for (std::size_t t = 0; t < k_vectors; ++t) sum[t] = start(i + t * lanes);
        for (std::size_t n = 0; n < weight.size(); ++n) {
            const Batch w{double(weight[n])};
            const float* const column = s[n] + i;
            for (std::size_t t = 0; t < k_vectors; ++t) sum[t] = sum[t] + w * Batch::load(column + t * lanes);
        }
        for (std::size_t t = 0; t < k_vectors; ++t) store(i + t * lanes, sum[t]);
    }
}
HWY_INLINE Batch zero(std::size_t) { return Batch(0.0); }

// x, or 0 where |x| < least, in the same way on every processor. On Intel processors a product that is subnormal takes
// a hundred times as long, and the tails of lobes have many of them: a fit took five times as long.
HWY_INLINE Batch at_least(double least, Batch x) { return select(Batch(hn::Abs(x.v)) < Batch(least), Batch(0.0), x); }
HWY_INLINE Batch without_subnormals(Batch x) { return at_least(0x1p-126, x); }
// Smaller values of lobes are 0, so that the product of two is not subnormal if it is multiplied by k_lift, which is
// exact.
constexpr double k_min_lobe = 0x1p-93, k_lift = 0x1p60;

float exponent(std::span<const float> weight, std::span<const float* const> s, const float* root_weight, float* x,
               std::size_t count) {
    const Batch lowest(-std::numeric_limits<float>::max());
    Batch largest = lowest;
    add_weighted(weight, s, count, zero, [&](std::size_t i, Batch sum) HWY_ATTR {
        sum.store(x + i);
        largest = max(largest, select(Batch(0.0) < Batch::load(root_weight + i), sum, lowest));
    });
    return largest.largest();
}

void exponentiate(const float* x, const float* root_weight, float offset, float* e, std::size_t count) {
    const Batch shift{double(offset)}, most{k_max_exponent};
    for (std::size_t i = 0; i < count; i += Batch::size())
        at_least(k_min_lobe, Batch::load(root_weight + i) * exp(min(Batch::load(x + i) - shift, most))).store(e + i);
}

void combine(std::span<const float> weight, std::span<const float* const> s, float* x, std::size_t count) {
    add_weighted(weight, s, count, zero, [&](std::size_t i, Batch sum) HWY_ATTR { sum.store(x + i); });
}

void combine_and_multiply(std::span<const float> weight, std::span<const float* const> s, const float* factor, float* x,
                          std::size_t count) {
    add_weighted(weight, s, count, zero, [&](std::size_t i, Batch sum) HWY_ATTR {
        without_subnormals(Batch::load(factor + i) * sum).store(x + i);
    });
}

void add(const float* a, const float* b, float* out, std::size_t count) {
    for (std::size_t i = 0; i < count; i += Batch::size()) (Batch::load(a + i) + Batch::load(b + i)).store(out + i);
}

void multiply(const float* a, const float* b, float* out, std::size_t count) {
    for (std::size_t i = 0; i < count; i += Batch::size())
        without_subnormals(Batch::load(a + i) * Batch::load(b + i)).store(out + i);
}

void add_two_products(const float* a, const float* b, const float* c, const float* d, float* out, std::size_t count) {
    for (std::size_t i = 0; i < count; i += Batch::size())
        (without_subnormals(Batch::load(a + i) * Batch::load(b + i)) +
         without_subnormals(Batch::load(c + i) * Batch::load(d + i)))
            .store(out + i);
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
    add_weighted(beta, columns, count, start,
                 [&](std::size_t i, Batch negative) HWY_ATTR { (-negative).store(r + i); });
    return sum_of_squares(r, count);
}

// sums[k] = Σ over the lanes of x[k], k < 4.
#if HWY_TARGET == HWY_SCALAR
HWY_INLINE void sum_lanes(const Batch (&x)[4], float* sums) {
    for (std::size_t k = 0; k < 4; ++k) sums[k] = reduce_lanes(x[k]);
}
#else
// Transposes the matrix of four vectors of four lanes while adding lanes.
HWY_INLINE void sum_lanes(const Batch (&x)[4], float* sums) {
    const hn::CappedTag<float, 4> d;
    const hn::RepartitionToWide<decltype(d)> pairs;
    const auto four = [](Batch lanes) HWY_ATTR { return fold_to_four(Lanes(), lanes.v); };
    const auto halves = [&](Batch a, Batch b) HWY_ATTR {  // a b a b
        const auto x4 = four(a), y4 = four(b);
        return hn::BitCast(pairs, hn::Add(hn::InterleaveLower(d, x4, y4), hn::InterleaveUpper(d, x4, y4)));
    };
    const auto ab = halves(x[0], x[1]), cd = halves(x[2], x[3]);
    hn::Store(
        hn::Add(hn::BitCast(d, hn::InterleaveLower(pairs, ab, cd)), hn::BitCast(d, hn::InterleaveUpper(pairs, ab, cd))),
        d, sums);
}
#endif

// Products are computed in tiles of 4 columns. Their number of rows leaves registers for the sums, the rows'
// numbers and those of one column.
#if HWY_TARGET <= HWY_AVX3 || HWY_ARCH_ARM_A64
constexpr std::size_t k_tile = 6;
#elif HWY_ARCH_WASM  // browsers reserve some of the sixteen registers
constexpr std::size_t k_tile = 2;
#else
constexpr std::size_t k_tile = 3;
#endif
// The sums of a tile's products, by part of a sum, row and column.
using TileSums = Batch[k_sum_parts][k_tile][4];
HWY_INLINE void sum_tile(const float* const (&a)[k_tile], const float* const (&b)[4], std::size_t count,
                         TileSums& sums) {
    for (std::size_t p = 0; p < k_sum_parts; ++p) {  // one part at a time, since its sums fill the registers
        Batch sum[k_tile][4];
        for (auto& row_sums : sum)
            for (Batch& x : row_sums) x = Batch(0.0);
        for (std::size_t i = p * k_width; i < count; i += k_sum_lanes)
            for (std::size_t u = 0; u < 4; ++u) {
                const Batch column_values = Batch::load(b[u] + i) * Batch(k_lift);
                for (std::size_t t = 0; t < k_tile; ++t) sum[t][u] = sum[t][u] + Batch::load(a[t] + i) * column_values;
            }
        for (std::size_t t = 0; t < k_tile; ++t)
            for (std::size_t u = 0; u < 4; ++u) sums[p][t][u] = sum[t][u];
    }
}
// Columns were multiplied by k_lift. Adds the first `needed` sums of a tile's row t to `target`.
HWY_INLINE void add_tile_row(const TileSums& sums, std::size_t t, std::size_t needed, double* target) {
    Batch total[4];
    for (std::size_t u = 0; u < 4; ++u) {
        Batch parts[k_sum_parts];
        for (std::size_t p = 0; p < k_sum_parts; ++p) parts[p] = sums[p][t][u];
        total[u] = reduce_parts(parts);
    }
    HWY_ALIGN float sum[4];
    sum_lanes(total, sum);
    if (needed >= 4)
        for (std::size_t u = 0; u < 4; ++u) target[u] += double(sum[u]) / k_lift;
    else
        for (std::size_t u = 0; u < needed; ++u) target[u] += double(sum[u]) / k_lift;
}
// G += the inner products of rows and columns. Computes only the first columns_of(i) columns of row i, a number that
// does not decrease with i.
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
            TileSums sums;
            sum_tile(a, b, count, sums);
            for (std::size_t t = 0; t < k_tile && row + t < m; ++t) {
                const std::size_t end = columns_of(row + t);
                add_tile_row(sums, t, end > column ? end - column : 0, G + (row + t) * n + column);
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
}  // namespace
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace SRBF_NAMESPACE {

HWY_EXPORT(exponent);
HWY_EXPORT(exponentiate);
HWY_EXPORT(combine);
HWY_EXPORT(combine_and_multiply);
HWY_EXPORT(add);
HWY_EXPORT(multiply);
HWY_EXPORT(add_two_products);
HWY_EXPORT(add_product);
HWY_EXPORT(residual);
HWY_EXPORT(sum);
HWY_EXPORT(sum_of_squares);
HWY_EXPORT(add_gram);
HWY_EXPORT(add_products);

float exponent(std::span<const float> weight, std::span<const float* const> s, const float* root_weight, float* x,
               std::size_t count) {
    return HWY_DYNAMIC_DISPATCH(exponent)(weight, s, root_weight, x, count);
}
void exponentiate(const float* x, const float* root_weight, float offset, float* e, std::size_t count) {
    HWY_DYNAMIC_DISPATCH(exponentiate)(x, root_weight, offset, e, count);
}
void combine(std::span<const float> weight, std::span<const float* const> s, float* x, std::size_t count) {
    HWY_DYNAMIC_DISPATCH(combine)(weight, s, x, count);
}
void combine_and_multiply(std::span<const float> weight, std::span<const float* const> s, const float* factor, float* x,
                          std::size_t count) {
    HWY_DYNAMIC_DISPATCH(combine_and_multiply)(weight, s, factor, x, count);
}
void add(const float* a, const float* b, float* out, std::size_t count) { HWY_DYNAMIC_DISPATCH(add)(a, b, out, count); }
void multiply(const float* a, const float* b, float* out, std::size_t count) {
    HWY_DYNAMIC_DISPATCH(multiply)(a, b, out, count);
}
void add_two_products(const float* a, const float* b, const float* c, const float* d, float* out, std::size_t count) {
    HWY_DYNAMIC_DISPATCH(add_two_products)(a, b, c, d, out, count);
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

}  // namespace
#endif
