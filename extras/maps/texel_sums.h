// Sums over the pairs of many texels at once by SIMD, one texel in each lane.
#pragma once
#include "base/aligned.h"
#include "srbf/fit_map.h"

namespace SRBF_NAMESPACE {

/// Number of texels in a block. Numbers of pairs are padded to a multiple of k_pair_multiple by pairs of weight 0.
inline constexpr std::size_t k_block_texels = 64, k_pair_multiple = 32;

/// The pairs that texels share. Columns have `pairs` numbers.
struct TexelPairs {
    explicit TexelPairs(const SharedPairs& shared);
    std::size_t pairs;                     ///< M, rounded up to a multiple of k_pair_multiple
    std::size_t above = 0;                 ///< number of pairs above the horizon
    Aligned<float> cos_l, cos_v, cosines;  ///< cosθl, cosθv and their product; 0 for a pair below the horizon
};

/// A block of texels. An array of n numbers of each texel has number i of texel t at i k_block_texels + t.
struct TexelBlock {
    explicit TexelBlock(std::size_t pairs)
        : y(3 * pairs * k_block_texels), weight(pairs * k_block_texels), further(weight.size()) {}
    Aligned<float> y;        ///< 3 M: f / bright, of each pair in R, G, B; at least 0
    Aligned<float> weight;   ///< M: the weights of objective appearance, up to a factor; 0 where nothing was measured
    Aligned<float> further;  ///< scratch
    alignas(64) float bright[k_block_texels];   ///< `typical_value` within 2⁻¹⁰, or 0 for a black texel
    alignas(64) float largest[k_block_texels];  ///< largest f cosθl cosθv / bright
    alignas(64) float known[k_block_texels];    ///< number of pairs that were measured
    alignas(64) float energy[k_block_texels];   ///< Σ w |y|²
};

/// Sets the block to texels with the values f[t][i] of texel t at pair i; texels that are missing are black. A value
/// that is not finite, or 10¹⁵ times as large as `bright`, was not measured.
void load_texels(std::span<const Rgb> f, std::size_t count, const TexelPairs& pairs, TexelBlock& block);

/// products[n] = Σ w columns[n], of columns that texels share.
void weighted_sums(std::span<const float* const> columns, const TexelPairs& pairs, const TexelBlock& block,
                   float* sums);
/// sums[3 n + c] = Σ w y_c columns[n].
void weighted_products(std::span<const float* const> columns, const TexelPairs& pairs, const TexelBlock& block,
                       float* sums);
/// residual = Σ w |y − Σ_n beta[3 n + c] columns[n]|², a number of each texel.
void weighted_residuals(std::span<const float* const> columns, const float* beta, const TexelPairs& pairs,
                        const TexelBlock& block, float* residual);

}  // namespace
