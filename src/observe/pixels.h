// Pixels of pictures as a part of a least-squares problem.
#pragma once
#include <array>
#include <span>

#include "base/aligned.h"
#include "base/block.h"

namespace srbf {

/// Columns of a block of pixels: half the gradient of an error by the colour is jacobianᵀ r.
struct PixelSlopes {
    Aligned<float> jacobian = Aligned<float>(9 * k_block);  ///< of r by the colour; the error's change is that of |r|²
    Aligned<float> r = Aligned<float>(3 * k_block);
    /// The columns of a component's derivatives by the channels.
    std::array<const float*, 3> by(std::size_t component) const {
        const float* const first = &jacobian[3 * component * k_block];
        return {first, first + k_block, first + 2 * k_block};
    }
    const float* of(std::size_t component) const { return &r[component * k_block]; }
};

/// The visible error of pixels of a picture against a reference. Colours are linear sRGB, 1 is the display's white;
/// those of a block are given as a column for each channel, with 0 or more beyond the last pixel.
class Pixels {
  public:
    using Triplet = std::array<double, 3>;
    using Colours = std::array<const float*, 3>;
    static constexpr double k_just_noticeable = 1;

    Pixels() = default;
    /// Pixels with these colours in the reference.
    explicit Pixels(std::span<const Triplet> colours);

    std::size_t count() const { return count_; }
    std::size_t blocks() const { return blocks_for(count_); }

    /// Σ ρ(ΔE_ITP) of a block's pixels with other colours: 2 k (√(ΔE² + k²) − k), a square below k = 1, which is just
    /// noticeable, and linear above, as a mean of ΔE is. A channel that both clip at white is equal; a channel that the
    /// reference does not clip is compared beyond white as well.
    double errors(std::size_t block, const Colours& colours, PixelSlopes& slopes) const;
    /// Σ ΔE_ITP of a block's pixels.
    double delta_e(std::size_t block, const Colours& colours) const;

  private:
    std::size_t count_ = 0;
    Aligned<float>
        reference_;  ///< blocks × 6 × k_block: I, T, P as in Itp; largest value of a channel that is compared
};

}  // namespace srbf
