// Pixels of pictures as part of a least-squares problem.
#pragma once
#include <array>
#include <span>

#include "base/aligned.h"

namespace SRBF_NAMESPACE {

/// Columns of a block of pixels. Half the gradient of the error with respect to the colour is jacobianᵀ r.
struct PixelSlopes {
    /// derivatives of r with respect to the colour; |r|² changes as the error does
    Aligned<float> jacobian = Aligned<float>(9 * k_block);
    Aligned<float> r = Aligned<float>(3 * k_block);
    /// The derivatives of one component with respect to the three channels, as columns.
    std::array<const float*, 3> jacobian_of(std::size_t component) const {
        const float* const first = &jacobian[3 * component * k_block];
        return {first, first + k_block, first + 2 * k_block};
    }
    const float* residual(std::size_t component) const { return &r[component * k_block]; }
};

/// The visible error of pixels of a picture against a reference. Colours are linear sRGB; 1 is the display's white.
/// The colours of a block are given as one column for each channel, with values ≥ 0 beyond the last pixel.
class Pixels {
  public:
    using Triplet = std::array<double, 3>;
    using Colours = std::array<const float*, 3>;
    static constexpr double k_just_noticeable = 1;

    Pixels() = default;
    /// Pixels with these reference colours.
    explicit Pixels(std::span<const Triplet> colours);

    std::size_t count() const { return count_; }
    std::size_t blocks() const { return blocks_for(count_); }

    /// Σ ρ(ΔE_ITP) of a block's pixels with the given colours. ρ = 2 k (√(ΔE² + k²) − k) is quadratic below k = 1,
    /// which is just noticeable, and linear above, like a mean of ΔE. A channel that is clipped at white in both
    /// colours counts as equal. A channel that the reference does not clip is compared beyond white as well.
    double errors(std::size_t block, const Colours& colours, PixelSlopes& slopes) const;
    /// Σ ΔE_ITP of a block's pixels.
    double delta_e(std::size_t block, const Colours& colours) const;

  private:
    std::size_t count_ = 0;
    /// blocks × 6 × k_block: I, T, P as in Itp, then the upper limit of each channel in a comparison
    Aligned<float> reference_;
};

}  // namespace
