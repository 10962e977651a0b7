#include "observe/pixels.h"

#include <limits>

#include "errors/itp.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "observe/pixels.cpp"
#include <hwy/foreach_target.h>

#include "brdf/batch-inl.h"

HWY_BEFORE_NAMESPACE();
namespace SRBF_NAMESPACE {
namespace HWY_NAMESPACE {

#include "errors/itp.inl"

using Triplet = std::array<Batch, 3>;

Triplet load(const float* columns, std::size_t i) {
    return {Batch::load(columns + i), Batch::load(columns + k_block + i), Batch::load(columns + 2 * k_block + i)};
}

// Calls visit(i, colour, limit, itp, itp − reference) for the vector of pixels at each i.
template <typename Visit>
HWY_INLINE void for_pixels(const float* reference, const Pixels::Colours& colours, std::size_t count,
                           const Visit& visit) {
    for (std::size_t i = 0; i < count; i += Batch::size()) {
        const Triplet reference_itp = load(reference, i), limit = load(reference + 3 * k_block, i);
        Triplet colour, shown;
        for (std::size_t c = 0; c < 3; ++c) {
            colour[c] = Batch::load(colours[c] + i);
            shown[c] = min(colour[c], limit[c]);
        }
        const Itp<Batch> itp(shown);
        Triplet difference;
        for (std::size_t k = 0; k < 3; ++k) difference[k] = itp.value()[k] - reference_itp[k];
        visit(i, colour, limit, itp, difference);
    }
}
HWY_INLINE Batch squared(const Triplet& x) { return x[0] * x[0] + x[1] * x[1] + x[2] * x[2]; }

// Computes I, T, P of a block's colours.
void compute_itp(const Pixels::Colours& colours, float* itp) {
    for (std::size_t i = 0; i < k_block; i += Batch::size()) {
        const Itp<Batch> values(
            {Batch::load(colours[0] + i), Batch::load(colours[1] + i), Batch::load(colours[2] + i)});
        for (std::size_t k = 0; k < 3; ++k) values.value()[k].store(itp + k * k_block + i);
    }
}

void errors(const float* reference, const Pixels::Colours& colours, std::size_t count, float* jacobian, float* r,
            float* error) {
    const Batch k(Pixels::k_just_noticeable), zero(0.0);
    for_pixels(reference, colours, count,
               [&](std::size_t i, const Triplet& colour, const Triplet& limit, const Itp<Batch>& itp,
                   const Triplet& difference) HWY_ATTR {
                   const Batch square = squared(difference), smooth = sqrt(square + k * k), root = sqrt(k / smooth);
                   // 2 k (smooth − k) without cancellation.
                   Batch(Batch(2.0) * k * square / (smooth + k)).store(error + i);
                   const std::array<Triplet, 3> derivatives = itp.jacobian();
                   for (std::size_t component = 0; component < 3; ++component) {
                       Batch(root * difference[component]).store(r + component * k_block + i);
                       for (std::size_t c = 0; c < 3; ++c)
                           select(colour[c] < limit[c], Batch(root * derivatives[component][c]), zero)
                               .store(jacobian + (3 * component + c) * k_block + i);
                   }
               });
}

void delta_e(const float* reference, const Pixels::Colours& colours, std::size_t count, float* distances) {
    for_pixels(reference, colours, count,
               [&](std::size_t i, const Triplet&, const Triplet&, const Itp<Batch>&, const Triplet& difference)
                   HWY_ATTR { sqrt(squared(difference)).store(distances + i); });
}

}  // namespace HWY_NAMESPACE
}  // namespace
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace SRBF_NAMESPACE {
namespace {

double sum_of(std::span<const float> column) {
    double sum = 0;
    for (const float x : column) sum += double(x);
    return sum;
}

}  // namespace

HWY_EXPORT(compute_itp);
HWY_EXPORT(errors);
HWY_EXPORT(delta_e);

// Beyond the last pixel the reference is black and nothing is compared.
Pixels::Pixels(std::span<const Triplet> colours) : count_(colours.size()), reference_(6 * blocks() * k_block) {
    Aligned<float> shown(3 * k_block);
    for (std::size_t block = 0; block < blocks(); ++block) {
        float* const reference = &reference_[6 * block * k_block];
        std::ranges::fill(shown, 0.f);
        const std::size_t begin = block * k_block, end = std::min(count_, begin + k_block);
        for (std::size_t c = 0; c < 3; ++c)
            for (std::size_t p = begin; p < end; ++p) {
                const auto colour = float(colours[p][c]);
                shown[c * k_block + p - begin] = std::min(colour, 1.f);
                reference[(3 + c) * k_block + p - begin] = colour < 1 ? std::numeric_limits<float>::max() : 1;
            }
        HWY_DYNAMIC_DISPATCH(compute_itp)({&shown[0], &shown[k_block], &shown[2 * k_block]}, reference);
    }
}

double Pixels::errors(std::size_t block, const Colours& colours, PixelSlopes& slopes) const {
    Aligned<float> error(rows_in_block(block, count_));
    HWY_DYNAMIC_DISPATCH(errors)
    (&reference_[6 * block * k_block], colours, error.size(), slopes.jacobian.data(), slopes.r.data(), error.data());
    return sum_of(error);
}

double Pixels::delta_e(std::size_t block, const Colours& colours) const {
    Aligned<float> distances(rows_in_block(block, count_));
    HWY_DYNAMIC_DISPATCH(delta_e)(&reference_[6 * block * k_block], colours, distances.size(), distances.data());
    return sum_of(distances);
}

}  // namespace
#endif
