// Draws and densities of a mixture, its lobes in the lanes of vectors; and densities of the points by which its weights
// are found, these in the lanes.
#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstring>

#include "sampling_points.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sampling_mixture.cpp"
#include <hwy/foreach_target.h>

#include "batch-inl.h"

#ifndef SRBF_SAMPLING_MIXTURE
#define SRBF_SAMPLING_MIXTURE
namespace srbf {

/// What the lobes are made of, side by side.
struct LobeTable {
    static constexpr int k_count = MixtureProposal::k_lobes;
    using Row = MixtureProposal::Row;
    alignas(64) Row bandwidth, width, scale, rest;
    Row kind;  ///< -1, -2: the cosine, its square; 0: about the mirror direction; 1: of half vectors
    Row pull;  ///< of half vectors: the mixture's or none
};

/// Between which nodes a view is, and the part of the upper one.
struct NodesAbout {
    std::size_t below;
    float part;
};

/// A view as its mixture takes it.
struct ViewOfMixture {
    Vec3f wv;
    NodesAbout nodes;
    Kernel<float>::Stretch map;
    float pull;
};

}  // namespace srbf
#endif

HWY_BEFORE_NAMESPACE();
namespace srbf {
namespace HWY_NAMESPACE {

// As many lobes as a vector holds.
using Lobes = BatchOf<hn::CappedTag<float, LobeTable::k_count>>;
// Few of what all lobes have in common.
using Few = BatchOf<hn::CappedTag<float, 4>>;

template <typename Lanes> HWY_INLINE Lanes in_all(float x) { return Lanes(double(x)); }
template <typename Lanes> HWY_INLINE Vec3<Lanes> in_all(const Vec3f& w) {
    return {in_all<Lanes>(w.x), in_all<Lanes>(w.y), in_all<Lanes>(w.z)};
}
template <typename Lanes> HWY_INLINE auto in_all(const Kernel<float>::Stretch& map) {
    return
        typename Formulas<Lanes, PmModel>::Stretch{in_all<Lanes>(map.x), in_all<Lanes>(map.y), in_all<Lanes>(map.more),
                                                   in_all<Lanes>(map.less), in_all<Lanes>(map.shrink)};
}
// The first few lanes.
template <typename D> HWY_INLINE Few the_first(hn::Vec<D> v) {
    if constexpr (hn::MaxLanes(D()) > 4)
        return the_first<hn::Half<D>>(hn::LowerHalf(hn::Half<D>(), v));
    else
        return v;
}
HWY_INLINE Lobes everywhere(float x) { return in_all<Lobes>(x); }

// Without branches, which could not be foreseen; `at` is less than the last node, so that there is an upper one.
HWY_INLINE NodesAbout nodes_about(float z) {
    constexpr float last = MixtureProposal::k_nodes - 1;
    const Few at =
        min(max(in_all<Few>(last) * (Few(1.0) - sqrt(in_all<Few>(z))), Few(0.0)), in_all<Few>(last * (1 - 1e-7f)));
    return {std::size_t(int(hn::GetLane(at.v))), hn::GetLane((at - Few(hn::Floor(at.v))).v)};
}
HWY_INLINE ViewOfMixture view_of(const MixtureProposal& proposal, const Vec3f& wv) {
    const NodesAbout nodes = nodes_about(wv.z);
    const auto between = [&](const auto& row) {
        return row[nodes.below] + nodes.part * (row[nodes.below + 1] - row[nodes.below]);
    };
    return {wv, nodes, Kernel<float>::stretch_along(tangent(proposal, wv), between(proposal.stretch)),
            Kernel<float>::pull_of_visibility(wv, between(proposal.power))};
}

HWY_INLINE Lobes between(const MixtureProposal::Row& low, const MixtureProposal::Row& high, float part, int first) {
    const Lobes a = Lobes::load(&low[std::size_t(first)]), b = Lobes::load(&high[std::size_t(first)]);
    return a + everywhere(part) * (b - a);
}

// A mixture as a viewer sees it, its lobes in the lanes of one vector after the other.
struct Seen {
    using F = Formulas<Lobes, PmModel>;
    static constexpr int k_few = LobeTable::k_count / 2;  // beyond, there are half-vector lobes alone
    const LobeTable& table;
    Lobes shrink, pull;
    Vec3<Lobes> v, viewer;

