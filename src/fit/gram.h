// The inner loops of the fit: lobes on blocks of weighted observations, and the products of their columns.
// Float SIMD inside of a block of rows, sums over blocks in double: the same on any number of threads.
#pragma once
#include <tbb/cache_aligned_allocator.h>

#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "srbf/fit.h"

namespace srbf {

inline constexpr std::size_t k_block = 512;  ///< rows in a block
inline constexpr std::size_t k_chunk = 8;    ///< blocks in a chunk: what is summed in one go

template <typename T> using Aligned = std::vector<T, tbb::cache_aligned_allocator<T>>;

/// What of the observations Rows hold.
struct Extent {
    double albedo_importance =
        0;  ///< what the sum rises by where every albedo is off by its luminance in one channel; 0: no albedo
    bool roughly = false;  ///< every other albedo, of each every ninth direction
    bool spectra = false;  ///< the spectra of spectral observations in place of their colours
};

/// Observations as the loops take them: an array a component, filled up to whole blocks with rows of weight
/// 0. First those of pairs, of which the sum of squares is asked for; then as many blocks for each albedo, of which the
/// square of the sum is asked for.
struct Rows {
    /// All but the checks.
    explicit Rows(const Observations& observations, const Extent& extent = {});
    std::size_t blocks = 0;                      ///< of pairs
    std::size_t albedos = 0, albedo_blocks = 0;  ///< how many, and of each so many blocks
    std::array<Aligned<float>, 3> wl, wv;
    double scale = 1;               ///< values are counted in multiples of it, whatever the data's unit: 1 / √Σw
    Aligned<float> root_weight;     ///< √w × scale, so that its squares sum to 1 over pairs
    std::vector<Aligned<float>> y;  ///< √w f for each channel

    std::size_t whole_blocks() const { return blocks + albedos * albedo_blocks; }

  private:
    /// Row i for these directions: `factor` is √w, or what stands in its place in a sum; f(c) the value of channel c.
    template <typename Value> void set(std::size_t i, Vec3f l, Vec3f v, double factor, const Value& f);
};

// Every array below holds k_block numbers and is aligned for vectors.

/// For rows of one block and ψ of angle (a, b): s = −|ψ−ẑ|²/2 = ψ_z − 1 and its derivative by the angle.
void axial_feature(const Rows& rows, std::size_t block, float a, float b, float* s, float* s_by_angle);
/// The same for centres anywhere: ψ_x, ψ_y, ψ_z − 1, one after the other, and their derivatives: 3 × k_block numbers each.
void general_features(const Rows& rows, std::size_t block, float a, float b, float* s, float* s_by_angle);
/// The first `count` further features (kernel.glsl: pm_further_features), one after the other: `count` × k_block numbers.
void further_features(const Rows& rows, std::size_t block, int count, float* features);
/// x = Σ_n weight[n] s[n]; returns the largest of the rows with a positive weight, the lowest float where there is none.
float exponent(const Rows& rows, std::size_t block, std::span<const float> weight, std::span<const float* const> s,
               float* x);
/// x ← √w exp(x − offset), for x ≤ offset; rows of weight 0 may exceed it and become 0.
void exponentiate(const Rows& rows, std::size_t block, float offset, float* x);
/// x = Σ_n weight[n] s[n].
void combine(std::span<const float> weight, std::span<const float* const> s, float* x);
/// out = a b.
void multiply(const float* a, const float* b, float* out);
/// out += a b.
void add_product(const float* a, const float* b, float* out);
/// r = y − Σ_j beta[j] columns[j]; returns Σ r².
double residual(const float* y, std::span<const float> beta, std::span<const float* const> columns, float* r);
/// Σ of the column, and of its squares.
double sum(const float* column);
double sum_of_squares(const float* column);
/// G[i × n + k] += columns[i] · columns[k] for k ≤ i, n the number of columns.
void add_gram(std::span<const float* const> columns, double* G);
/// G[i × n + k] += rows[i] · columns[k], n the number of columns.
void add_products(std::span<const float* const> rows, std::span<const float* const> columns, double* G);

}  // namespace srbf
