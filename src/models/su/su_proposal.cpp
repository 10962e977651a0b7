// Draws of a view-by-view model: a sampled view, a lobe, a direction.
#include <algorithm>
#include <cassert>

#include "base/floating_point.h"
#include "models/su/neighbours.h"
#include "srbf/sampling.h"

namespace srbf {
namespace {

using K = Kernel<float>;

/// The share of samples by the cosine, with which the largest variance is less than with a tenth (docs/sampling.md), and
/// what a lobe that reflects nothing is taken for.
constexpr float k_by_cosine = 0.25f, k_least_integral = 1e-20f;
constexpr float k_last = 0x1.fffffep-1f;  // below 1

/// Splits u, uniform in [0,1), by shares that sum to 1: the first whose running sum exceeds u, and u uniform again
/// within it.
struct Choice {
    int k;
    float u;
};
template <typename Share> Choice choose(int count, float u, const Share& share) {
    int last = 0;
    for (int k = 0; k < count; ++k) {
        const float part = share(k);
        if (!(part > 0)) continue;
        if (u < part) return {k, std::min(u / part, k_last)};
        u -= part;
        last = k;
    }
    return {last, k_last};  // what rounding left over
}

}  // namespace

ViewProposal propose(const SuModel& model) {
    const StandardArithmetic mode;
    assert(model.discretise == Discretise::view);
    ViewProposal proposal{&model, lobe_integrals(model)};
    const auto J = std::size_t(model.lobes);
    for (std::size_t first = 0; first < proposal.share.size(); first += J) {
        float sum = 0;
        for (std::size_t k = first; k < first + J; ++k) {
            float& share = proposal.share[k];
            sum += share = std::max(share * float(luminance(model.coefficient[k])), k_least_integral);
        }
        for (std::size_t k = first; k < first + J; ++k) proposal.share[k] /= sum;
    }
    return proposal;
}

Vec3f sample(const ViewProposal& proposal, Vec3f wv, Vec2f u, float selector) {
    if (selector < k_by_cosine) return K::sample_cosine(u.x, u.y);
    const SuModel& model = *proposal.model;
    const Neighbours neighbours = neighbours_at(model, wv);
    const Choice view = choose(neighbours.count, std::min((selector - k_by_cosine) / (1 - k_by_cosine), k_last),
                               [&](int k) { return neighbours.of[std::size_t(k)].weight; });
    const auto& neighbour = neighbours.of[std::size_t(view.k)];
    const auto first = std::size_t(neighbour.view) * std::size_t(model.lobes);
    const Choice lobe = choose(model.lobes, view.u, [&](int j) { return proposal.share[first + std::size_t(j)]; });
    const std::size_t at = first + std::size_t(lobe.k);
    return K::turned(K::sample_vmf(model.centre[at], model.bandwidth[at], u.x, u.y), neighbour.cosine, -neighbour.sine);
}

float pdf(const ViewProposal& proposal, Vec3f wl, Vec3f wv) {
    if (!above_horizon(wl, wv)) return 0;
    const SuModel& model = *proposal.model;
    const Neighbours neighbours = neighbours_at(model, wv);
    float by_lobes = 0;
    for (int k = 0; k < neighbours.count; ++k) {
        const auto& neighbour = neighbours.of[std::size_t(k)];
        const Vec3f turned = K::turned(wl, neighbour.cosine, neighbour.sine);
        const auto first = std::size_t(neighbour.view) * std::size_t(model.lobes);
        for (std::size_t at = first; at < first + std::size_t(model.lobes); ++at)
            by_lobes +=
                neighbour.weight * proposal.share[at] * K::vmf_pdf(turned, model.centre[at], model.bandwidth[at]);
    }
    return k_by_cosine * K::cosine_pdf(wl) + (1 - k_by_cosine) * by_lobes;
}

}  // namespace srbf
