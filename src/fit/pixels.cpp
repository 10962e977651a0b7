#include "fit/pixels.h"

namespace srbf {

void Pixels::add(const Triplet& colour) {
    Reference reference{};
    Triplet displayed = colour;
    for (std::size_t c = 0; c < 3; ++c) {
        reference.clipped[c] = colour[c] >= 1;
        displayed[c] = std::min(colour[c], 1.0);
    }
    reference.itp = Itp(displayed).value();
    reference_.push_back(reference);
}

Pixels::Difference Pixels::difference(std::size_t p, const Triplet& colour) const {
    const Reference& reference = reference_[p];
    std::array<bool, 3> clipped{};
    Triplet displayed = colour;
    for (std::size_t c = 0; c < 3; ++c)
        if ((clipped[c] = reference.clipped[c] && colour[c] >= 1)) displayed[c] = 1;
    const Itp seen(displayed);
    Triplet of;
    double squared = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        of[i] = seen.value()[i] - reference.itp[i];
        squared += of[i] * of[i];
    }
    return {clipped, seen, of, squared};
}

double Pixels::delta_e(std::size_t p, const Triplet& colour) const { return std::sqrt(difference(p, colour).squared); }

double Pixels::error(std::size_t p, const Triplet& colour, Slope* slope) const {
    constexpr double k = k_just_noticeable;
    const Difference difference = this->difference(p, colour);
    const double smooth = std::sqrt(difference.squared + k * k);
    if (slope) {
        const double root = std::sqrt(k / smooth);
        const Itp::Matrix by = difference.seen.by_colour();
        *slope = {};
        for (std::size_t i = 0; i < 3; ++i) {
            slope->r[i] = root * difference.of[i];
            for (std::size_t c = 0; c < 3; ++c) {
                slope->jacobian[i][c] = difference.clipped[c] ? 0 : root * by[i][c];
                slope->by_colour[c] += slope->jacobian[i][c] * slope->r[i];
            }
        }
    }
    return 2 * k * (smooth - k);
}

}  // namespace srbf
