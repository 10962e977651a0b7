#include "extras/maps/texel_sums.h"

#include <limits>

#include "observe/observations.h"
#include "srbf/elementary.h"
#include "srbf/metrics.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "extras/maps/texel_sums.cpp"
#include <hwy/foreach_target.h>

#include "brdf/batch-inl.h"

HWY_BEFORE_NAMESPACE();
namespace SRBF_NAMESPACE {
namespace HWY_NAMESPACE {

HWY_INLINE Batch pow(Batch a, double exponent) { return exp(Batch(exponent) * log(a)); }

#undef SRBF_FN
#define SRBF_FN static HWY_INLINE
#include "observe/appearance_weights.inl"

constexpr double k_max_of_bright = 1e15, k_infinity = std::numeric_limits<double>::infinity();

HWY_INLINE float* row(float* rows, std::size_t i) { return rows + i * k_block_texels; }
HWY_INLINE const float* row(const float* rows, std::size_t i) { return rows + i * k_block_texels; }
HWY_INLINE Batch number(float x) { return Batch(double(x)); }

/// The `k_bright_quantile` of the finite x, weighted by cosθv. Positive floats are in the order of their bits, which
/// are found from the highest on, 11 of the mantissa.
HWY_INLINE Batch quantile(const float* x, const TexelPairs& pairs, std::size_t v) {
    const auto sum_below = [&](Batch bound) HWY_ATTR {
        Batch sums[4];
        for (Batch& sum : sums) sum = Batch(0.0);
        for (std::size_t i = 0; i < pairs.pairs; i += 4)
            for (std::size_t k = 0; k < 4; ++k)
                sums[k] =
                    sums[k] + select(Batch::load(row(x, i + k) + v) < bound, number(pairs.cos_v[i + k]), Batch(0.0));
        return (sums[0] + sums[1]) + (sums[2] + sums[3]);
    };
    const Batch fraction = Batch(k_bright_quantile) * sum_below(Batch(k_infinity));
    const Batch::Bits bits;
    auto found = hn::Zero(bits);
    for (int bit = 30; bit >= 12; --bit) {
        const auto trial = hn::Add(found, hn::Set(bits, std::int32_t(1) << bit));
        const BatchMask is_above = sum_below(hn::BitCast(Lanes(), trial)) < fraction;
        found = hn::IfThenElse(hn::RebindMask(bits, is_above), trial, found);
    }
    return select(Batch(0.0) < fraction, Batch(hn::BitCast(Lanes(), found)), Batch(0.0));
}

HWY_INLINE Batch value(const TexelBlock& block, std::size_t i, std::size_t c, std::size_t v) {
    return Batch::load(row(block.y.data(), 3 * i + c) + v);
}

/// Marks each pair: with NaN if it was not measured, with f cosθl if that is above 0, or else with ∞.
HWY_INLINE void mark(const TexelPairs& pairs, TexelBlock& block, std::size_t v) {
    for (std::size_t i = 0; i < pairs.pairs; ++i) {
        Batch sizes(0.0), sum(0.0);
        for (std::size_t c = 0; c < 3; ++c) sizes = sizes + Batch(hn::Abs(value(block, i, c, v).v));
        const BatchMask is_known = hn::And(sizes < Batch(k_infinity), Batch(0.0) < number(pairs.cosines[i]));
        for (std::size_t c = 0; c < 3; ++c) {
            const Batch y = select(is_known, max(value(block, i, c, v), Batch(0.0)), Batch(0.0));
            y.store(row(block.y.data(), 3 * i + c) + v);
            sum = sum + y;
        }
        const Batch brightness = sum * number(pairs.cos_l[i]) * Batch(1 / 3.0),
                    known_brightness = select(Batch(0.0) < brightness, brightness, Batch(k_infinity));
        select(is_known, known_brightness, Batch(std::numeric_limits<double>::quiet_NaN()))
            .store(row(block.weight.data(), i) + v);
    }
}

/// Divides the values by `bright`, and replaces the marks by 1 where a value was measured and 0 elsewhere.
HWY_INLINE void normalise(const TexelPairs& pairs, TexelBlock& block, std::size_t v) {
    const Batch bright = quantile(block.weight.data(), pairs, v),
                unit = select(Batch(0.0) < bright, bright, Batch(1.0));
    Batch largest(0.0), known(0.0);
    for (std::size_t i = 0; i < pairs.pairs; ++i) {
        Batch channels[3], sum(0.0);
        for (std::size_t c = 0; c < 3; ++c) {
            channels[c] = value(block, i, c, v) / unit;
            sum = sum + channels[c];
        }
        const BatchMask is_known =
            hn::And(sum < Batch(k_max_of_bright), Batch(0.0) < Batch::load(row(block.weight.data(), i) + v));
        for (std::size_t c = 0; c < 3; ++c) {
            const Batch y = select(is_known, channels[c], Batch(0.0));
            largest = max(largest, y * number(pairs.cosines[i]));
            y.store(row(block.y.data(), 3 * i + c) + v);
        }
        const Batch one = select(is_known, Batch(1.0), Batch(0.0));
        known = known + one;
        one.store(row(block.weight.data(), i) + v);
    }
    bright.store(block.bright + v);
    largest.store(block.largest + v);
    known.store(block.known + v);
}

/// Replaces the marks by the weights of the objective, as `weigh` does, of values whose `bright` is 1.
HWY_INLINE void weigh(const TexelPairs& pairs, TexelBlock& block, std::size_t v) {
    const Batch bright(1.0);
    Batch displayed(0.0), highlights(0.0), peaks(0.0);  // energies
    for (std::size_t i = 0; i < pairs.pairs; ++i) {
        const Batch cos_l = number(pairs.cos_l[i]), cos_v = number(pairs.cos_v[i]),
                    is_known = Batch::load(row(block.weight.data(), i) + v);
        Batch sum(0.0), square(0.0);
        for (std::size_t c = 0; c < 3; ++c) {
            const Batch y = value(block, i, c, v);
            sum = sum + y;
            square = square + y * y;
        }
        const Batch f = sum * Batch(1 / 3.0), display_weights = is_known * display_weight(f, bright, cos_l, cos_v),
                    highlight_weights = is_known * highlight_weight(f, bright, cos_l, cos_v);
        displayed = displayed + display_weights * square;
        highlights = highlights + highlight_weights * square;
        peaks = peaks + is_known * cosine_weight(f, bright, cos_l, cos_v) * square;
        display_weights.store(row(block.weight.data(), i) + v);
        highlight_weights.store(row(block.further.data(), i) + v);
    }
    const auto factor = [&](double importance, Batch energy) HWY_ATTR {
        return select(Batch(0.0) < energy, Batch(importance) * displayed / energy, Batch(0.0));
    };
    const Batch a = factor(k_highlights, highlights), b = factor(k_peaks, peaks);
    (displayed + a * highlights + b * peaks).store(block.energy + v);
    for (std::size_t i = 0; i < pairs.pairs; ++i) {
        const Batch w = Batch::load(row(block.weight.data(), i) + v), f(0.0),
                    peak = cosine_weight(f, bright, number(pairs.cos_l[i]), number(pairs.cos_v[i])),
                    weight = w + a * Batch::load(row(block.further.data(), i) + v) + b * peak;
        select(Batch(0.0) < w, weight, Batch(0.0)).store(row(block.weight.data(), i) + v);
    }
}

void prepare_texels(const TexelPairs& pairs, TexelBlock& block) {
    for (std::size_t v = 0; v < k_block_texels; v += k_width) {
        mark(pairs, block, v);
        normalise(pairs, block, v);
        weigh(pairs, block, v);
    }
}

// Columns whose sums are computed together.
constexpr std::size_t k_tile = 8;

/// sums[stride n + offset] += Σ of factors[i] columns[n][first + i], i < k_pair_multiple.
HWY_INLINE void add_sums(std::span<const float* const> columns, std::size_t first, const float* factors,
                         std::size_t stride, float* sums) {
    for (std::size_t n = 0; n < columns.size(); n += k_tile) {
        const float* column[k_tile];
        for (std::size_t t = 0; t < k_tile; ++t) column[t] = columns[std::min(n + t, columns.size() - 1)] + first;
        for (std::size_t v = 0; v < k_block_texels; v += k_width) {
            Batch sum[k_tile];
            for (Batch& total : sum) total = Batch(0.0);
            for (std::size_t i = 0; i < k_pair_multiple; ++i) {
                const Batch factor = Batch::load(row(factors, i) + v);
                for (std::size_t t = 0; t < k_tile; ++t) sum[t] = sum[t] + number(column[t][i]) * factor;
            }
            for (std::size_t t = 0; t < std::min(k_tile, columns.size() - n); ++t) {
                float* const total = row(sums, stride * (n + t)) + v;
                (Batch::load(total) + sum[t]).store(total);
            }
        }
    }
}

void weighted_sums(std::span<const float* const> columns, const TexelPairs& pairs, const TexelBlock& block,
                   float* sums) {
    std::fill(sums, row(sums, columns.size()), 0.f);
    for (std::size_t first = 0; first < pairs.pairs; first += k_pair_multiple)
        add_sums(columns, first, row(block.weight.data(), first), 1, sums);
}

void weighted_products(std::span<const float* const> columns, const TexelPairs& pairs, const TexelBlock& block,
                       float* sums) {
    std::fill(sums, row(sums, 3 * columns.size()), 0.f);
    alignas(64) float weighted[k_pair_multiple * k_block_texels];
    for (std::size_t first = 0; first < pairs.pairs; first += k_pair_multiple)
        for (std::size_t c = 0; c < 3; ++c) {
            for (std::size_t i = 0; i < k_pair_multiple; ++i)
                for (std::size_t v = 0; v < k_block_texels; v += k_width)
                    (Batch::load(row(block.weight.data(), first + i) + v) * value(block, first + i, c, v))
                        .store(row(weighted, i) + v);
            add_sums(columns, first, weighted, 3, row(sums, c));
        }
}

void weighted_residuals(std::span<const float* const> columns, const float* beta, const TexelPairs& pairs,
                        const TexelBlock& block, float* residual) {
    constexpr std::size_t k_pairs_at_once = 4;  // pairs
    for (std::size_t v = 0; v < k_block_texels; v += k_width) {
        Batch sum(0.0);
        for (std::size_t first = 0; first < pairs.pairs; first += k_pairs_at_once) {
            Batch left[k_pairs_at_once][3];
            for (std::size_t i = 0; i < k_pairs_at_once; ++i)
                for (std::size_t c = 0; c < 3; ++c) left[i][c] = value(block, first + i, c, v);
            for (std::size_t n = 0; n < columns.size(); ++n) {
                Batch coefficient[3];
                for (std::size_t c = 0; c < 3; ++c) coefficient[c] = Batch::load(row(beta, 3 * n + c) + v);
                for (std::size_t i = 0; i < k_pairs_at_once; ++i)
                    for (std::size_t c = 0; c < 3; ++c)
                        left[i][c] = left[i][c] - number(columns[n][first + i]) * coefficient[c];
            }
            for (std::size_t i = 0; i < k_pairs_at_once; ++i) {
                Batch squares(0.0);
                for (std::size_t c = 0; c < 3; ++c) squares = squares + left[i][c] * left[i][c];
                sum = sum + Batch::load(row(block.weight.data(), first + i) + v) * squares;
            }
        }
        sum.store(residual + v);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace SRBF_NAMESPACE {

HWY_EXPORT(prepare_texels);
HWY_EXPORT(weighted_sums);
HWY_EXPORT(weighted_products);
HWY_EXPORT(weighted_residuals);

TexelPairs::TexelPairs(const SharedPairs& shared)
    : pairs((shared.wl.size() + k_pair_multiple - 1) / k_pair_multiple * k_pair_multiple),
      cos_l(pairs),
      cos_v(pairs),
      cosines(pairs) {
    for (std::size_t i = 0; i < shared.wl.size(); ++i)
        if (shared.wl[i].z > 0 && shared.wv[i].z > 0) {
            ++above;
            cos_l[i] = shared.wl[i].z;
            cos_v[i] = shared.wv[i].z;
            cosines[i] = cos_l[i] * cos_v[i];
        }
}

void load_texels(std::span<const Rgb> f, std::size_t count, const TexelPairs& pairs, TexelBlock& block) {
    constexpr std::size_t k_numbers_at_once = 16;  // numbers of a texel
    const std::size_t numbers = 3 * f.size() / count;
    const float* const values = &f[0].r;
    std::ranges::fill(block.y, 0.f);
    for (std::size_t first = 0; first < numbers; first += k_numbers_at_once)
        for (std::size_t t = 0; t < count; ++t)
            for (std::size_t i = first; i < std::min(first + k_numbers_at_once, numbers); ++i)
                block.y[i * k_block_texels + t] = values[t * numbers + i];
    HWY_DYNAMIC_DISPATCH(prepare_texels)(pairs, block);
}
void weighted_sums(std::span<const float* const> columns, const TexelPairs& pairs, const TexelBlock& block,
                   float* sums) {
    HWY_DYNAMIC_DISPATCH(weighted_sums)(columns, pairs, block, sums);
}
void weighted_products(std::span<const float* const> columns, const TexelPairs& pairs, const TexelBlock& block,
                       float* sums) {
    HWY_DYNAMIC_DISPATCH(weighted_products)(columns, pairs, block, sums);
}
void weighted_residuals(std::span<const float* const> columns, const float* beta, const TexelPairs& pairs,
                        const TexelBlock& block, float* residual) {
    HWY_DYNAMIC_DISPATCH(weighted_residuals)(columns, beta, pairs, block, residual);
}

}  // namespace
#endif