    HWY_INLINE Seen(const LobeTable& lobes, const ViewOfMixture& view)
        : table(lobes),
          shrink(everywhere(view.map.shrink)),
          pull(everywhere(view.pull)),
          v(in_all<Lobes>(view.wv)),
          viewer(in_all<Lobes>(Kernel<float>::stretched(view.wv, view.map))) {}
    HWY_INLINE static Lobes at(const LobeTable::Row& row, int k) { return Lobes::load(&row[std::size_t(k)]); }
    HWY_INLINE Lobes::Mask is_cosine(int k) const { return at(table.kind, k) < Lobes(0.0); }
    HWY_INLINE Lobes::Mask is_half_vector(int k) const { return Lobes(0.0) < at(table.kind, k); }

    HWY_INLINE F::ProposalLobe lobe(int k) const {
        const Lobes bandwidth = at(table.bandwidth, k);
        typename F::ProposalLobe seen = F::half_vector_lobe(viewer, shrink, bandwidth, pull * at(table.pull, k));
        if (k >= k_few) return seen;
        const auto where = is_half_vector(k);
        seen.centre = select(where, seen.centre, Vec3<Lobes>(-v.x, -v.y, v.z));
        seen.bandwidth = select(where, seen.bandwidth, bandwidth);
        seen.width = select(where, seen.width, at(table.width, k));
        seen.scale = select(where, seen.scale, at(table.scale, k));
        seen.rest = at(table.rest, k);
        return seen;
    }
};

// The half vectors of a direction to the light and of the same mirrored at the horizon, for all lobes.
struct BothHalfVectors {
    using F = Seen::F;
    F::HalfVector above, below;

    HWY_INLINE BothHalfVectors(const ViewOfMixture& view, const Vec3f& wl) {
        HWY_ALIGN static constexpr float up_and_down[4] = {1, -1, 1, 1};
        HWY_ALIGN float numbers[4][4];
        const auto map = in_all<Few>(view.map);
        for (std::size_t i = 0; i < 2; i += Few::size()) {
            const auto half = Formulas<Few, PmModel>::half_vector(
                {in_all<Few>(wl.x), in_all<Few>(wl.y), Few::load(up_and_down + i) * in_all<Few>(wl.z)},
                in_all<Few>(view.wv), map);
            half.direction.x.store(numbers[0] + i), half.direction.y.store(numbers[1] + i);
            half.direction.z.store(numbers[2] + i), half.factor.store(numbers[3] + i);
        }
        const auto of = [&](std::size_t i) HWY_ATTR {
            return F::HalfVector{{everywhere(numbers[0][i]), everywhere(numbers[1][i]), everywhere(numbers[2][i])},
                                 everywhere(numbers[3][i])};
        };
        above = of(0), below = of(1);
    }
};

// The density of all lobes at one direction to the light.
struct Density {
    using F = Seen::F;
    const Seen& seen;
    Vec3<Lobes> l, mirrored;
    BothHalfVectors half;
    const MixtureProposal::Row &low, &high;
    float part;
    Lobes sum{0.0};

