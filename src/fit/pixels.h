// Pixels of pictures as a part of a least-squares problem.
#pragma once
#include <array>
#include <cmath>
#include <vector>

#include "pictures/itp.h"

namespace srbf {

/// What is seen if pixels of a picture differ from a reference. Colours are linear sRGB, 1 is the display's white.
class Pixels {
  public:
    using Triplet = Itp::Triplet;
    /// Half the gradient of an error by the colour, and the Hessian of Gauss and Newton.
    struct Slope {
        Triplet by_colour{};
        Itp::Matrix jacobian{};  ///< of r by the colour, where the error's change is that of |r|²
        Triplet r{};
    };

    /// Adds a pixel with this colour in the reference.
    void add(const Triplet& colour);

    /// ρ(ΔE_ITP) of pixel p with another colour: 2 k (√(ΔE² + k²) − k), a square below k = 1, which is just noticeable,
    /// and linear above, as a mean of ΔE is. A channel that both clip at white is equal; a channel that the reference
    /// does not clip is compared beyond white as well.
    double error(std::size_t p, const Triplet& colour, Slope* slope = nullptr) const;
    /// ΔE_ITP of pixel p.
    double delta_e(std::size_t p, const Triplet& colour) const;

  private:
    struct Difference {
        std::array<bool, 3> clipped;
        Itp seen;
        Triplet of;
        double squared;
    };
    Difference difference(std::size_t p, const Triplet& colour) const;
    static constexpr double k_just_noticeable = 1;

    struct Reference {
        std::array<bool, 3> clipped;
        Triplet itp;
    };
    std::vector<Reference> reference_;
};

}  // namespace srbf
