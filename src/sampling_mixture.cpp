// Draws and densities of a mixture, its lobes in the lanes of vectors.
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
    using Row = MixtureProposal::Row;
    alignas(64) Row bandwidth, width, scale, rest;
    Row kind;  ///< -1: the cosine; 0: about the mirror direction; 1: of half vectors
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

// As many lobes as a vector holds.
using Lobes = BatchOf<hn::CappedTag<float, LobeTable::k_count>>;

HWY_INLINE Lobes everywhere(float x) { return Lobes(double(x)); }
HWY_INLINE Vec3<Lobes> everywhere(const Vec3f& w) { return {everywhere(w.x), everywhere(w.y), everywhere(w.z)}; }
HWY_INLINE Vec3<Lobes> select(Lobes::Mask where, const Vec3<Lobes>& a, const Vec3<Lobes>& b) {
    return {select(where, a.x, b.x), select(where, a.y, b.y), select(where, a.z, b.z)};
}

HWY_INLINE Lobes between(const MixtureProposal::Row& low, const MixtureProposal::Row& high, float part, int first) {
    const Lobes a = Lobes::load(&low[std::size_t(first)]), b = Lobes::load(&high[std::size_t(first)]);
    return a + everywhere(part) * (b - a);
}

// A mixture as a viewer sees it, in the frame of the grain if it has one: its lobes in the lanes of one vector after
// the other. Without a grain nothing is stretched or turned.
template <bool grain> struct Seen {
    using F = Formulas<Lobes, PmModel>;
    static constexpr int k_few = LobeTable::k_count / 2;  // beyond, there are half-vector lobes alone
    const MixtureProposal& proposal;
    const LobeTable& table;
    Vec3<Lobes> v, viewer;

    HWY_INLINE Seen(const MixtureProposal& of, const LobeTable& lobes, const Vec3f& wv)
        : proposal(of), table(lobes), v(everywhere(wv)), viewer(stretched(v)) {}
    HWY_INLINE Lobes stretch() const { return grain ? everywhere(proposal.stretch) : Lobes(1.0); }
    HWY_INLINE Vec3<Lobes> stretched(const Vec3<Lobes>& w) const {
        if constexpr (grain) return F::stretched(w, stretch());
        return {w.x, w.y, w.z};
    }
    HWY_INLINE static Lobes at(const LobeTable::Row& row, int k) { return Lobes::load(&row[std::size_t(k)]); }
    HWY_INLINE Lobes::Mask is_cosine(int k) const { return at(table.kind, k) < Lobes(0.0); }
    HWY_INLINE Lobes::Mask is_half_vector(int k) const { return Lobes(0.0) < at(table.kind, k); }

    HWY_INLINE F::ProposalLobe lobe(int k) const {
        const Lobes bandwidth = at(table.bandwidth, k);
        typename F::ProposalLobe seen = F::half_vector_lobe(viewer, bandwidth);
        if (k >= k_few) return seen;
        const auto where = is_half_vector(k);
        seen.centre = select(where, seen.centre, Vec3<Lobes>(-v.x, -v.y, v.z));
        seen.bandwidth = select(where, seen.bandwidth, bandwidth);
        seen.width = select(where, seen.width, at(table.width, k));
        seen.scale = select(where, seen.scale, at(table.scale, k));
        seen.rest = at(table.rest, k);
        return seen;
    }
    // What each of these lobes draws.
    HWY_INLINE Vec3<Lobes> draw(int k, const F::ProposalLobe& lobe, Lobes u1, Lobes u2) const {
        const Vec3<Lobes> w = F::sample_sharp_vmf(lobe.centre, lobe.width, lobe.rest, u1, u2);
        Vec3<Lobes> light = F::light_of(stretched(w), v);
        if (k < k_few) light = select(is_cosine(k), F::sample_cosine(u1, u2), select(is_half_vector(k), light, w));
        return F::folded(light);
    }
};

// The density of all lobes at one direction to the light, which is in the frame of the grain.
template <bool grain> struct Density {
    using F = typename Seen<grain>::F;
    const Seen<grain>& seen;
    Vec3<Lobes> l, mirrored;
    typename F::HalfVector above, below;
    const MixtureProposal::Row &low, &high;
    float part;
    Lobes sum{0.0};

    HWY_INLINE Density(const Seen<grain>& by, const NodesAbout& nodes, const Vec3f& wl)
        : seen(by),
          l(everywhere(wl)),
          mirrored(l.x, l.y, -l.z),
          above(F::half_vector(l, seen.v, seen.stretch())),
          below(F::half_vector(mirrored, seen.v, seen.stretch())),
          low(seen.proposal.weight(nodes.below)),
          high(seen.proposal.weight(nodes.below + 1)),
          part(nodes.part) {}
    HWY_INLINE void add(int k, const typename F::ProposalLobe& lobe) {
        Lobes of_lobes;
        if (k >= Seen<grain>::k_few) {
            of_lobes = F::folded_pdf(lobe, above, below);
        } else {
            const auto where = seen.is_half_vector(k);
            const auto either = [&](const typename F::HalfVector& h, const Vec3<Lobes>& w) HWY_ATTR {
                return typename F::HalfVector{select(where, h.direction, w), select(where, h.factor, Lobes(1.0))};
            };
            of_lobes = select(seen.is_cosine(k), F::cosine_pdf(l),
                              F::folded_pdf(lobe, either(above, l), either(below, mirrored)));
        }
        sum = sum + between(low, high, part, k) * of_lobes;
    }
};