    HWY_INLINE Density(const MixtureProposal& proposal, const Seen& by, const ViewOfMixture& view, const Vec3f& wl)
        : seen(by),
          l(in_all<Lobes>(wl)),
          mirrored(l.x, l.y, -l.z),
          half(view, wl),
          low(proposal.weight(view.nodes.below)),
          high(proposal.weight(view.nodes.below + 1)),
          part(view.nodes.part) {}
    HWY_INLINE void add(int k, const F::ProposalLobe& lobe) {
        Lobes of_lobes;
        if (k >= Seen::k_few) {
            of_lobes = F::folded_pdf(lobe, half.above, half.below);
        } else {
            const auto where = seen.is_half_vector(k);
            const auto either = [&](const F::HalfVector& h, const Vec3<Lobes>& w, Lobes factor) HWY_ATTR {
                return F::HalfVector{select(where, h.direction, w), select(where, h.factor, factor)};
            };
            // A cosine is a lobe of bandwidth 0 times a power of z, once.
            const Lobes kind = Seen::at(seen.table.kind, k);
            const Lobes power = select(kind < Lobes(-1.0), l.z * l.z, l.z);
            const auto is_cosine = kind < Lobes(0.0);
            of_lobes = F::folded_pdf(lobe, either(half.above, l, select(is_cosine, power, Lobes(1.0))),
                                     either(half.below, mirrored, select(is_cosine, Lobes(0.0), Lobes(1.0))));
        }
        sum = sum + between(low, high, part, k) * of_lobes;
    }
};

float mixture_pdf(const MixtureProposal& proposal, const LobeTable& table, const Vec3f& wl, const Vec3f& wv) {
    const ViewOfMixture view = view_of(proposal, wv);
    const Seen seen(table, view);
    Density density(proposal, seen, view, wl);
#pragma GCC unroll 4
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

// What a lobe draws, from numbers that are in all lanes the same.
HWY_INLINE Vec3f drawn_by(const ViewOfMixture& view, float kind, const Vec3<Few>& centre, Few width, Few rest,
                          const Vec2f& u) {
    using F = Formulas<Few, PmModel>;
    const Few u1 = in_all<Few>(u.x), u2 = in_all<Few>(u.y);
    Vec3<Few> wl;
    if (kind < 0) {
        wl = F::off_centre(Vec3<Few>(Few(0.0), Few(0.0), Few(1.0)), F::below_power_cosine(width, u1), u2);
    } else {
        const Vec3<Few> w = F::sample_sharp_vmf(centre, width, rest, u1, u2);
        const Vec3<Few> light = F::light_of(F::stretched(w, in_all<Few>(view.map)), in_all<Few>(view.wv));
        wl = F::folded(select(Few(0.0) < in_all<Few>(kind), light, w));
    }
    return {hn::GetLane(wl.x.v), hn::GetLane(wl.y.v), hn::GetLane(wl.z.v)};
}

// A draw: the lobes, since the density takes them too, and the direction.
struct Draw {
    static constexpr int k_vectors = LobeTable::k_count / int(sizeof(Lobes) / sizeof(float));
    Seen::F::ProposalLobe lobes[k_vectors];
    Vec3f wl;

    HWY_INLINE Draw(const MixtureProposal& proposal, const Seen& seen, const ViewOfMixture& view, const Vec2f& u,
                    float selector) {
        const auto &low = proposal.running(view.nodes.below), &high = proposal.running(view.nodes.below + 1);
        std::size_t chosen = 0;  // the first lobe whose running sum exceeds the selector
#pragma GCC unroll 4
        for (int i = 0; i < k_vectors; ++i) {
            const int k = i * int(Lobes::size());
            chosen +=
                hn::CountTrue(Lobes::Tag(), hn::Ge(everywhere(selector).v, between(low, high, view.nodes.part, k).v));
            lobes[i] = seen.lobe(k);
        }
        if (chosen >= MixtureProposal::k_lobes) chosen = 0;  // what rounding leaves over is the cosine's
        const Seen::F::ProposalLobe& lobe = lobes[k_vectors == 1 ? 0 : chosen / Lobes::size()];
        const auto lane =
            hn::IndicesFromVec(Lobes::Tag(), hn::Set(Lobes::Bits(), std::int32_t(chosen % Lobes::size())));
        const auto its = [&](Lobes all) HWY_ATTR { return the_first<Lobes::Tag>(hn::TableLookupLanes(all.v, lane)); };
        wl = drawn_by(view, seen.table.kind[chosen], {its(lobe.centre.x), its(lobe.centre.y), its(lobe.centre.z)},
                      its(lobe.width), in_all<Few>(seen.table.rest[chosen]), u);
    }
};

Vec3f draw_mixture(const MixtureProposal& proposal, const LobeTable& table, Vec3f wv, Vec2f u, float selector) {
    const ViewOfMixture view = view_of(proposal, wv);
    return Draw(proposal, Seen(table, view), view, u, selector).wl;
}

// A direction and its density, 0 where there is no direction.
DirectionSample sample_mixture(const MixtureProposal& proposal, const LobeTable& table, Vec3f wv, Vec2f u,
                               float selector) {
    const ViewOfMixture view = view_of(proposal, wv);
    const Seen seen(table, view);
    const Draw draw(proposal, seen, view, u, selector);
    if (!above_horizon(draw.wl, wv)) return with_pdf(draw.wl, 0);
    Density density(proposal, seen, view, draw.wl);
#pragma GCC unroll 4
    for (int i = 0; i < Draw::k_vectors; ++i) density.add(i * int(Lobes::size()), draw.lobes[i]);
    return with_pdf(draw.wl, density.sum.sum());
}

void densities_of_points(SamplingPoints& points, const ProposalShape& shape) {
    using F = Formulas<Lobes, PmModel>;
    const auto at = [](const auto& rows, std::size_t i) HWY_ATTR {
        return Vec3<Lobes>(Lobes::load(&rows[0][i]), Lobes::load(&rows[1][i]), Lobes::load(&rows[2][i]));
    };
    for (std::size_t i = 0; i < points.size(); i += Lobes::size()) {
        const Vec3<Lobes> wv = at(points.wv, i);
        const Vec3<Lobes> tangent = shape.is_grain() ? in_all<Lobes>(Vec3f(shape.cosine, shape.sine, 0)) : wv;
        const auto point = F::proposal_point(at(points.wl, i), wv, F::stretch_along(tangent, everywhere(shape.stretch)),
                                             everywhere(shape.power));
        for (int k = 0; k < LobeTable::k_count; ++k)
            F::proposal_lobe_pdf(k, point).store(&points.density[std::size_t(k)][i]);
    }
}

double slopes_of_points(const SamplingPoints& points, const float* of_lobe, double* slope) {
    constexpr std::size_t most = 256;  // points at once
    const std::size_t lobes = points.density.size();
    HWY_ALIGN float factor[most];
    double moment = 0;
    std::fill_n(slope, lobes, 0.0);
    for (std::size_t first = 0; first < points.size(); first += most) {
        const std::size_t count = std::min(most, points.size() - first);
        Lobes sum(0.0);
        for (std::size_t i = 0; i < count; i += Lobes::size()) {
            Lobes pdf(0.0);
            for (std::size_t k = 0; k < lobes; ++k)
                pdf = pdf + everywhere(of_lobe[k]) * Lobes::load(&points.density[k][first + i]);
            pdf = max(pdf, everywhere(1e-15f));  // whose square is none too small for a float
            const Lobes share = Lobes::load(&points.weight[first + i]) / pdf;
            sum = sum + share;
            (share / pdf).store(factor + i);
        }
        moment += double(sum.sum());
        for (std::size_t k = 0; k < lobes; ++k) {
            Lobes of_these(0.0);
            for (std::size_t i = 0; i < count; i += Lobes::size())
                of_these = of_these + Lobes::load(factor + i) * Lobes::load(&points.density[k][first + i]);
            slope[k] += double(of_these.sum());
        }
    }
    return moment;
}

}  // namespace HWY_NAMESPACE
}  // namespace srbf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace srbf {
namespace {

HWY_EXPORT(mixture_pdf);
HWY_EXPORT(draw_mixture);
HWY_EXPORT(sample_mixture);
HWY_EXPORT(densities_of_points);
HWY_EXPORT(slopes_of_points);

using K = Kernel<float>;
static_assert(MixtureProposal::k_lobes == SRBF_PROPOSAL_LOBES);

const LobeTable& lobe_table() {
    static const LobeTable all = [] {
        LobeTable table;
        for (int k = 0; k < LobeTable::k_count; ++k) {
            const auto i = std::size_t(k);
            const bool is_mirror = k > 1 && k < 6;
            table.bandwidth[i] = k < 2 ? 0 : K::proposal_bandwidth(k);
            const auto mirror = K::mirror_lobe({0, 0, 1}, K::proposal_bandwidth(k));
            table.width[i] = k == 0 ? 0.5f : k == 1 ? 1.f / 3 : mirror.width;
            table.scale[i] = is_mirror ? mirror.scale : float((k + 2) / (2 * k_pi));
            table.rest[i] = is_mirror ? mirror.rest : 0;
            table.kind[i] = k < 2 ? float(-1 - k) : is_mirror ? 0 : 1;
            table.pull[i] = K::proposal_pull(k, 1);
        }
        return table;
    }();
    return all;
}

}  // namespace

DirectionSample sample_with_pdf(const MixtureProposal& proposal, Vec3f wv, Vec2f u, float selector) {
    return HWY_DYNAMIC_DISPATCH(sample_mixture)(proposal, lobe_table(), wv, u, selector);
}

Vec3f sample(const MixtureProposal& proposal, Vec3f wv, Vec2f u, float selector) {
    return HWY_DYNAMIC_DISPATCH(draw_mixture)(proposal, lobe_table(), wv, u, selector);
}

void set_densities(SamplingPoints& points, const ProposalShape& shape) {
    points.density.resize(MixtureProposal::k_lobes);
    for (auto& of_lobe : points.density) of_lobe.resize(points.size());
    HWY_DYNAMIC_DISPATCH(densities_of_points)(points, shape);
}

double set_slopes(const SamplingPoints& points, std::span<const float> of_lobe, std::span<double> slope) {
    assert(of_lobe.size() == points.density.size() && slope.size() == of_lobe.size());
    return HWY_DYNAMIC_DISPATCH(slopes_of_points)(points, of_lobe.data(), slope.data());
}

float pdf(const MixtureProposal& proposal, Vec3f wl, Vec3f wv) {
    if (!above_horizon(wl, wv)) return 0;
    return HWY_DYNAMIC_DISPATCH(mixture_pdf)(proposal, lobe_table(), wl, wv);
}

}  // namespace srbf
#endif
