#include "models/su/view_lobes.h"

#include <cmath>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "models/su/view_lobes.cpp"
#include <hwy/foreach_target.h>

#include "brdf/batch-inl.h"

HWY_BEFORE_NAMESPACE();
namespace srbf {
namespace HWY_NAMESPACE {

Vec3<Batch> load(const DirectionRows& rows, std::size_t at) {
    return {Batch::load(&rows.w[0][at]), Batch::load(&rows.w[1][at]), Batch::load(&rows.w[2][at])};
}
Vec3<Batch> spread(Vec3f w) { return {Batch(double(w.x)), Batch(double(w.y)), Batch(double(w.z))}; }

float view_exponents(const DirectionRows& rows, std::size_t block, const MovingLobe& lobe, const float* root_weight,
                     float* x) {
    const Vec3<Batch> xi = spread(lobe.centre), tangent = spread(lobe.across);
    const Batch lambda{double(lobe.bandwidth)}, shape{double(lobe.shape)},
        lowest(-double(std::numeric_limits<float>::max()));
    Batch largest = lowest;
    for (std::size_t i = 0; i < k_block; i += Batch::size()) {
        const std::size_t at = block * k_block + i;
        const Vec3<Batch> apart = load(rows, at) - xi;
        const Batch exponent = Formulas<Batch, PmModel>::shaped_exponent(apart, dot(apart, tangent),
                                                                         Batch::load(&rows.slant[at]), lambda, shape);
        exponent.store(x + i);
        largest = max(largest, select(Batch(0.0) < Batch::load(root_weight + i), exponent, lowest));
    }
    return largest.largest();
}

void derive(const DirectionRows& rows, std::size_t block, const MovingLobe& lobe, const float* e, const float* x,
            float* by_first, float* by_second, float* by_log_bandwidth, float* by_shape) {
    const bool is_narrowed = std::signbit(lobe.shape);
    const Batch tau{double(std::max(lobe.shape, 0.f))}, alpha{double(std::max(-lobe.shape, 0.f))},
        half_lambda{0.5 * double(lobe.bandwidth)};
    const Vec3f along[2] = {lobe.bandwidth * lobe.along[0], lobe.bandwidth * lobe.along[1]};
    const Vec3<Batch> first = spread(along[0]), second = spread(along[1]), centre = spread(lobe.centre),
                      tangent = spread(lobe.across);
    const Batch first_across = alpha * Batch(double(dot(lobe.across, along[0]))),
                second_across = alpha * Batch(double(dot(lobe.across, along[1])));
    for (std::size_t i = 0; i < k_block; i += Batch::size()) {
        // The tangents are orthogonal to the centre, which may therefore be subtracted: differences keep precision.
        const std::size_t at = block * k_block + i;
        const Vec3<Batch> apart = load(rows, at) - centre;
        const Batch value = Batch::load(e + i), slant = Batch::load(&rows.slant[at]);
        const Batch across = dot(apart, tangent);
        (value * (dot(apart, first) + across * first_across)).store(by_first + i);
        (value * (dot(apart, second) + across * second_across)).store(by_second + i);
        (value * (Batch::load(x + i) + tau * slant)).store(by_log_bandwidth + i);
        if (!by_shape) continue;
        const Batch by = is_narrowed ? Batch(half_lambda * Batch(across * across)) : Batch(0.0) - slant;
        (value * by).store(by_shape + i);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace srbf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace srbf {

HWY_EXPORT(view_exponents);
HWY_EXPORT(derive);

float exponents(const DirectionRows& rows, std::size_t block, const MovingLobe& lobe, const float* root_weight,
                float* x) {
    return HWY_DYNAMIC_DISPATCH(view_exponents)(rows, block, lobe, root_weight, x);
}
void derive(const DirectionRows& rows, std::size_t block, const MovingLobe& lobe, const float* e, const float* x,
            float* by_first, float* by_second, float* by_log_bandwidth, float* by_shape) {
    HWY_DYNAMIC_DISPATCH(derive)(rows, block, lobe, e, x, by_first, by_second, by_log_bandwidth, by_shape);
}

DirectionRows::DirectionRows(std::span<const Vec3f> directions) : blocks(blocks_for(directions.size())) {
    // Padding rows: any direction is fine, the weight is 0.
    for (std::size_t k = 0; k < 3; ++k) w[k].assign(blocks * k_block, k == 2 ? 1.f : 0.f);
    for (std::size_t i = 0; i < directions.size(); ++i)
        w[0][i] = directions[i].x, w[1][i] = directions[i].y, w[2][i] = directions[i].z;
    for (const float z : w[2]) slant.push_back(z > 0 ? Kernel<float>::slant(z) : 0.f);
}

}  // namespace srbf
#endif
