// Draws and densities of a mixture, its lobes in the lanes of vectors; and densities of the points by which its weights
// are found, these in the lanes.
#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstring>

#include "sampling/sampling_points.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sampling/sampling_mixture.cpp"
#include <hwy/foreach_target.h>

#include "brdf/batch-inl.h"

#ifndef SRBF_SAMPLING_MIXTURE
#define SRBF_SAMPLING_MIXTURE
namespace srbf {

/// The numbers of the lobes, side by side: those of directions to the light, then as many of half vectors.
struct LobeTable {
    static constexpr int k_count = MixtureProposal::k_lobes, k_of_kind = SRBF_FIRST_HALF_VECTOR_LOBE;
    static_assert(k_count == 2 * k_of_kind);
    using Row = std::array<float, k_of_kind>;
    /// Lobes of directions, about the mirror direction. A cosine is a lobe of bandwidth 0 there.
    alignas(32) Row bandwidth, width, scale, rest;
    /// The polynomial in cosθl that multiplies their densities, of which at −cosθl the constant is left.
    alignas(32) Row constant, linear, square;
    /// Lobes of half vectors. `weighted` is 1, or 0 for the lobe that is not weighted by its visibility.
    alignas(32) Row half_bandwidth, weighted;
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
    float sharpness;
};

}  // namespace srbf
#endif

HWY_BEFORE_NAMESPACE();
namespace srbf {
namespace HWY_NAMESPACE {

// A vector of lobes of one kind.
using Lobes = BatchOf<hn::CappedTag<float, LobeTable::k_of_kind>, true>;
// Few of what all lobes have in common.
using Few = BatchOf<hn::CappedTag<float, 4>, true>;

template <typename Lanes> HWY_INLINE Lanes in_all(float x) { return Lanes(double(x)); }
template <typename Lanes> HWY_INLINE Vec3<Lanes> in_all(const Vec3f& w) {
    return {in_all<Lanes>(w.x), in_all<Lanes>(w.y), in_all<Lanes>(w.z)};
}
template <typename Lanes> HWY_INLINE auto in_all(const Kernel<float>::Stretch& map) {
    return typename Formulas<Lanes, PmModel>::Stretch{in_all<Lanes>(map.x), in_all<Lanes>(map.y),
                                                      in_all<Lanes>(map.stretch_minus_1),
                                                      in_all<Lanes>(map.inverse_minus_1), in_all<Lanes>(map.inverse)};
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
            Kernel<float>::visibility_sharpness(wv, between(proposal.power))};
}

HWY_INLINE Lobes between(const MixtureProposal::Row& low, const MixtureProposal::Row& high, float part, int first) {
    const Lobes a = Lobes::load(&low[std::size_t(first)]), b = Lobes::load(&high[std::size_t(first)]);
    return a + everywhere(part) * (b - a);
}

HWY_INLINE Lobes at(const LobeTable::Row& row, int k) { return Lobes::load(&row[std::size_t(k)]); }

// A mixture as a viewer sees it, its lobes in the lanes of one vector after the other.
struct Seen {
    using F = Formulas<Lobes, PmModel>;
    static constexpr int k_vectors = LobeTable::k_of_kind / int(sizeof(Lobes) / sizeof(float));  // of each kind
    const LobeTable& table;
    Vec3<Lobes> viewer, specular;
    typename F::Stretch map;
    typename F::ProposalLobe half[k_vectors];