template <bool grain>
float pdf_of(const MixtureProposal& proposal, const LobeTable& table, const Vec3f& wl, const Vec3f& wv) {
    const Seen<grain> seen(proposal, table, wv);
    Density<grain> density(seen, nodes_about(wv.z), wl);
    for (int k = 0; k < LobeTable::k_count; k += int(Lobes::size())) density.add(k, seen.lobe(k));
    return density.sum.sum();
}

// Put together in one store, for which loads of several of them need not wait.
HWY_INLINE DirectionSample with_pdf(const Vec3f& wl, float pdf) {
#if HWY_TARGET == HWY_SCALAR
    return {wl, pdf};
#else
    const hn::CappedTag<float, 4> d;
    const auto xz = hn::InterleaveLower(d, hn::Set(d, wl.x), hn::Set(d, wl.z));
    const auto y_ = hn::InterleaveLower(d, hn::Set(d, wl.y), hn::Set(d, pdf));
    alignas(16) float four[4];
    hn::Store(hn::InterleaveLower(d, xz, y_), d, four);
    DirectionSample sample;
    std::memcpy(&sample, four, sizeof sample);
    return sample;
#endif
}

// A direction and its density, 0 where there is no direction. `wv` is in the frame of the grain, the direction is not.
// Each lobe draws one while the selector chooses among them.
template <bool grain>
DirectionSample sample_of(const MixtureProposal& proposal, const LobeTable& table, Vec3f wv, Vec2f u, float selector) {
    constexpr int vectors = LobeTable::k_count / int(sizeof(Lobes) / sizeof(float));
    using Lobe = typename Seen<grain>::F::ProposalLobe;
    const Seen<grain> seen(proposal, table, wv);
    const NodesAbout nodes = nodes_about(wv.z);
    const auto &low = proposal.running(nodes.below), &high = proposal.running(nodes.below + 1);
    Lobe lobes[vectors];
    HWY_ALIGN float x[LobeTable::k_count], y[LobeTable::k_count], z[LobeTable::k_count];
    std::size_t chosen = 0;  // the first lobe whose running sum exceeds the selector
#pragma GCC unroll 4
    for (int i = 0; i < vectors; ++i) {
        const int k = i * int(Lobes::size());
        chosen += hn::CountTrue(Lobes::Tag(), hn::Ge(everywhere(selector).v, between(low, high, nodes.part, k).v));
        lobes[i] = seen.lobe(k);
        const Vec3<Lobes> each = seen.draw(k, lobes[i], everywhere(u.x), everywhere(u.y));
        each.x.store(x + k), each.y.store(y + k), each.z.store(z + k);
    }
    if (chosen >= MixtureProposal::k_lobes) chosen = 0;  // what rounding leaves over is the cosine's
    const Vec3f drawn(x[chosen], y[chosen], z[chosen]);
    const Vec3f wl = grain ? Kernel<float>::turned(drawn, proposal.cosine, proposal.sine) : drawn;
    if (!above_horizon(wl, wv)) return with_pdf(wl, 0);
    // As `pdf` turns it back, whose answer this is to the last digit.
    Density<grain> density(seen, nodes, grain ? Kernel<float>::turned(wl, proposal.cosine, -proposal.sine) : wl);
#pragma GCC unroll 4
    for (int i = 0; i < vectors; ++i) density.add(i * int(Lobes::size()), lobes[i]);
    return with_pdf(wl, density.sum.sum());
}

// There is a grain where lobes are stretched along it.
float mixture_pdf(const MixtureProposal& proposal, const LobeTable& table, const Vec3f& wl, const Vec3f& wv) {
    return (proposal.stretch == 1 ? pdf_of<false> : pdf_of<true>)(proposal, table, wl, wv);
}
DirectionSample sample_mixture(const MixtureProposal& proposal, const LobeTable& table, Vec3f wv, Vec2f u,
                               float selector) {
    return (proposal.stretch == 1 ? sample_of<false> : sample_of<true>)(proposal, table, wv, u, selector);
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
            table.width[i] = mirror.width;
            table.scale[i] = is_mirror ? mirror.scale : 0;  // the cosine is no lobe
            table.rest[i] = is_mirror ? mirror.rest : 0;
            table.kind[i] = k == 0 ? -1 : is_mirror ? 0 : 1;
        }
        return table;
    }();
    return all;
}

}  // namespace

Vec3f into_grain(const MixtureProposal& proposal, Vec3f w) { return K::turned(w, proposal.cosine, -proposal.sine); }
Vec3f out_of_grain(const MixtureProposal& proposal, Vec3f w) { return K::turned(w, proposal.cosine, proposal.sine); }

DirectionSample sample_with_pdf(const MixtureProposal& proposal, Vec3f wv, Vec2f u, float selector) {
    if (proposal.stretch != 1) wv = into_grain(proposal, wv);
    return HWY_DYNAMIC_DISPATCH(sample_mixture)(proposal, lobe_table(), wv, u, selector);
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
