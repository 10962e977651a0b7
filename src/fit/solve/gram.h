// The inner loops of the fit: lobes on blocks of weighted observations, and inner products of their columns. Float SIMD
// within a block of rows, sums over blocks in double, so that the result does not depend on the number of threads.
#pragma once
#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "aligned.h"
#include "fit/data/observations.h"
#include "fit/objective/pixels.h"
#include "fit/solve/block.h"

namespace srbf {

inline constexpr std::size_t k_chunk = 8;  ///< blocks per chunk, the unit of summation

/// Which parts of the observations Rows hold.
struct Extent {
    double radiance_importance =
        0;  ///< increase of the sum if every radiance is off by its luminance in one channel; 0: no radiances
    bool roughly = false;           ///< only every other radiance, and of each every ninth direction
    bool spectra = false;           ///< the spectra of spectral observations instead of their colours
    double picture_importance = 0;  ///< factor of the mean error of all `Pixels`; 0, or with spectra: no views
};

/// Observations in the layout of the loops: an array per component, padded to whole blocks with rows of weight 0. First
/// the blocks of pairs, which contribute a sum of squares; then the same number of blocks for each radiance, which
/// contributes the square of a sum; then the blocks of views, whose pixels are sums over rows.
struct Rows {
    /// All observations except the bound pairs.
    explicit Rows(const Observations& observations, const Extent& extent = {});
    std::size_t pairs = 0, blocks = 0;               ///< number of pairs, and of their blocks
    std::size_t radiances = 0, radiance_blocks = 0;  ///< number of radiances, blocks per radiance
    std::array<Aligned<float>, 3> wl, wv;
    double scale = 1;               ///< unit of the values: 1 / √Σw
    Aligned<float> root_weight;     ///< √w × scale, so that its squares sum to 1 over pairs
    std::vector<Aligned<float>> y;  ///< √w f for each channel

    /// A pixel: weight f(row), or over all rows of its view Σ light[i] f(row + i).
    struct Pixel {
        std::size_t row;
        bool single;
        float weight;
        std::size_t light;
    };
    /// The views: each has `view_rows` rows, a power of two from k_row_multiple to k_block.
    std::size_t views = 0, view_rows = 0;
    std::vector<Pixel> pixel;              ///< in the order of the views
    std::vector<std::size_t> first_pixel;  ///< of each view, and their number
    Aligned<float> light;
    Pixels pixels;
    double picture_importance = 0;

    std::size_t rows_in(std::size_t block) const { return block < blocks ? rows_in_block(block, pairs) : k_block; }
    std::size_t first_view_block() const { return blocks + radiances * radiance_blocks; }
    std::size_t whole_blocks() const { return first_view_block() + blocks_for(views * view_rows); }

  private:
    void add_views(const std::vector<ObservedView>& views);
    /// Row i for these directions: `factor` is √w, or its replacement in a sum; f(c) the value of channel c.
    template <typename Value> void set(std::size_t i, Vec3f l, Vec3f v, double factor, const Value& f);
};

// All arrays below hold k_block numbers and are aligned for SIMD. Of a block of `rows` its `rows_in` are computed;
// elsewhere `count` numbers, a multiple of k_row_multiple.

/// For the rows of a block and ψ of angle (a, b): s = −|ψ−ẑ|²/2 = ψ_z − 1 and its derivative with respect to the angle.
void axial_feature(const Rows& rows, std::size_t block, float a, float b, float* s, float* s_by_angle);
/// The same for general centres: ψ_x, ψ_y, ψ_z − 1 one after the other, and their derivatives: 3 × k_block numbers
/// each.
void general_features(const Rows& rows, std::size_t block, float a, float b, float* s, float* s_by_angle);
/// The first `count` further features (pm_further_features of kernel.glsl), one after the other: `count` × k_block
/// numbers.
void further_features(const Rows& rows, std::size_t block, int count, float* features);
/// x = Σ_n weight[n] s[n]; returns the maximum over rows with positive weight, or the lowest float if there are none.
float exponent(const Rows& rows, std::size_t block, std::span<const float> weight, std::span<const float* const> s,
               float* x);
/// x ← √w exp(x − offset), for x ≤ offset. Rows of weight 0 may exceed `offset`; they become 0.
void exponentiate(const Rows& rows, std::size_t block, float offset, float* x);
/// x = Σ_n weight[n] s[n].
void combine(std::span<const float> weight, std::span<const float* const> s, float* x, std::size_t count = k_block);
/// x = factor Σ_n weight[n] s[n].
void combine(std::span<const float> weight, std::span<const float* const> s, const float* factor, float* x,
             std::size_t count = k_block);
/// out = a b.
void multiply(const float* a, const float* b, float* out, std::size_t count = k_block);
/// out += a b.
void add_product(const float* a, const float* b, float* out, std::size_t count = k_block);
/// r = y − Σ_j beta[j] columns[j]; returns Σ r².
double residual(const float* y, std::span<const float> beta, std::span<const float* const> columns, float* r,
                std::size_t count = k_block);
/// Σ of the column, and Σ of its squares.
double sum(const float* column, std::size_t count = k_block);
double sum_of_squares(const float* column, std::size_t count = k_block);
/// G[i × n + k] += columns[i] · columns[k] for k ≤ i, n the number of columns.
void add_gram(std::span<const float* const> columns, double* G, std::size_t count = k_block);
/// G[i × n + k] += rows[i] · columns[k], n the number of columns.
void add_products(std::span<const float* const> rows, std::span<const float* const> columns, double* G,
                  std::size_t count = k_block);

}  // namespace srbf
