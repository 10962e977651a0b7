// A model on arrays of pairs: the formulas of kernel.glsl on batches as wide as the machine's vectors.
#include "srbf/model.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "model/evaluate.cpp"
#include <hwy/foreach_target.h>

#include "batch-inl.h"

HWY_BEFORE_NAMESPACE();
namespace srbf {
namespace HWY_NAMESPACE {

constexpr std::size_t k_most = HWY_MAX_BYTES / sizeof(float);  // lanes of a batch

// By way of arrays: not every Highway in use loads and stores vectors of three.
Vec3<Batch> load_directions(const Vec3f* w) {
    HWY_ALIGN float x[k_most], y[k_most], z[k_most];
    for (std::size_t k = 0; k < Batch::size(); ++k) x[k] = w[k].x, y[k] = w[k].y, z[k] = w[k].z;
    return {Batch::load(x), Batch::load(y), Batch::load(z)};
}

void store_colours(Batch r, Batch g, Batch b, Rgb* f) {
    HWY_ALIGN float x[k_most], y[k_most], z[k_most];
    r.store(x), g.store(y), b.store(z);
    for (std::size_t k = 0; k < Batch::size(); ++k) f[k] = {x[k], y[k], z[k]};
}

void evaluate(const PmModel& model, const Vec3f* wl, const Vec3f* wv, Rgb* f, std::size_t count) {
    const Batch zero(0.0);
    const auto step = [&](const Vec3f* l, const Vec3f* v, Rgb* out) {
        const Vec3<Batch> light = load_directions(l), view = load_directions(v);
        const Vec3<Batch> value = Formulas<Batch, PmModel>::pm_value(model, light, view);
        const Batch lowest = min(light.z, view.z);
        const auto above = [&](Batch x) { return select(zero < lowest, x, zero); };
        store_colours(above(value.x), above(value.y), above(value.z), out);
    };
    std::size_t i = 0;
    for (; i + Batch::size() <= count; i += Batch::size()) step(wl + i, wv + i, f + i);
    if (i == count) return;
    // The rest, filled up with the normal.
    Vec3f last_wl[k_most], last_wv[k_most];
    Rgb last_f[k_most];
    for (std::size_t k = 0; k < Batch::size(); ++k) {
        last_wl[k] = i + k < count ? wl[i + k] : Vec3f(0, 0, 1);
        last_wv[k] = i + k < count ? wv[i + k] : Vec3f(0, 0, 1);
    }
    step(last_wl, last_wv, last_f);
    for (std::size_t k = 0; i + k < count; ++k) f[i + k] = last_f[k];
}

}  // namespace HWY_NAMESPACE
}  // namespace srbf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace srbf {

HWY_EXPORT(evaluate);

void evaluate(const PmModel& model, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f) {
    assert(wl.size() == wv.size() && wl.size() == f.size());
    HWY_DYNAMIC_DISPATCH(evaluate)(model, wl.data(), wv.data(), f.data(), f.size());
}

void evaluate(const Model& model, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f) {
    std::visit([&](const auto& m) { evaluate(m, wl, wv, f); }, model.model);
}

Evaluate evaluator(const PmModel& model) {
    return [&model](auto wl, auto wv, auto f) { evaluate(model, wl, wv, f); };
}

Evaluate evaluator(const Model& model) {
    return [&model](auto wl, auto wv, auto f) { evaluate(model, wl, wv, f); };
}

}  // namespace srbf
#endif
