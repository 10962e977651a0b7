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
    alignas(32) std::array<float, k_count> bandwidth, scale, rest, is_half_vector;
};

/// Between which nodes a view is, and the part of the upper one.
struct NodesAbout {
    std::size_t below;
    float part;
};
inline NodesAbout nodes_about(float z) {
    const float at = std::sqrt(std::clamp(1 - z, 0.f, 1.f)) * (MixtureProposal::k_nodes - 1);
    const int below = std::min(int(at), MixtureProposal::k_nodes - 2);
    return {std::size_t(below), at - float(below)};
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

HWY_INLINE Group between(const MixtureProposal::Row& low, const MixtureProposal::Row& high, float part,
                         std::size_t first) {
    const Group a = Group::load(&low[first]), b = Group::load(&high[first]);
    return a + everywhere<Group>(part) * (b - a);
}

// The lobes as a viewer sees them, side by side, in the frame of the grain.
struct SeenLobes {
    HWY_ALIGN float x[LobeTable::k_count], y[LobeTable::k_count], z[LobeTable::k_count], bandwidth[LobeTable::k_count],
        scale[LobeTable::k_count];

    HWY_INLINE SeenLobes(const LobeTable& table, const Vec3f& wv, float stretch) {
        using F = Formulas<Group, PmModel>;
        const Vec3<Group> v = everywhere<Group>(wv), specular(-v.x, -v.y, v.z);
        const Vec3<Group> viewer = F::stretched(v, everywhere<Group>(stretch));
        for (std::size_t k = 0; k < LobeTable::k_count; k += Group::size()) {
            const Group width = Group::load(&table.bandwidth[k]);
            auto seen = F::half_vector_lobe(viewer, width);
            if (k < 8) {  // beyond, half-vector lobes alone
                const auto where = Group(0.0) < Group::load(&table.is_half_vector[k]);
                seen.centre = select(where, seen.centre, specular);
                seen.bandwidth = select(where, seen.bandwidth, width);
                seen.scale = select(where, seen.scale, Group::load(&table.scale[k]));
            }
            seen.centre.x.store(x + k), seen.centre.y.store(y + k), seen.centre.z.store(z + k);
            seen.bandwidth.store(bandwidth + k), seen.scale.store(scale + k);
        }
    }
};

// The density of all of them at wl; wl and wv are in the frame of the grain.
HWY_INLINE float density(const MixtureProposal& proposal, const LobeTable& table, const SeenLobes& lobes,
                         const NodesAbout& nodes, const Vec3f& wl, const Vec3f& wv) {
    using F = Formulas<Group, PmModel>;
    // The half vectors of wl and of wl mirrored at the horizon, in the first two lanes.
    alignas(16) static constexpr float up_and_down[4] = {1, -1, 1, 1};
    HWY_ALIGN float half_vector[4][4];
    for (std::size_t i = 0; i < 2; i += Few::size()) {
        const auto at = Formulas<Few, PmModel>::half_vector(
            {everywhere<Few>(wl.x), everywhere<Few>(wl.y), Few::load(up_and_down + i) * everywhere<Few>(wl.z)},
            everywhere<Few>(wv), everywhere<Few>(proposal.stretch));
        at.direction.x.store(half_vector[0] + i), at.direction.y.store(half_vector[1] + i);
        at.direction.z.store(half_vector[2] + i), at.factor.store(half_vector[3] + i);
    }
    const auto of_half_vector = [&](int i) HWY_ATTR {
        return typename F::HalfVector{{everywhere<Group>(half_vector[0][i]), everywhere<Group>(half_vector[1][i]),
                                       everywhere<Group>(half_vector[2][i])},
                                      everywhere<Group>(half_vector[3][i])};
    };
    const typename F::HalfVector above = of_half_vector(0), below = of_half_vector(1);
    const Vec3<Group> l = everywhere<Group>(wl);
    const auto itself = F::itself(l), mirrored = F::itself({l.x, l.y, -l.z});
    const auto &low = proposal.weight(nodes.below), &high = proposal.weight(nodes.below + 1);
    Group sum(0.0);
    for (std::size_t k = 0; k < LobeTable::k_count; k += Group::size()) {
        const typename F::ProposalLobe lobe{
            {Group::load(lobes.x + k), Group::load(lobes.y + k), Group::load(lobes.z + k)},
            Group::load(lobes.bandwidth + k),
            Group::load(lobes.scale + k),
            Group(0.0)};
        Group of_lobes;
        if (k >= 8) {  // half-vector lobes alone
            of_lobes = F::folded_pdf(lobe, above, below);
        } else {
            const auto where = Group(0.0) < Group::load(&table.is_half_vector[k]);
            const auto either = [&](const typename F::HalfVector& a, const typename F::HalfVector& b) HWY_ATTR {
                return
                    typename F::HalfVector{select(where, a.direction, b.direction), select(where, a.factor, b.factor)};
            };
            of_lobes = F::folded_pdf(lobe, either(above, itself), either(below, mirrored));
        }
        sum = sum + between(low, high, nodes.part, k) * of_lobes;
    }
    const float of_cosine = low[0] + nodes.part * (high[0] - low[0]);
    return sum.sum() + of_cosine * Kernel<float>::cosine_pdf(wl);
}

float mixture_pdf(const MixtureProposal& proposal, const LobeTable& table, const Vec3f& wl, const Vec3f& wv) {
    return density(proposal, table, SeenLobes(table, wv, proposal.stretch), nodes_about(wv.z), wl, wv);
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

// The direction's x, y, z and its density, 0 where there is no direction. `wv` is in the frame of the grain, the
// direction is not.
void sample_mixture(const MixtureProposal& proposal, const LobeTable& table, const Vec3f& wv, Vec2f u, float selector,
                    float* drawn) {
    using F = Formulas<Few, PmModel>;
    const NodesAbout nodes = nodes_about(wv.z);
    const SeenLobes lobes(table, wv, proposal.stretch);
    // The first lobe whose running sum exceeds the selector; what rounding leaves over is the cosine's.
    const auto &low = proposal.running(nodes.below), &high = proposal.running(nodes.below + 1);
    Group passed(0.0);
    for (std::size_t k = 0; k < LobeTable::k_count; k += Group::size()) {
        const Group running = between(low, high, nodes.part, k);
        passed = passed + select(everywhere<Group>(selector) < running, Group(0.0), Group(1.0));
    }
    auto k = std::size_t(passed.sum());
    if (k >= MixtureProposal::k_lobes) k = 0;
    const Few u1 = everywhere<Few>(u.x), u2 = everywhere<Few>(u.y), stretch = everywhere<Few>(proposal.stretch),
              cosine = everywhere<Few>(proposal.cosine), sine = everywhere<Few>(proposal.sine);
    Vec3<Few> direction;
    if (k == 0) {
        direction = F::sample_cosine(u1, u2);
    } else {  // both kinds of lobes without a branch, which would be guessed wrong every other time
        const auto where = Few(0.0) < everywhere<Few>(table.is_half_vector[k]);
        const Vec3<Few> w =
            F::sample_sharp_vmf({everywhere<Few>(lobes.x[k]), everywhere<Few>(lobes.y[k]), everywhere<Few>(lobes.z[k])},
                                everywhere<Few>(lobes.bandwidth[k]), everywhere<Few>(table.rest[k]), u1, u2);
        direction = F::folded(select(where, Vec3<Few>(F::light_of(F::stretched(w, stretch), everywhere<Few>(wv))), w));
    }
    store_first(F::turned(direction, cosine, sine), drawn);
    const Vec3f wl(drawn[0], drawn[1], drawn[2]);
    drawn[3] = above_horizon(wl, wv) ? density(proposal, table, lobes, nodes,
                                               Kernel<float>::turned(wl, proposal.cosine, -proposal.sine), wv)
                                     : 0;
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
            table.is_half_vector[i] = k >= 5 ? 1 : 0;
        }
        return table;
    }();
    return all;
}

}  // namespace

Vec3f into_grain(const MixtureProposal& proposal, Vec3f w) { return K::turned(w, proposal.cosine, -proposal.sine); }
Vec3f out_of_grain(const MixtureProposal& proposal, Vec3f w) { return K::turned(w, proposal.cosine, proposal.sine); }

DirectionSample sample_with_pdf(const MixtureProposal& proposal, Vec3f wv, Vec2f u, float selector) {
    alignas(16) float drawn[4];
    HWY_DYNAMIC_DISPATCH(sample_mixture)(proposal, lobe_table(), into_grain(proposal, wv), u, selector, drawn);
    DirectionSample sample;
    std::memcpy(&sample, drawn, sizeof sample);
    return sample;
}

Vec3f sample(const MixtureProposal& proposal, Vec3f wv, Vec2f u, float selector) {
    return sample_with_pdf(proposal, wv, u, selector).wl;
}

float pdf(const MixtureProposal& proposal, Vec3f wl, Vec3f wv) {
    if (!above_horizon(wl, wv)) return 0;
    return HWY_DYNAMIC_DISPATCH(mixture_pdf)(proposal, lobe_table(), into_grain(proposal, wl),
                                             into_grain(proposal, wv));
}

}  // namespace srbf
#endif
