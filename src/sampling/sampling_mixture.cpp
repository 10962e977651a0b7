// Sampling and densities of a mixture, with its lobes in the lanes of vectors; and densities at the points that
// determine its weights, with points in the lanes.
#include <algorithm>
#include <cassert>
#include <cstring>

#include "sampling/elevation_nodes.h"
#include "sampling/mixture.h"
#include "sampling/sampling_points.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sampling/sampling_mixture.cpp"
#include <hwy/foreach_target.h>

#include "brdf/batch-inl.h"

#ifndef SRBF_SAMPLING_MIXTURE
#define SRBF_SAMPLING_MIXTURE
namespace SRBF_NAMESPACE {

/// A view direction, with the parameters that the mixture interpolates for it.
struct MixtureView {
    Vec3f wv, tangent;
    NodePosition nodes;
    HalfVectorShape shape;
};

}  // namespace
#endif

HWY_BEFORE_NAMESPACE();
namespace SRBF_NAMESPACE {
namespace HWY_NAMESPACE {

// A vector of lobes of one kind.
using LobeLanes = BatchOf<hn::CappedTag<float, LobeTable::k_per_kind>, true>;
// A short vector for values that all lobes share.
using FourLanes = BatchOf<hn::CappedTag<float, 4>, true>;

template <typename Lanes> HWY_INLINE Lanes broadcast(float x) { return Lanes(double(x)); }
template <typename Lanes> HWY_INLINE Vec3<Lanes> broadcast(const Vec3f& w) {
    return {broadcast<Lanes>(w.x), broadcast<Lanes>(w.y), broadcast<Lanes>(w.z)};
}
template <typename Lanes> HWY_INLINE auto broadcast(const Kernel<float>::Stretch& map) {
    return typename Formulas<Lanes, PmModel>::Stretch{
        broadcast<Lanes>(map.x), broadcast<Lanes>(map.y), broadcast<Lanes>(map.stretch_minus_1),
        broadcast<Lanes>(map.inverse_minus_1), broadcast<Lanes>(map.inverse)};
}
HWY_INLINE LobeLanes broadcast_lobes(float x) { return broadcast<LobeLanes>(x); }

// Branch-free: branches would be unpredictable. The position is below the last node, so that there is an upper one.
HWY_INLINE NodePosition node_position(float z) {
    constexpr float last = MixtureProposal::k_nodes - 1;
    const FourLanes position =
        min(broadcast<FourLanes>(last) * Formulas<FourLanes, PmModel>::mixture_position(broadcast<FourLanes>(z)),
            broadcast<FourLanes>(last * (1 - 1e-7f)));
    return {std::size_t(int(hn::GetLane(position.v))), hn::GetLane((position - FourLanes(hn::Floor(position.v))).v)};
}
HWY_INLINE MixtureView view_of(const MixtureProposal& proposal, const Vec3f& wv) {
    const NodePosition nodes = node_position(wv.z);
    const HalfVectorShape &low = proposal.shape[nodes.below], &high = proposal.shape[nodes.below + 1];
    return {wv,
            tangent(proposal, wv),
            nodes,
            {low.stretch + nodes.fraction * (high.stretch - low.stretch),
             low.power + nodes.fraction * (high.power - low.power)}};
}

HWY_INLINE LobeLanes interpolate(const MixtureProposal::Row& low, const MixtureProposal::Row& high, float part,
                                 int first) {
    const LobeLanes a = LobeLanes::load(&low[std::size_t(first)]), b = LobeLanes::load(&high[std::size_t(first)]);
    return a + broadcast_lobes(part) * (b - a);
}

HWY_INLINE LobeLanes load_row(const LobeTable::Row& row, int k) { return LobeLanes::load(&row[std::size_t(k)]); }

HWY_INLINE float facet_weight(const MixtureProposal& proposal, const NodePosition& nodes, std::size_t i) {
    const float below = proposal.facet_weight[nodes.below][i];
    return below + nodes.fraction * (proposal.facet_weight[nodes.below + 1][i] - below);
}

// A mixture for one view direction, with its lobes in the lanes of consecutive vectors.
struct MixtureAtView {
    using F = Formulas<LobeLanes, PmModel>;
    static constexpr int k_vectors = LobeTable::k_per_kind / int(sizeof(LobeLanes) / sizeof(float));  // vectors a kind
    const LobeTable& table;
    Vec3<LobeLanes> viewer, specular;
    typename F::Stretch map;
    typename F::ProposalLobe half[k_vectors];

