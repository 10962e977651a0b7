// Evaluation of a view-by-view model on arrays of pairs. The sampled views and weights are computed once for
// consecutive pairs that share the sampled direction; their values are evaluated in SIMD batches.
#include "srbf/su.h"

#include <cassert>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "model/evaluate_su.cpp"
#include <hwy/foreach_target.h>

#include "batch-inl.h"
#include "floating_point.h"

#ifndef SRBF_EVALUATE_SU
#define SRBF_EVALUATE_SU
namespace srbf {

/// Sampled views with weights that sum to 1.
struct Neighbours {
    std::array<Kernel<float>::SuNeighbour, k_most_neighbours> of;
    int count = 0;
};

}  // namespace srbf
#endif

HWY_BEFORE_NAMESPACE();
namespace srbf {
namespace HWY_NAMESPACE {

void evaluate_run(const SuModel& model, const Neighbours& neighbours, const Vec3f* w, Rgb* f, std::size_t count) {
    constexpr std::size_t most = HWY_MAX_BYTES / sizeof(float);
    using Formula = Formulas<Batch, PmModel>;
    HWY_ALIGN float x[most] = {}, y[most] = {}, z[most] = {};
    for (std::size_t i = 0; i < count; i += Batch::size()) {
        const std::size_t here = count - i < Batch::size() ? count - i : Batch::size();
        for (std::size_t k = 0; k < here; ++k) x[k] = w[i + k].x, y[k] = w[i + k].y, z[k] = w[i + k].z;
        const Vec3<Batch> at(Batch::load(x), Batch::load(y), Batch::load(z));
        Vec3<Batch> sum(Batch(0.0), Batch(0.0), Batch(0.0));
        for (int k = 0; k < neighbours.count; ++k) {
            const auto& neighbour = neighbours.of[std::size_t(k)];
            const Batch cosine(double(neighbour.cosine)), sine(double(neighbour.sine));
            sum = sum + Batch(double(neighbour.weight)) *
                            Formula::su_view_value(model, neighbour.view, Formula::turned(at, cosine, sine));
        }
        sum.x.store(x), sum.y.store(y), sum.z.store(z);
        for (std::size_t k = 0; k < here; ++k) f[i + k] = {x[k], y[k], z[k]};
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace srbf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace srbf {
namespace {

HWY_EXPORT(evaluate_run);

Neighbours neighbours_at(const SuModel& model, Vec3f w) {
    Neighbours neighbours;
    const auto add = [&](const Kernel<float>::SuNeighbour& neighbour) {
        if (neighbour.weight > 0) neighbours.of[std::size_t(neighbours.count++)] = neighbour;
    };
    if (model.interpolation == SuInterpolation::rotated) {
        for (int k = 0; k < SU_ROTATED_NEIGHBOURS; ++k) add(Kernel<float>::su_rotated_neighbour(model, w, k));
        return neighbours;
    }
    const NearestViews nearest = nearest_views(model, w);
    float sum = 0;
    for (int k = 0; k < model.neighbours; ++k) {
        const float weight = Kernel<float>::su_plain_weight(model, nearest, w, model.neighbours, k);
        add({nearest[std::size_t(k)], weight, 1, 0});
        sum += weight;
    }
    for (int k = 0; k < neighbours.count; ++k) neighbours.of[std::size_t(k)].weight /= sum;
    return neighbours;
}

}  // namespace

void evaluate(const SuModel& model, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f) {
    const StandardArithmetic mode;
    assert(wl.size() == wv.size() && wl.size() == f.size());
    const auto &sampled = model.discretise == Discretise::view ? wv : wl,
               &of_lobes = model.discretise == Discretise::view ? wl : wv;
    for (std::size_t begin = 0, end = 0; begin < f.size(); begin = end) {
        while (end < f.size() && sampled[end] == sampled[begin]) ++end;
        HWY_DYNAMIC_DISPATCH(evaluate_run)
        (model, neighbours_at(model, sampled[begin]), &of_lobes[begin], &f[begin], end - begin);
        for (std::size_t i = begin; i < end; ++i)
            if (!(wl[i].z > 0 && wv[i].z > 0)) f[i] = {};
    }
}

Evaluate evaluator(const SuModel& model) {
    return [&model](auto wl, auto wv, auto f) { evaluate(model, wl, wv, f); };
}

}  // namespace srbf
#endif
