#include "models/pm/solve/packed_observations.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "models/pm/solve/row_features.cpp"
#include <hwy/foreach_target.h>

#include "brdf/batch-inl.h"

HWY_BEFORE_NAMESPACE();
namespace SRBF_NAMESPACE {
namespace HWY_NAMESPACE {

Vec3<Batch> direction(const std::array<Aligned<float>, 3>& w, std::size_t i) {
    return {Batch::load(&w[0][i]), Batch::load(&w[1][i]), Batch::load(&w[2][i])};
}

void variate_features(const PackedObservations& rows, std::size_t block, int order, float a, float b, bool axial,
                      float* s, float* s_by_angle) {
    using Formula = Formulas<Batch, PmModel>;
    const Batch a_(a), b_(b), one(1.0);
    const Vec3<Batch> up(Batch(0.0), Batch(0.0), one);
    const std::size_t first = block * k_block;
    const auto &lights = order == 0 ? rows.wl : rows.wv, &viewers = order == 0 ? rows.wv : rows.wl;
    const auto store = [axial](Batch x, Batch y, Batch z, float* column) HWY_ATTR {
        if (axial) return z.store(column);
        x.store(column);
        y.store(column + k_block);
        z.store(column + 2 * k_block);
    };
    for (std::size_t i = 0; i < rows.rows_in(block); i += Batch::size()) {
        const Vec3<Batch> wl = direction(lights, first + i), wv = direction(viewers, first + i);
        const Vec3<Batch> psi = Formula::psi(wl, wv, a_, b_), by_angle = Formula::psi_by_angle(wl, wv, a_, b_);
        store(psi.x, psi.y, Formula::gaussian_exponent(psi, up, one), s + i);
        store(by_angle.x, by_angle.y, by_angle.z, s_by_angle + i);
    }
}

void further_features(const PackedObservations& rows, std::size_t block, int count, float* features) {
    const std::size_t first = block * k_block;
    for (std::size_t i = 0; i < rows.rows_in(block); i += Batch::size()) {
        const auto values = Formulas<Batch, PmModel>::pm_further_features(count, direction(rows.wl, first + i),
                                                                          direction(rows.wv, first + i));
        for (int k = 0; k < count; ++k) values.x[k].store(features + std::size_t(k) * k_block + i);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace SRBF_NAMESPACE {

HWY_EXPORT(variate_features);
HWY_EXPORT(further_features);

void variate_features(const PackedObservations& rows, std::size_t block, int order, float a, float b, bool axial,
                      float* s, float* s_by_angle) {
    HWY_DYNAMIC_DISPATCH(variate_features)(rows, block, order, a, b, axial, s, s_by_angle);
}
void further_features(const PackedObservations& rows, std::size_t block, int count, float* features) {
    HWY_DYNAMIC_DISPATCH(further_features)(rows, block, count, features);
}

}  // namespace
#endif
