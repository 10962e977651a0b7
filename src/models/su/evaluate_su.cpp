// Evaluates a view-by-view model on arrays of pairs. Sampled views and weights are computed once for consecutive pairs
// that share the sampled direction; values are evaluated in SIMD batches.
#include "srbf/models/su.h"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "models/su/evaluate_su.cpp"
#include <hwy/foreach_target.h>

#include "base/floating_point.h"
#include "brdf/batch-inl.h"
#include "models/su/neighbours.h"
#include "models/su/su_functions.h"

HWY_BEFORE_NAMESPACE();
namespace SRBF_NAMESPACE {
namespace HWY_NAMESPACE {

void evaluate_run(const SuModel& model, const ViewNeighbours& neighbours, const Vec3f* w, Rgb* f, std::size_t count) {
    constexpr std::size_t max = HWY_MAX_BYTES / sizeof(float);
    using Formula = Formulas<Batch, PmModel>;
    HWY_ALIGN float x[max] = {}, y[max] = {}, z[max] = {};
    for (std::size_t i = 0; i < count; i += Batch::size()) {
        const std::size_t size = count - i < Batch::size() ? count - i : Batch::size();
        for (std::size_t k = 0; k < size; ++k) x[k] = w[i + k].x, y[k] = w[i + k].y, z[k] = w[i + k].z;
        const Vec3<Batch> direction(Batch::load(x), Batch::load(y), Batch::load(z));
        Vec3<Batch> sum(Batch(0.0), Batch(0.0), Batch(0.0));
        for (int k = 0; k < neighbours.count; ++k) {
            const auto& neighbour = neighbours.view[std::size_t(k)];
            const Batch cosine(double(neighbour.cosine)), sine(double(neighbour.sine));
            sum = sum + Batch(double(neighbour.weight)) *
                            Formula::su_view_value(model, neighbour.view, Formula::turned(direction, cosine, sine));
        }
        sum.x.store(x), sum.y.store(y), sum.z.store(z);
        for (std::size_t k = 0; k < size; ++k) f[i + k] = {x[k], y[k], z[k]};
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace SRBF_NAMESPACE {
namespace {

HWY_EXPORT(evaluate_run);

}  // namespace

ViewNeighbours find_neighbours(const SuModel& model, Vec3f w) {
    ViewNeighbours neighbours;
    const auto add = [&](const Kernel<float>::SuNeighbour& neighbour) {
        if (neighbour.weight > 0) neighbours.view[std::size_t(neighbours.count++)] = neighbour;
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
    for (int k = 0; k < neighbours.count; ++k) neighbours.view[std::size_t(k)].weight /= sum;
    return neighbours;
}

void evaluate(const SuModel& model, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f) {
    const StandardArithmetic mode;
    require_equal_lengths(wl.size(), wv.size(), f.size());
    const auto &sampled = model.discretise == Discretise::view ? wv : wl,
               &evaluated = model.discretise == Discretise::view ? wl : wv;
    for (std::size_t begin = 0, end = 0; begin < f.size(); begin = end) {
        for (end = begin + 1; end < f.size() && sampled[end] == sampled[begin];) ++end;
        if (above_horizon(sampled[begin], sampled[begin])) HWY_DYNAMIC_DISPATCH(evaluate_run)
        (model, find_neighbours(model, sampled[begin]), &evaluated[begin], &f[begin], end - begin);
        for (std::size_t i = begin; i < end; ++i)
            if (!above_horizon(wl[i], wv[i])) f[i] = {};
    }
}

namespace {

/// A lobe about the maximum of another above the horizon, as a proposal for samples.
struct ProposalLobe {
    Vec3f centre;
    float bandwidth;
};
ProposalLobe proposal_lobe(Vec3f xi, float bandwidth) {
    const float across = std::sqrt(xi.x * xi.x + xi.y * xi.y);
    if (xi.z > 0) return {xi, bandwidth};
    if (across < 1e-6f) return {{0, 0, 1}, 0};
    return {{xi.x / across, xi.y / across, 0}, bandwidth * std::max(across, 0.05f)};
}

}  // namespace

std::vector<float> lobe_integrals(const SuModel& model) {
    using K = Kernel<float>;
    constexpr int k_points = 512;
    const StandardArithmetic mode;
    std::vector<float> integrals(model.centre.size());
    for (std::size_t lobe = 0; lobe < model.centre.size(); ++lobe) {
        const Vec3f xi = model.centre[lobe];
        const ProposalLobe proposal = proposal_lobe(xi, model.bandwidth[lobe]);
        double sum = 0;
        for (int i = 0; i < k_points; ++i) {
            constexpr double golden = 0.6180339887498949;
            const double turns = i * golden;
            const float u1 = (float(i) + 0.5f) / k_points, u2 = float(turns - std::floor(turns));
            const Vec3f w = K::sample_vmf(proposal.centre, proposal.bandwidth, u1, u2);
            if (!(w.z > 0)) continue;
            const float ratio = K::gaussian_exponent(w, xi, model.bandwidth[lobe]) -
                                K::gaussian_exponent(w, proposal.centre, proposal.bandwidth);
            sum += double(w.z * K::exp_of_lobe(ratio));
        }
        integrals[lobe] = float(double(K::gaussian_integral(proposal.bandwidth)) * sum / k_points);
    }
    return integrals;
}

std::vector<Rgb> view_integrals(const SuModel& model) {
    const std::vector<float> lobe_integral = lobe_integrals(model);
    std::vector<Rgb> integrals(model.direction.size());
    for (std::size_t lobe = 0; lobe < lobe_integral.size(); ++lobe)
        for (int c = 0; c < 3; ++c)
            integrals[lobe / std::size_t(model.lobes)][c] += lobe_integral[lobe] * model.coefficient[lobe][c];
    return integrals;
}

Rgb between_views(const SuModel& model, std::span<const Rgb> values, Vec3f wv) {
    const StandardArithmetic mode;
    const ViewNeighbours neighbours = find_neighbours(model, wv);
    Rgb sum;
    for (int k = 0; k < neighbours.count; ++k) {
        const auto& neighbour = neighbours.view[std::size_t(k)];
        for (int c = 0; c < 3; ++c) sum[c] += neighbour.weight * values[std::size_t(neighbour.view)][c];
    }
    return sum;
}

Evaluate evaluator(const SuModel& model) {
    return [&model](auto wl, auto wv, auto f) { evaluate(model, wl, wv, f); };
}

}  // namespace
#endif
