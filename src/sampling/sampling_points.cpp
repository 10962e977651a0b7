#include "sampling/sampling_points.h"

#include "sampling/mixture.h"
#include "srbf/kernel.h"

namespace SRBF_NAMESPACE {
namespace {

using K = Kernel<float>;

constexpr float k_min_weight = 1e-3f;  // smaller ones are removed

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

/// Adds to `wl` a lattice of `count` directions of a lobe, made by `sample(u1, u2)`, without directions below the
/// horizon.
template <typename Sample> void add_lattice(int count, const Sample& sample, std::vector<Vec3f>& wl) {
    for (int i = 0; i < count; ++i) {
        const double golden = (std::sqrt(5.0) - 1) / 2;
        const Vec3f w = sample((float(i) + 0.5f) / float(count), float(std::fmod(i * golden, 1.0)));
        if (w.z > 0) wl.push_back(w);
    }
}

/// Adds to `wl` a lattice of `count` samples of component k of this shape for a view, without lost samples.
void add_draws(int count, int k, const ProposalShape& shape, Vec3f wv, std::vector<Vec3f>& wl) {
    const auto& [stretch, power] = shape.lobes;
    const K::Stretch map = K::stretch_along(shape.has_axis() ? Vec3f(shape.cosine, shape.sine, 0) : wv, stretch);
    const auto sample_component = [&](float u1, float u2) {
        if (k < MixtureProposal::k_lobes) return K::sample_proposal_lobe(k, wv, map, power, u1, u2);
        return K::sample_facets(wv, kernel_facets((*shape.facets)[std::size_t(k - MixtureProposal::k_lobes)]), u1, u2);
    };
    add_lattice(count, sample_component, wl);
}

}  // namespace

SamplingPoints make_points(const Evaluate& brdf, std::span<const Vec3f> views, int count,
                           std::span<const ProposalShape> shapes) {
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
    set_densities(points, shapes[0]);
    return points;
}

double improve(const SamplingPoints& points, int steps, std::vector<float>& weight) {
    std::vector<double> slope(weight.size());
    double moment = 0;
    for (int step = 0; step < steps && points.size(); ++step) {
        moment = set_slopes(points, weight, slope);
        double sum = 0;
        for (std::size_t k = 0; k < weight.size(); ++k) sum += slope[k] = double(weight[k]) * std::sqrt(slope[k]);
        for (std::size_t k = 0; k < weight.size(); ++k) weight[k] = float(slope[k] / sum);
    }
    return moment;
}

std::vector<float> drop_small_weights(std::vector<float> weight) {
    float sum = 0;
    for (std::size_t k = 0; k < weight.size(); ++k) {
        if (!(weight[k] > k_min_weight)) weight[k] = 0;
        if (k == 0) weight[k] = std::max(weight[k], k_min_cosine);
        sum += weight[k];
    }
    for (float& w : weight) w /= sum;
    return weight;
}

std::vector<float> uniform_weights(std::size_t lobes) { return std::vector<float>(lobes, 1 / float(lobes)); }

std::vector<float> best_weights(const SamplingPoints& points, std::size_t lobes, int steps) {
    std::vector<float> weight(lobes);
    if (points.size()) weight = uniform_weights(lobes);
    improve(points, steps, weight);
    return drop_small_weights(std::move(weight));
}

double moment_of(const SamplingPoints& points, std::span<const float> weight) {
    std::vector<double> slope(weight.size());
    return set_slopes(points, weight, slope);
}

}  // namespace
