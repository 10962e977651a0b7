// Draws and densities of a mixture, its lobes in the lanes of a vector.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>

#include "srbf/sampling.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sampling_mixture.cpp"
#include <hwy/foreach_target.h>

#include "batch-inl.h"

#ifndef SRBF_SAMPLING_MIXTURE
#define SRBF_SAMPLING_MIXTURE
namespace srbf {

/// What the lobes are made of, side by side.
struct LobeTable {
    static constexpr int k_count = MixtureProposal::k_lanes;
    alignas(32) std::array<float, k_count> bandwidth, scale, rest, is_half_way;
};

/// The two nodes about a view, and the part of the upper one.
struct NodesAbout {
    const float* low;
    const float* high;
    float part;
};
inline NodesAbout nodes_about(const MixtureProposal& proposal, float z) {
    const float at = std::sqrt(std::clamp(1 - z, 0.f, 1.f)) * (MixtureProposal::k_nodes - 1);
    const int below = std::min(int(at), MixtureProposal::k_nodes - 2);
    return {proposal.weight[std::size_t(below)].data(), proposal.weight[std::size_t(below + 1)].data(),
            at - float(below)};
}

}  // namespace srbf
#endif

HWY_BEFORE_NAMESPACE();
namespace srbf {
namespace HWY_NAMESPACE {

using Few = BatchOf<hn::CappedTag<float, 4>>;

template <typename B> HWY_INLINE B everywhere(float x) { return B(double(x)); }
template <typename B> HWY_INLINE Vec3<B> everywhere(const Vec3f& w) {
    return {everywhere<B>(w.x), everywhere<B>(w.y), everywhere<B>(w.z)};
}
template <typename B> HWY_INLINE Vec3<B> select(typename B::Mask where, const Vec3<B>& a, const Vec3<B>& b) {
    return {select(where, a.x, b.x), select(where, a.y, b.y), select(where, a.z, b.z)};
}

HWY_INLINE Group weights_of(const NodesAbout& nodes, std::size_t first) {
    const Group low = Group::load(nodes.low + first), high = Group::load(nodes.high + first);
    return low + everywhere<Group>(nodes.part) * (high - low);
}

// wl and wv are in the frame of the grain.
float mixture_pdf(const MixtureProposal& proposal, const LobeTable& table, const Vec3f& wl, const Vec3f& wv) {
    using F = Formulas<Group, PmModel>;
    // The half-way vectors of wl and of wl mirrored at the horizon, in the first two lanes.
    alignas(16) static constexpr float up_and_down[4] = {1, -1, 1, 1};
    HWY_ALIGN float half_way[4][4];
    for (std::size_t i = 0; i < 2; i += Few::size()) {
        const auto at = Formulas<Few, PmModel>::half_way(
            {everywhere<Few>(wl.x), everywhere<Few>(wl.y), Few::load(up_and_down + i) * everywhere<Few>(wl.z)},
            everywhere<Few>(wv), everywhere<Few>(proposal.stretch));
        at.direction.x.store(half_way[0] + i), at.direction.y.store(half_way[1] + i);
        at.direction.z.store(half_way[2] + i), at.factor.store(half_way[3] + i);
    }
    const auto of_half_way = [&](int i) HWY_ATTR {
        return typename F::HalfWay{
            {everywhere<Group>(half_way[0][i]), everywhere<Group>(half_way[1][i]), everywhere<Group>(half_way[2][i])},
            everywhere<Group>(half_way[3][i])};
    };
    const typename F::HalfWay above = of_half_way(0), below = of_half_way(1);
    const Vec3<Group> l = everywhere<Group>(wl), v = everywhere<Group>(wv), specular(-v.x, -v.y, v.z);
    const auto itself = F::itself(l), mirrored = F::itself({l.x, l.y, -l.z});
    const Vec3<Group> viewer = F::stretched(v, everywhere<Group>(proposal.stretch));
    const NodesAbout nodes = nodes_about(proposal, wv.z);
    Group sum(0.0);
    for (std::size_t k = 0; k < LobeTable::k_count; k += Group::size()) {
        const Group bandwidth = Group::load(&table.bandwidth[k]), scale = Group::load(&table.scale[k]);
        const auto seen = F::half_way_lobe(viewer, bandwidth);
        Group density;
        if (k >= 8) {  // half-way lobes alone
            density = F::folded_pdf(seen, above, below);
        } else {
            const auto where = Group(0.0) < Group::load(&table.is_half_way[k]);
            const auto either = [&](const typename F::HalfWay& a, const typename F::HalfWay& b) HWY_ATTR {
                return typename F::HalfWay{select(where, a.direction, b.direction), select(where, a.factor, b.factor)};
            };
            density = F::folded_pdf({select(where, seen.centre, specular), select(where, seen.bandwidth, bandwidth),
                                     select(where, seen.scale, scale), Group(0.0)},
                                    either(above, itself), either(below, mirrored));
        }
        sum = sum + weights_of(nodes, k) * density;
    }
    const float of_cosine = nodes.low[0] + nodes.part * (nodes.high[0] - nodes.low[0]);
    return sum.sum() + of_cosine * Kernel<float>::cosine_pdf(wl);
}

// The first lane of each in one store: what loads several of them need not wait for each.
HWY_INLINE void store_first(const Vec3<Few>& w, float* to) {
#if HWY_TARGET == HWY_SCALAR
    w.x.store(to), w.y.store(to + 1), w.z.store(to + 2);
#else
    const hn::CappedTag<float, 4> d;
    const auto xz = hn::InterleaveLower(d, w.x.v, w.z.v), y = hn::InterleaveLower(d, w.y.v, w.y.v);
    hn::Store(hn::InterleaveLower(d, xz, y), d, to);
#endif
}

// `wl` is of four numbers, x, y, z and one to spare.
void sample_mixture(const MixtureProposal& proposal, const LobeTable& table, const Vec3f& wv, Vec2f u, float selector,
                    float* wl) {
    using F = Formulas<Few, PmModel>;
    HWY_ALIGN float weight[LobeTable::k_count];
    const NodesAbout nodes = nodes_about(proposal, wv.z);
    for (std::size_t k = 0; k < LobeTable::k_count; k += Group::size()) weights_of(nodes, k).store(weight + k);
    // The first lobe at which the running sum exceeds the selector; what rounding leaves over is the cosine's.
    std::size_t k = 0;
    float running = 0;
    for (int i = 0; i < MixtureProposal::k_lobes; ++i) {
        running += weight[i];
        k += running <= selector ? 1 : 0;
    }
    if (k == MixtureProposal::k_lobes) k = 0;
    const Few u1 = everywhere<Few>(u.x), u2 = everywhere<Few>(u.y), stretch = everywhere<Few>(proposal.stretch),
              cosine = everywhere<Few>(proposal.cosine), sine = everywhere<Few>(proposal.sine);
    Vec3<Few> drawn;
    if (k == 0) {
        drawn = F::sample_cosine(u1, u2);
    } else {  // both kinds of lobes without a branch, which would be guessed wrong every other time
        const Vec3<Few> v = F::turned(everywhere<Few>(wv), cosine, -sine), specular(-v.x, -v.y, v.z);
        const Few bandwidth = everywhere<Few>(table.bandwidth[k]);
        const auto seen = F::half_way_lobe(F::stretched(v, stretch), bandwidth);
        const auto where = Few(0.0) < everywhere<Few>(table.is_half_way[k]);
        const Vec3<Few> w =
            F::sample_sharp_vmf(select(where, seen.centre, specular), select(where, seen.bandwidth, bandwidth),
                                everywhere<Few>(table.rest[k]), u1, u2);
        drawn = F::folded(select(where, Vec3<Few>(F::light_of(F::stretched(w, stretch), v)), w));
    }
    store_first(F::turned(drawn, cosine, sine), wl);
}

}  // namespace HWY_NAMESPACE
}  // namespace srbf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace srbf {
namespace {

HWY_EXPORT(mixture_pdf);
HWY_EXPORT(sample_mixture);

using K = Kernel<float>;
static_assert(MixtureProposal::k_lobes == SRBF_PROPOSAL_LOBES);

const LobeTable& lobe_table() {
    static const LobeTable all = [] {
        LobeTable table;
        for (int k = 0; k < LobeTable::k_count; ++k) {
            const auto i = std::size_t(k);
            const bool is_mirror = k > 0 && k < 5;
            table.bandwidth[i] = K::proposal_bandwidth(std::min(k, SRBF_PROPOSAL_LOBES - 1));
            const auto mirror = K::mirror_lobe({0, 0, 1}, table.bandwidth[i]);
            table.scale[i] = is_mirror ? mirror.scale : 0;  // the cosine is no lobe
            table.rest[i] = is_mirror ? mirror.rest : 0;
            table.is_half_way[i] = k >= 5 ? 1 : 0;
        }
        return table;
    }();
    return all;
}

}  // namespace

Vec3f into_grain(const MixtureProposal& proposal, Vec3f w) { return K::turned(w, proposal.cosine, -proposal.sine); }
Vec3f out_of_grain(const MixtureProposal& proposal, Vec3f w) { return K::turned(w, proposal.cosine, proposal.sine); }

Vec3f sample(const MixtureProposal& proposal, Vec3f wv, Vec2f u, float selector) {
    alignas(16) float drawn[4];
    HWY_DYNAMIC_DISPATCH(sample_mixture)(proposal, lobe_table(), wv, u, selector, drawn);
    Vec3f wl;
    std::memcpy(&wl, drawn, sizeof wl);
    return wl;
}

float pdf(const MixtureProposal& proposal, Vec3f wl, Vec3f wv) {
    if (!above_horizon(wl, wv)) return 0;
    return HWY_DYNAMIC_DISPATCH(mixture_pdf)(proposal, lobe_table(), into_grain(proposal, wl),
                                             into_grain(proposal, wv));
}

}  // namespace srbf
#endif
