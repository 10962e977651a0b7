#include "models/su/view_lobes.h"

#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "models/su/view_lobes.cpp"
#include <hwy/foreach_target.h>

#include "brdf/batch-inl.h"

HWY_BEFORE_NAMESPACE();
namespace SRBF_NAMESPACE {
namespace HWY_NAMESPACE {

Vec3<Batch> load(const DirectionRows& rows, std::size_t i) {
    return {Batch::load(&rows.w[0][i]), Batch::load(&rows.w[1][i]), Batch::load(&rows.w[2][i])};
}
Vec3<Batch> spread(Vec3f w) { return {Batch(double(w.x)), Batch(double(w.y)), Batch(double(w.z))}; }

float view_exponents(const DirectionRows& rows, std::size_t block, const MovingLobe& lobe, const float* root_weight,
                     float* x) {
    const Vec3<Batch> centre = spread(lobe.centre);
    const Batch lambda{double(lobe.bandwidth)}, lowest(-double(std::numeric_limits<float>::max()));
    Batch largest = lowest;
    for (std::size_t i = 0; i < k_block; i += Batch::size()) {
        const Batch exponent =
            Formulas<Batch, PmModel>::gaussian_exponent(load(rows, block * k_block + i), centre, lambda);
        exponent.store(x + i);
        largest = max(largest, select(Batch(0.0) < Batch::load(root_weight + i), exponent, lowest));
    }
    return largest.largest();
}

void derive(const DirectionRows& rows, std::size_t block, const MovingLobe& lobe, const float* e, const float* x,
            float* by_first, float* by_second, float* by_log_bandwidth) {
    const Vec3<Batch> first = spread(lobe.bandwidth * lobe.along[0]), second = spread(lobe.bandwidth * lobe.along[1]),
                      centre = spread(lobe.centre);
    for (std::size_t i = 0; i < k_block; i += Batch::size()) {
        // Since the tangents are orthogonal to the centre, it may be subtracted, which keeps precision.
        const Vec3<Batch> difference = load(rows, block * k_block + i) - centre;
        const Batch value = Batch::load(e + i);
        (value * dot(difference, first)).store(by_first + i);
        (value * dot(difference, second)).store(by_second + i);
        (value * Batch::load(x + i)).store(by_log_bandwidth + i);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace SRBF_NAMESPACE {

HWY_EXPORT(view_exponents);
HWY_EXPORT(derive);

float exponents(const DirectionRows& rows, std::size_t block, const MovingLobe& lobe, const float* root_weight,
                float* x) {
    return HWY_DYNAMIC_DISPATCH(view_exponents)(rows, block, lobe, root_weight, x);
}
void derive(const DirectionRows& rows, std::size_t block, const MovingLobe& lobe, const float* e, const float* x,
            float* by_first, float* by_second, float* by_log_bandwidth) {
    HWY_DYNAMIC_DISPATCH(derive)(rows, block, lobe, e, x, by_first, by_second, by_log_bandwidth);
}

DirectionRows::DirectionRows(std::span<const Vec3f> directions) : blocks(blocks_for(directions.size())) {
    // Padding has weight 0 and may have any direction.
    for (std::size_t k = 0; k < 3; ++k) w[k].assign(blocks * k_block, k == 2 ? 1.f : 0.f);
    for (std::size_t i = 0; i < directions.size(); ++i)
        w[0][i] = directions[i].x, w[1][i] = directions[i].y, w[2][i] = directions[i].z;
}

}  // namespace
#endif
