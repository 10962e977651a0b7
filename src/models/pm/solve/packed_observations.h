// Observations in the layout of the inner loops.
#pragma once
#include <Eigen/Dense>
#include <functional>

#include "base/aligned.h"
#include "base/parallel.h"
#include "observe/observations.h"
#include "observe/pixels.h"

namespace SRBF_NAMESPACE {

/// The parts of the observations that PackedObservations hold.
struct PackingOptions {
    /// increase of the sum if every integral differs by its luminance in one channel; 0: no integrals
    double integral_importance = 0;
    bool subsampled_integrals = false;  ///< only the integrals of a search, and every ninth node of each
    bool spectra = false;  ///< the spectra of the pairs instead of their colours; integrals and views have no spectra
    double picture_importance = 0;  ///< factor of the mean error of all `Pixels`; 0: no views
};

/// Observations in the layout of the loops: one array per component, padded to whole blocks with rows of weight 0.
/// First come the blocks of pairs, which contribute a sum of squares. Then follow the same number of blocks for
/// each integral, which contributes the square of a sum, and the blocks of views, whose pixels are sums over rows.
struct PackedObservations {
    /// All observations except the bound pairs.
    explicit PackedObservations(const Observations& observations, const PackingOptions& options = {});
    std::size_t pairs = 0, blocks = 0;               ///< number of pairs, and of their blocks
    std::size_t integrals = 0, integral_blocks = 0;  ///< number of integrals, blocks per integral
    std::array<Aligned<float>, 3> wl, wv;
    double scale = 1;               ///< unit of the values: 1 / √Σw
    Aligned<float> root_weight;     ///< √w × scale, whose squares sum to 1 over pairs
    std::vector<Aligned<float>> y;  ///< √w f for each channel

    /// A pixel under a directional light is weight f(row). Under an extended light it is Σ light[i] f(row + i) over
    /// all rows of its view.
    struct Pixel {
        std::size_t row;
        bool is_directional;
        float weight;
        std::size_t light;
    };
    /// Each view has `view_rows` rows, a power of two from k_row_multiple to k_block.
    std::size_t views = 0, view_rows = 0;
    std::vector<Pixel> pixel;              ///< pixels in the order of the views
    std::vector<std::size_t> first_pixel;  ///< index of each view's first pixel, then the number of pixels
    Aligned<float> light;
    Pixels pixels;
    double picture_importance = 0;

    std::size_t rows_in(std::size_t block) const { return block < blocks ? rows_in_block(block, pairs) : k_block; }
    std::size_t first_view_block() const { return blocks + integrals * integral_blocks; }
    std::size_t total_blocks() const { return first_view_block() + blocks_for(views * view_rows); }

    /// Loops over rows process one chunk at a time, and add the sums of chunks in order. A chunk is k_chunk blocks
    /// of pairs, the blocks of one integral, or one block of views.
    static constexpr std::size_t k_chunk = 8;
    std::size_t chunks_of_pairs() const { return (blocks + k_chunk - 1) / k_chunk; }
    std::size_t chunks() const { return chunks_of_pairs() + integrals; }  ///< number of chunks of pairs and integrals
    std::size_t total_chunks() const { return chunks() + total_blocks() - first_view_block(); }
    bool is_integral(std::size_t block) const { return block >= blocks; }
    /// Calls body(chunk, begin, end) for the blocks of the first `count` chunks.
    template <typename Body> void for_chunks(std::size_t count, bool parallel, const Body& body) const {
        for_each(count, parallel, [&](std::size_t chunk) {
            if (chunk < chunks_of_pairs()) return body(chunk, chunk * k_chunk, std::min((chunk + 1) * k_chunk, blocks));
            if (chunk >= chunks()) {
                const std::size_t block = first_view_block() + chunk - chunks();
                return body(chunk, block, block + 1);
            }
            const std::size_t begin = blocks + (chunk - chunks_of_pairs()) * integral_blocks;
            body(chunk, begin, begin + integral_blocks);
        });
    }

  private:
    void add_views(const std::vector<ObservedView>& views);
    /// Fills row i for these directions. `factor` is √w, or its replacement in a sum; f(c) is the value of channel c.
    template <typename Value> void set(std::size_t i, Vec3f l, Vec3f v, double factor, const Value& f);
};

/// The products of `count` columns with one another: sums over pairs, plus products of the sums of each integral.
/// `fill` puts the columns of a block into an array of that length. `parallel`: chunks of rows use several threads; the
/// result does not depend on it.
using FillColumns = std::function<void(std::size_t block, std::vector<const float*>& columns)>;
Eigen::MatrixXd products_of_columns(const PackedObservations& rows, std::size_t count, bool parallel,
                                    const FillColumns& fill);

// Arrays hold k_block numbers and are aligned for SIMD; the first `rows_in` of the block are computed.

/// Computes, for the rows of a block and ψ of (a, b), s = −|ψ−ẑ|²/2 = ψ_z − 1 and its derivative by the angle of (a,
/// b). Unless `axial`, s holds ψ_x, ψ_y and ψ_z − 1 one after the other, likewise their derivatives: 3 × k_block
/// numbers each. In order 1 light and viewer are exchanged.
void variate_features(const PackedObservations& rows, std::size_t block, int order, float a, float b, bool axial,
                      float* s, float* s_by_angle);
/// The first `count` further features (pm_further_features of kernel.glsl), one after the other: `count` × k_block
/// numbers.
void further_features(const PackedObservations& rows, std::size_t block, int count, float* features);

}  // namespace