    HWY_INLINE MixtureAtView(const LobeTable& lobes, const MixtureView& view)
        : table(lobes),
          viewer(broadcast<LobeLanes>(view.wv)),
          specular(-viewer.x, -viewer.y, viewer.z),
          map(F::stretch_along(broadcast<LobeLanes>(view.tangent), broadcast_lobes(view.shape.stretch))) {
        const LobeLanes power = broadcast_lobes(view.shape.power);
        for (int i = 0; i < k_vectors; ++i)
            half[i] = F::half_vector_lobe(F::stretched(viewer, map), map.inverse,
                                          load_row(table.half_bandwidth, i * int(LobeLanes::size())), power);
    }
    HWY_INLINE F::ProposalLobe direction_lobe(int k) const {
        return {specular, load_row(table.bandwidth, k), load_row(table.width, k), load_row(table.scale, k),
                load_row(table.rest, k)};
    }
};

HWY_INLINE float pdf_at_view(const MixtureProposal& proposal, const MixtureAtView& mixture, const MixtureView& view,
                             const Vec3f& wl) {
    using F = MixtureAtView::F;
    const auto &low = proposal.weight(view.nodes.below), &high = proposal.weight(view.nodes.below + 1);
    const Vec3<LobeLanes> l = broadcast<LobeLanes>(wl), mirrored(l.x, l.y, -l.z);
    const typename F::HalfVector above = F::half_vector(l, mixture.viewer, mixture.map),
                                 below = F::half_vector(mirrored, mixture.viewer, mixture.map);
    LobeLanes sum(0.0);
    for (int i = 0; i < MixtureAtView::k_vectors; ++i) {
        const int k = i * int(LobeLanes::size());
        const LobeLanes constant = load_row(mixture.table.constant, k);
        const LobeLanes factor =
            constant + l.z * (load_row(mixture.table.linear, k) + l.z * load_row(mixture.table.square, k));
        sum = sum + interpolate(low, high, view.nodes.fraction, k) *
                        F::reflected_pdf(mixture.direction_lobe(k), {l, factor}, {mirrored, constant});
        sum = sum + interpolate(low, high, view.nodes.fraction, LobeTable::k_per_kind + k) *
                        F::reflected_pdf(mixture.half[i], above, below);
    }
    float pdf = sum.sum();
    for (std::size_t i = 0; proposal.facets && i < proposal.facets->size(); ++i)
        pdf += facet_weight(proposal, view.nodes, i) *
               Kernel<float>::facets_pdf(wl, view.wv, kernel_facets((*proposal.facets)[i]));
    return pdf;
}

float mixture_pdf(const MixtureProposal& proposal, const LobeTable& table, const Vec3f& wl, const Vec3f& wv) {
    const MixtureView view = view_of(proposal, wv);
    return pdf_at_view(proposal, MixtureAtView(table, view), view, wl);
}

// Assembles the sample in one store, for which later loads of several members need not wait.
HWY_INLINE DirectionSample make_sample(const Vec3f& wl, float pdf) {
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

// The directions that all lobes sample around their centres, computed before one lobe is chosen.
struct LobeSamples {
    alignas(32) float x[LobeTable::k_count], y[LobeTable::k_count], z[LobeTable::k_count], below[LobeTable::k_count];

    HWY_INLINE LobeSamples(const MixtureAtView& mixture, float u1) {
        for (int i = 0; i < MixtureAtView::k_vectors; ++i) {
            const int k = i * int(LobeLanes::size());
            set(k, mixture.direction_lobe(k), u1);
            set(LobeTable::k_per_kind + k, mixture.half[i], u1);
        }
    }
    HWY_INLINE void set(int k, const MixtureAtView::F::ProposalLobe& lobe, float u1) {
        lobe.centre.x.store(x + k), lobe.centre.y.store(y + k), lobe.centre.z.store(z + k);
        MixtureAtView::F::sample_below(lobe.width, lobe.rest, broadcast_lobes(u1)).store(below + k);
    }
};

// The first component whose running sum exceeds the selector. A remainder left by rounding belongs to the last facets,
// or without facets to the cosine.
HWY_INLINE std::size_t choose_component(const MixtureProposal& proposal, const NodePosition& nodes, float selector) {
    const auto &low = proposal.running(nodes.below), &high = proposal.running(nodes.below + 1);
    std::size_t chosen = 0;
    for (int k = 0; k < LobeTable::k_count; k += int(LobeLanes::size()))
        chosen += hn::CountTrue(LobeLanes::Tag(),
                                hn::Ge(broadcast_lobes(selector).v, interpolate(low, high, nodes.fraction, k).v));
    if (chosen < LobeTable::k_count) return chosen;
    if (!proposal.facets) return 0;
    const float lobes =
        proposal.running(nodes.below).back() +
        nodes.fraction * (proposal.running(nodes.below + 1).back() - proposal.running(nodes.below).back());
    return chosen + (selector < lobes + facet_weight(proposal, nodes, 0) ? 0 : 1);
}

HWY_INLINE Vec3f sample_at_view(const MixtureProposal& proposal, const MixtureAtView& mixture, const MixtureView& view,
                                const Vec2f& u, float selector) {
    using F = Formulas<FourLanes, PmModel>;
    const std::size_t k = choose_component(proposal, view.nodes, selector);
    if (k >= LobeTable::k_count)
        return Kernel<float>::sample_facets(view.wv, kernel_facets((*proposal.facets)[k - LobeTable::k_count]), u.x,
                                            u.y);
    const LobeSamples samples(mixture, u.x);
    const FourLanes below = broadcast<FourLanes>(samples.below[k]), u2 = broadcast<FourLanes>(u.y);
    Vec3<FourLanes> wl;
    if (k < 2) {  // `below` is the logarithm of the cosine
        wl = F::off_centre(Vec3<FourLanes>(FourLanes(0.0), FourLanes(0.0), FourLanes(1.0)),
                           min(exp(below), FourLanes(1.0)) - FourLanes(1.0), u2);
    } else {
        const Vec3<FourLanes> centre(broadcast<FourLanes>(samples.x[k]), broadcast<FourLanes>(samples.y[k]),
                                     broadcast<FourLanes>(samples.z[k]));
        const Vec3<FourLanes> w = F::off_centre(centre, max(below, FourLanes(-2.0)), u2);
        const Vec3<FourLanes> light =
            F::light_of(F::grown_along(w, broadcast<FourLanes>(view.tangent.x), broadcast<FourLanes>(view.tangent.y),
                                       broadcast<FourLanes>(hn::GetLane(mixture.map.stretch_minus_1.v))),
                        broadcast<FourLanes>(view.wv));
        wl = F::reflected_up(
            select(broadcast<FourLanes>(LobeTable::k_per_kind - 1) < broadcast<FourLanes>(float(k)), light, w));
    }
    return {hn::GetLane(wl.x.v), hn::GetLane(wl.y.v), hn::GetLane(wl.z.v)};
}

Vec3f sample_mixture(const MixtureProposal& proposal, const LobeTable& table, Vec3f wv, Vec2f u, float selector) {
    const MixtureView view = view_of(proposal, wv);
    return sample_at_view(proposal, MixtureAtView(table, view), view, u, selector);
}

// A direction and its density, which is 0 if there is no direction.
DirectionSample sample_mixture_with_pdf(const MixtureProposal& proposal, const LobeTable& table, Vec3f wv, Vec2f u,
                                        float selector) {
    const MixtureView view = view_of(proposal, wv);
    const MixtureAtView mixture(table, view);
    const Vec3f wl = sample_at_view(proposal, mixture, view, u, selector);
    return make_sample(wl, above_horizon(wl, wv) ? pdf_at_view(proposal, mixture, view, wl) : 0);
}

void compute_densities(SamplingPoints& points, const ProposalShape& shape) {
    using F = Formulas<LobeLanes, PmModel>;
    const auto load = [](const auto& rows, std::size_t i) HWY_ATTR {
        return Vec3<LobeLanes>(LobeLanes::load(&rows[0][i]), LobeLanes::load(&rows[1][i]),
                               LobeLanes::load(&rows[2][i]));
    };
    for (std::size_t i = 0; i < points.size(); i += LobeLanes::size()) {
        const Vec3<LobeLanes> wv = load(points.wv, i);
        const Vec3<LobeLanes> tangent =
            shape.has_axis() ? broadcast<LobeLanes>(Vec3f(shape.cosine, shape.sine, 0)) : wv;
        const auto& [stretch, power] = shape.lobes;
        const auto point = F::proposal_point(
            load(points.wl, i), wv, F::stretch_along(tangent, broadcast_lobes(stretch)), broadcast_lobes(power));
        for (std::size_t k = points.shape ? LobeTable::k_per_kind : 0; k < LobeTable::k_count; ++k)
            F::proposal_lobe_pdf(int(k), point).store(&points.density[k][i]);
        for (std::size_t k = LobeTable::k_count; !points.shape && k < points.density.size(); ++k) {
            const Facets& facets = (*shape.facets)[k - LobeTable::k_count];
            F::facets_pdf(load(points.wl, i), wv,
                          {broadcast_lobes(facets.xx), broadcast_lobes(facets.xy), broadcast_lobes(facets.yy)})
                .store(&points.density[k][i]);
        }
    }
}

// Adds to `slope` the sums of lobes k to k + n - 1 over a block of points.
template <int n>
HWY_INLINE void add_slopes(const SamplingPoints& points, std::size_t k, std::size_t first, std::size_t count,
                           const float* factor, double* slope) {
    LobeLanes sum[n];
    const float* density[n];
    for (int j = 0; j < n; ++j) sum[j] = LobeLanes(0.0), density[j] = &points.density[k + std::size_t(j)][first];
    for (std::size_t i = 0; i < count; i += LobeLanes::size()) {
        const LobeLanes each = LobeLanes::load(factor + i);
        for (int j = 0; j < n; ++j) sum[j] = sum[j] + each * LobeLanes::load(density[j] + i);
    }
    for (int j = 0; j < n; ++j) slope[k + std::size_t(j)] += double(sum[j].sum());
}

double compute_slopes(const SamplingPoints& points, const float* lobe_weight, double* slope) {
    constexpr std::size_t max_points = 256;  // number of points processed together
    constexpr std::size_t vectors = SamplingPoints::k_padding * sizeof(float) / sizeof(LobeLanes);
    const std::size_t lobes = points.density.size();
    HWY_ALIGN float factor[max_points];
    double moment = 0;
    std::fill_n(slope, lobes, 0.0);
    for (std::size_t first = 0; first < points.size(); first += max_points) {
        const std::size_t count = std::min(max_points, points.size() - first);
        LobeLanes sum(0.0);
        for (std::size_t i = 0; i < count; i += SamplingPoints::k_padding) {
            LobeLanes pdf[vectors];
            for (auto& p : pdf) p = LobeLanes(0.0);
            for (std::size_t k = 0; k < lobes; ++k) {
                const float* density = &points.density[k][first + i];
                for (std::size_t j = 0; j < vectors; ++j)
                    pdf[j] =
                        pdf[j] + broadcast_lobes(lobe_weight[k]) * LobeLanes::load(density + j * LobeLanes::size());
            }
            for (std::size_t j = 0; j < vectors; ++j) {
                const std::size_t at = i + j * LobeLanes::size();
                pdf[j] = max(pdf[j], broadcast_lobes(1e-15f));  // its square does not underflow
                const LobeLanes ratio = LobeLanes::load(&points.weight[first + at]) / pdf[j];
                sum = sum + ratio;
                (ratio / pdf[j]).store(factor + at);
            }
        }
        moment += double(sum.sum());
        // Four lobes at once: their sums do not wait for each other.
        std::size_t k = 0;
        for (; k + 4 <= lobes; k += 4) add_slopes<4>(points, k, first, count, factor, slope);
        for (; k < lobes; ++k) add_slopes<1>(points, k, first, count, factor, slope);
    }
    return moment;
}

}  // namespace HWY_NAMESPACE
}  // namespace
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace SRBF_NAMESPACE {
namespace {

HWY_EXPORT(mixture_pdf);
HWY_EXPORT(sample_mixture);
HWY_EXPORT(sample_mixture_with_pdf);
HWY_EXPORT(compute_densities);
HWY_EXPORT(compute_slopes);

using K = Kernel<float>;
static_assert(MixtureProposal::k_lobes == SRBF_PROPOSAL_LOBES);

}  // namespace

const LobeTable& lobe_table() {
    static const LobeTable lobes = [] {
        LobeTable table;
        for (int k = 0; k < LobeTable::k_per_kind; ++k) {
            const auto i = std::size_t(k);
            auto lobe = K::mirror_lobe({0, 0, 1}, K::proposal_bandwidth(k));
            if (k < 2) lobe = {{0, 0, 1}, 0, 1 / float(k + 2), float((k + 2) / (2 * k_pi)), 0};
            table.bandwidth[i] = lobe.bandwidth, table.width[i] = lobe.width;
            table.scale[i] = lobe.scale, table.rest[i] = lobe.rest;
            table.constant[i] = k > 1, table.linear[i] = k == 0, table.square[i] = k == 1;
            table.half_bandwidth[i] = K::proposal_bandwidth(LobeTable::k_per_kind + k);
        }
        return table;
    }();
    return lobes;
}

DirectionSample sample_with_pdf(const MixtureProposal& proposal, Vec3f wv, Vec2f u, float selector) {
    return HWY_DYNAMIC_DISPATCH(sample_mixture_with_pdf)(proposal, lobe_table(), wv, u, selector);
}

Vec3f sample(const MixtureProposal& proposal, Vec3f wv, Vec2f u, float selector) {
    return HWY_DYNAMIC_DISPATCH(sample_mixture)(proposal, lobe_table(), wv, u, selector);
}

void set_densities(SamplingPoints& points, const ProposalShape& shape) {
    // All shapes for these points have the same axis and facets, so only the lobes need a comparison.
    if (points.shape && points.shape->lobes == shape.lobes) return;
    points.density.resize(shape.components());
    for (auto& lobe_density : points.density) lobe_density.resize(points.size());
    HWY_DYNAMIC_DISPATCH(compute_densities)(points, shape);
    points.shape = shape;
}

double set_slopes(const SamplingPoints& points, std::span<const float> lobe_weight, std::span<double> slope) {
    assert(lobe_weight.size() == points.density.size() && slope.size() == lobe_weight.size());
    return HWY_DYNAMIC_DISPATCH(compute_slopes)(points, lobe_weight.data(), slope.data());
}

float pdf(const MixtureProposal& proposal, Vec3f wl, Vec3f wv) {
    if (!above_horizon(wl, wv)) return 0;
    return HWY_DYNAMIC_DISPATCH(mixture_pdf)(proposal, lobe_table(), wl, wv);
}

}  // namespace
#endif
