#include "srbf/sampling.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <initializer_list>
#include <span>

#include "base/parallel.h"
#include "sampling/mixture.h"
#include "sampling/sampling_points.h"
#include "srbf/elementary.h"
#include "srbf/kernel.h"

namespace srbf {
namespace {

using K = Kernel<float>;

constexpr int k_steps = 200;
constexpr int k_points = 64;            // for each lobe and view
constexpr double k_lowest_view = 1e-4;  // cosθv of the last node: nothing is reflected at 0
constexpr float k_least_weight = 1e-3f;
// The relative gains of the second moment that justify an anisotropy axis, and a step of a lobe's shape.
constexpr double k_least_gain = 0.01, k_least_change = 0.002;

/// Adds to `points` directions sampled for a view. `density` is the number of samples per solid angle at each
/// [1/sr].
void add_points(const Evaluate& brdf, Vec3f wv, std::span<const Vec3f> wl, std::span<const double> density,
                SamplingPoints& points) {
    std::vector<Rgb> f(wl.size());
    brdf(wl, std::vector<Vec3f>(wl.size(), wv), f);
    double albedo = 0;
    std::vector<double> squared(wl.size());
    for (std::size_t i = 0; i < wl.size(); ++i) {
        const double reflected = is_finite(f[i]) ? luminance(f[i]) * double(wl[i].z) : 0;
        const double solid_angle = density[i] > 0 ? 1 / density[i] : 0;
        albedo += reflected * solid_angle;
        squared[i] = reflected * reflected * solid_angle;
    }
    for (std::size_t i = 0; i < wl.size(); ++i)
        if (squared[i] > 0) points.add(wl[i], wv, float(squared[i] / (albedo * albedo)));
}

/// Adds to `wl` a lattice of `count` directions of a lobe, made by `sample(u1, u2)`, without those below the
/// horizon.
template <typename Sample> void add_lattice(int count, const Sample& sample, std::vector<Vec3f>& wl) {
    for (int i = 0; i < count; ++i) {
        const double golden = (std::sqrt(5.0) - 1) / 2;
        const Vec3f w = sample((float(i) + 0.5f) / float(count), float(std::fmod(i * golden, 1.0)));
        if (w.z > 0) wl.push_back(w);
    }
}

/// The weights of least variance over the points. Lobe 0 (the cosine) keeps `k_least_cosine`; without points it is
/// alone.
std::vector<float> best_weights(const SamplingPoints& points, std::size_t lobes, int steps) {
    std::vector<float> weight(lobes, points.size() ? 1 / float(lobes) : 0);
    std::vector<double> slope(lobes);
    for (int step = 0; step < steps && points.size(); ++step) {
        set_slopes(points, weight, slope);
        double sum = 0;
        for (std::size_t k = 0; k < lobes; ++k) sum += slope[k] = double(weight[k]) * std::sqrt(slope[k]);
        for (std::size_t k = 0; k < lobes; ++k) weight[k] = float(slope[k] / sum);
    }
    float sum = 0;
    for (std::size_t k = 0; k < lobes; ++k) {
        if (!(weight[k] > k_least_weight)) weight[k] = 0;
        if (k == 0) weight[k] = std::max(weight[k], k_least_cosine);
        sum += weight[k];
    }
    for (float& w : weight) w /= sum;
    return weight;
}

K::Stretch map_of(const ProposalShape& shape, Vec3f wv) {
    return K::stretch_along(shape.has_axis() ? Vec3f(shape.cosine, shape.sine, 0) : wv, shape.stretch);
}

/// Adds to `wl` a lattice of `count` samples of component k of this shape for a view, without those that are lost.
void add_draws(int count, int k, const ProposalShape& shape, Vec3f wv, std::vector<Vec3f>& wl) {
    const K::Stretch map = map_of(shape, wv);
    const auto sample_component = [&](float u1, float u2) {
        if (k < MixtureProposal::k_lobes) return K::sample_proposal_lobe(k, wv, map, shape.power, u1, u2);
        return K::sample_facets(wv, kernel_facets((*shape.facets)[std::size_t(k - MixtureProposal::k_lobes)]), u1, u2);
    };
    add_lattice(count, sample_component, wl);
}

/// Points for these views, `count` for each of them and for each component of these shapes. Their densities are those
/// of the first shape.
SamplingPoints make_points(const Evaluate& brdf, std::span<const Vec3f> views, int count,
                           std::initializer_list<ProposalShape> shapes) {
    SamplingPoints points;
    for (const Vec3f wv : views) {
        std::vector<Vec3f> wl;
        for (const ProposalShape& shape : shapes)
            for (int k = 0; k < int(shape.components()); ++k) add_draws(count, k, shape, wv, wl);
        SamplingPoints samples;
        for (const Vec3f& w : wl) samples.add(w, wv, 1);
        samples.pad();
        std::vector<double> density(wl.size());
        for (const ProposalShape& shape : shapes) {
            set_densities(samples, shape);
            for (const auto& lobe_density : samples.density)
                for (std::size_t i = 0; i < wl.size(); ++i) density[i] += count * double(lobe_density[i]);
        }
        add_points(brdf, wv, wl, density, points);
    }
    points.pad();
    set_densities(points, *shapes.begin());
    return points;
}

/// Views at cosθv = z.
std::vector<Vec3f> views_at(double z, int azimuths) {
    std::vector<Vec3f> views;
    for (int i = 0; i < azimuths; ++i)
        views.push_back(to_float(spherical(elementary::acos(z), 2 * k_pi * i / azimuths)));
    return views;
}

/// The views at a node and a third of the way to its neighbours, because a table's highlights differ between
/// measured views.
std::vector<Vec3f> views_about(std::size_t node, int azimuths) {
    std::vector<Vec3f> views;
    for (const double offset : {-1. / 3, 0., 1. / 3}) {
        const double x = (double(node) + offset) / (MixtureProposal::k_nodes - 1);
        if (x < 0 || x > 1) continue;
        const std::vector<Vec3f> shifted = views_at(std::max((1 - x) * (1 - x), k_lowest_view), azimuths);
        views.insert(views.end(), shifted.begin(), shifted.end());
    }
    return views;
}

/// The second moment of f cosθl / pdf for the best weights, relative to the square of its mean.
double least_moment(const SamplingPoints& points) {
    constexpr int steps = 30;
    std::vector<double> slope(points.density.size());
    return set_slopes(points, best_weights(points, slope.size(), steps), slope);
}

/// The candidate shapes: stretches 0.8^i and powers 0.8^(2 - 2 j), for i from -k_most_stretch_step to
/// k_most_stretch_step and j from 0 to k_most_power_step. Towards the horizon, highlights are up to 18 times as long
/// in the plane of incidence as they are wide.
constexpr int k_most_stretch_step = 13, k_most_power_step = 10;

/// The shape with the least moment at these views among its neighbours, found by descent. With an anisotropy axis
/// the stretch is kept.
ProposalShape best_shape(const Evaluate& brdf, std::span<const Vec3f> views, const ProposalShape& start) {
    constexpr int count = 12;
    const auto shape_at = [&](int i, int j) {
        ProposalShape shape = start;
        if (!start.has_axis()) shape.stretch = float(elementary::pow(0.8, i));
        shape.power = float(elementary::pow(0.8, 2 - 2 * j));
        return shape;
    };
    // All shapes use the same points, sampled from a wide shape and a narrow one.
    SamplingPoints points = make_points(brdf, views, count, {shape_at(0, 1), shape_at(4, 3)});
    std::array<std::array<double, k_most_power_step + 1>, 2 * k_most_stretch_step + 1> known{};
    const auto moment = [&](int i, int j) {
        double& value = known[std::size_t(i + k_most_stretch_step)][std::size_t(j)];
        if (value > 0) return value;
        set_densities(points, shape_at(i, j));
        return value = least_moment(points);
    };
    const int max_i = start.has_axis() ? 0 : k_most_stretch_step;
    int best_i = std::min(1, max_i), best_j = 2;
    for (bool better = true; better;) {
        better = false;
        const int centre_i = best_i, centre_j = best_j;
        for (int i = std::max(centre_i - 1, -max_i); i <= std::min(centre_i + 1, max_i); ++i)
            for (int j = std::max(centre_j - 1, 0); j <= std::min(centre_j + 1, k_most_power_step); ++j)
                if (moment(i, j) < (1 - k_least_change) * moment(best_i, best_j)) best_i = i, best_j = j, better = true;
    }
    return shape_at(best_i, best_j);
}

/// Computes the weights, stretch and power of one node.
void make_node(const Evaluate& brdf, std::size_t node, int azimuths, MixtureProposal& proposal) {
    const std::vector<Vec3f> views = views_about(node, azimuths);
    ProposalShape shape{proposal.stretch[node], proposal.power[node], proposal.cosine, proposal.sine, proposal.facets};
    // At the normal the plane of incidence is undefined.
    if (node > 0) shape = best_shape(brdf, views, shape);
    const SamplingPoints points = make_points(brdf, views, k_points, {shape});
    const std::vector<float> weight = best_weights(points, shape.components(), k_steps);
    proposal.set_weights(node, std::span(weight).first<MixtureProposal::k_lobes>());
    std::copy(weight.begin() + MixtureProposal::k_lobes, weight.end(), proposal.facet_weight[node].begin());
    proposal.stretch[node] = shape.stretch, proposal.power[node] = shape.power;
}

/// Sets the anisotropy axis and the stretch along it.
void find_axis(const Evaluate& brdf, int threads, MixtureProposal& proposal) {
    constexpr std::size_t azimuths = 12;
    constexpr int count = 32;
    const std::vector<Vec3f> views = views_at(std::sqrt(0.5), 8);
    std::array<ProposalShape, azimuths * k_stretches.size()> candidates;
    std::array<double, candidates.size()> moment;
    parallel_for(candidates.size(), threads, [&](std::size_t i) {
        const double azimuth = k_pi * double(i % azimuths) / azimuths;
        candidates[i] = {k_stretches[i / azimuths], 1, float(elementary::cos(azimuth)),
                         float(elementary::sin(azimuth))};
        moment[i] = least_moment(make_points(brdf, views, count, {candidates[i]}));
    });
    const auto best = std::size_t(std::min_element(moment.begin(), moment.end()) - moment.begin());
    if (!(moment[best] < (1 - k_least_gain) * moment[0])) return;
    proposal.stretch.fill(candidates[best].stretch);
    proposal.cosine = candidates[best].cosine, proposal.sine = candidates[best].sine;
}

}  // namespace

Vec3f sample(const CosineProposal&, Vec3f, Vec2f u, float) { return K::sample_cosine(u.x, u.y); }
float pdf(const CosineProposal&, Vec3f wl, Vec3f wv) { return above_horizon(wl, wv) ? K::cosine_pdf(wl) : 0; }

FacetTerms facets_of(const GgxModel& model) {
    FacetTerms terms;
    for (std::size_t i = 0; i < model.lobes.size(); ++i)
        terms[i] = {model.lobes[i].roughness, 0, model.lobes[i].roughness};
    return terms;
}
FacetTerms facets_of(const OpenPbrModel& model) {
    const float coat = K::alpha_of(model.coat_roughness),
                base = K::alpha_of(K::roughened(model.specular_roughness, model.coat_roughness, model.coat_weight));
    const K::OpenPbrRoughness roughness = K::openpbr_roughness(base, model.specular_roughness_anisotropy);
    const double azimuth = 2 * k_pi * double(model.specular_rotation);
    const K::Facets facets = K::facets_along(float(elementary::cos(azimuth)), float(elementary::sin(azimuth)),
                                             roughness.along, roughness.across);
    FacetTerms terms;
    terms[0] = {facets.xx, facets.xy, facets.yy};
    if (model.coat_weight > 0) terms[1] = {coat, 0, coat};
    return terms;
}
std::optional<FacetTerms> facets_of(const Model& model) { return facets_of(model.model); }

void MixtureProposal::set_weights(std::size_t node, std::span<const float, k_lobes> weight) {
    weight_[node] = {};
    float sum = 0;
    for (std::size_t k = 0; k < k_lobes; ++k) {
        weight_[node][k] = weight[k];
        running_[node][k] = sum += weight[k];
    }
}

MixtureProposal propose(const Evaluate& brdf, const ProposeOptions& options) {
    const StandardArithmetic mode;
    assert(brdf && options.azimuths >= 1);
    MixtureProposal proposal;
    proposal.facets = options.facets;
    if (options.azimuths > 1) find_axis(brdf, options.threads, proposal);
    parallel_for(MixtureProposal::k_nodes, options.threads,
                 [&](std::size_t node) { make_node(brdf, node, options.azimuths, proposal); });
    return proposal;
}

Vec3f sample(const Proposal& proposal, Vec3f wv, Vec2f u, float selector) {
    return std::visit([&](const auto& p) { return sample(p, wv, u, selector); }, proposal);
}
DirectionSample sample_with_pdf(const Proposal& proposal, Vec3f wv, Vec2f u, float selector) {
    if (const auto* mixture = std::get_if<MixtureProposal>(&proposal))
        return sample_with_pdf(*mixture, wv, u, selector);
    return std::visit([&](const auto& p) { return sample_with_pdf(p, wv, u, selector); }, proposal);
}
float pdf(const Proposal& proposal, Vec3f wl, Vec3f wv) {
    return std::visit([&](const auto& p) { return pdf(p, wl, wv); }, proposal);
}

Proposal propose(const Model& model, const ProposeOptions& options) {
    const auto* su = std::get_if<SuModel>(&model.model);
    if (su && su->discretise == Discretise::view) return propose(*su);
    ProposeOptions own = options;
    own.facets = facets_of(model);
    if (own.facets && !is_isotropic(model)) own.azimuths = std::max(own.azimuths, k_anisotropic_azimuths);
    return propose(evaluator(model), own);
}

}  // namespace srbf