    HWY_INLINE Seen(const LobeTable& lobes, const ViewOfMixture& view)
        : table(lobes),
          viewer(in_all<Lobes>(view.wv)),
          specular(-viewer.x, -viewer.y, viewer.z),
          map(in_all<Lobes>(view.map)) {
        const Vec3<Lobes> stretched = in_all<Lobes>(Kernel<float>::stretched(view.wv, view.map));
        for (int i = 0; i < k_vectors; ++i) {
            const int k = i * int(Lobes::size());
            const Lobes sharpness = everywhere(view.sharpness) * at(table.weighted, k);
            half[i] = F::half_vector_lobe(stretched, map.inverse, at(table.half_bandwidth, k), sharpness);
        }
    }
    HWY_INLINE F::ProposalLobe of_directions(int k) const {
        return {specular, at(table.bandwidth, k), at(table.width, k), at(table.scale, k), at(table.rest, k)};
    }
};

HWY_INLINE float density(const MixtureProposal& proposal, const Seen& seen, const ViewOfMixture& view,
                         const Vec3f& wl) {
    using F = Seen::F;
    const auto &low = proposal.weight(view.nodes.below), &high = proposal.weight(view.nodes.below + 1);
    const Vec3<Lobes> l = in_all<Lobes>(wl), mirrored(l.x, l.y, -l.z);
    const auto above = F::half_vector(l, seen.viewer, seen.map),
               below = F::half_vector(mirrored, seen.viewer, seen.map);
    Lobes sum(0.0);
    for (int i = 0; i < Seen::k_vectors; ++i) {
        const int k = i * int(Lobes::size());
        const Lobes constant = at(seen.table.constant, k);
        const Lobes factor = constant + l.z * (at(seen.table.linear, k) + l.z * at(seen.table.square, k));
        sum = sum + between(low, high, view.nodes.part, k) *
                        F::reflected_pdf(seen.of_directions(k), {l, factor}, {mirrored, constant});
        sum = sum + between(low, high, view.nodes.part, LobeTable::k_of_kind + k) *
                        F::reflected_pdf(seen.half[i], above, below);
    }
    return sum.sum();
}

float mixture_pdf(const MixtureProposal& proposal, const LobeTable& table, const Vec3f& wl, const Vec3f& wv) {
    const ViewOfMixture view = view_of(proposal, wv);
    return density(proposal, Seen(table, view), view, wl);
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

// The direction that each lobe draws about its centre, computed for all lobes before one is chosen.
struct Drawn {
    alignas(32) float x[LobeTable::k_count], y[LobeTable::k_count], z[LobeTable::k_count], below[LobeTable::k_count];

    HWY_INLINE Drawn(const Seen& seen, float u1) {
        for (int i = 0; i < Seen::k_vectors; ++i) {
            const int k = i * int(Lobes::size());
            set(k, seen.of_directions(k), u1);
            set(LobeTable::k_of_kind + k, seen.half[i], u1);
        }
    }
    HWY_INLINE void set(int k, const Seen::F::ProposalLobe& lobe, float u1) {
        lobe.centre.x.store(x + k), lobe.centre.y.store(y + k), lobe.centre.z.store(z + k);
        Seen::F::sample_below(lobe.width, lobe.rest, everywhere(u1)).store(below + k);
    }
};

// The first lobe whose running sum exceeds the selector. What rounding leaves over is the cosine's.
HWY_INLINE std::size_t chosen_lobe(const MixtureProposal& proposal, const NodesAbout& nodes, float selector) {
    const auto &low = proposal.running(nodes.below), &high = proposal.running(nodes.below + 1);
    std::size_t chosen = 0;
    for (int k = 0; k < LobeTable::k_count; k += int(Lobes::size()))
        chosen += hn::CountTrue(Lobes::Tag(), hn::Ge(everywhere(selector).v, between(low, high, nodes.part, k).v));
    return chosen < LobeTable::k_count ? chosen : 0;
}

HWY_INLINE Vec3f draw(const MixtureProposal& proposal, const Seen& seen, const ViewOfMixture& view, const Vec2f& u,
                      float selector) {
    using F = Formulas<Few, PmModel>;
    const Drawn drawn(seen, u.x);
    const std::size_t k = chosen_lobe(proposal, view.nodes, selector);
    const Few below = in_all<Few>(drawn.below[k]), u2 = in_all<Few>(u.y);
    Vec3<Few> wl;
    if (k < 2) {  // the logarithm of its cosine
        wl = F::off_centre(Vec3<Few>(Few(0.0), Few(0.0), Few(1.0)), min(exp(below), Few(1.0)) - Few(1.0), u2);
    } else {
        const Vec3<Few> centre(in_all<Few>(drawn.x[k]), in_all<Few>(drawn.y[k]), in_all<Few>(drawn.z[k]));
        const Vec3<Few> w = F::off_centre(centre, max(below, Few(-2.0)), u2);
        const Vec3<Few> light = F::light_of(F::stretched(w, in_all<Few>(view.map)), in_all<Few>(view.wv));
        wl = F::reflected_up(select(in_all<Few>(LobeTable::k_of_kind - 1) < in_all<Few>(float(k)), light, w));
    }
    return {hn::GetLane(wl.x.v), hn::GetLane(wl.y.v), hn::GetLane(wl.z.v)};
}

Vec3f draw_mixture(const MixtureProposal& proposal, const LobeTable& table, Vec3f wv, Vec2f u, float selector) {
    const ViewOfMixture view = view_of(proposal, wv);
    return draw(proposal, Seen(table, view), view, u, selector);
}

// A direction and its density, 0 where there is no direction.
DirectionSample sample_mixture(const MixtureProposal& proposal, const LobeTable& table, Vec3f wv, Vec2f u,
                               float selector) {
    const ViewOfMixture view = view_of(proposal, wv);
    const Seen seen(table, view);
    const Vec3f wl = draw(proposal, seen, view, u, selector);
    return with_pdf(wl, above_horizon(wl, wv) ? density(proposal, seen, view, wl) : 0);
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
        for (int k = 0; k < LobeTable::k_of_kind; ++k) {
            const auto i = std::size_t(k);
            auto lobe = K::mirror_lobe({0, 0, 1}, K::proposal_bandwidth(k));
            if (k < 2) lobe = {{0, 0, 1}, 0, 1 / float(k + 2), float((k + 2) / (2 * k_pi)), 0};
            table.bandwidth[i] = lobe.bandwidth, table.width[i] = lobe.width;
            table.scale[i] = lobe.scale, table.rest[i] = lobe.rest;
            table.constant[i] = k > 1, table.linear[i] = k == 0, table.square[i] = k == 1;
            table.half_bandwidth[i] = K::proposal_bandwidth(LobeTable::k_of_kind + k);
            table.weighted[i] = K::proposal_sharpness(LobeTable::k_of_kind + k, 1);
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
