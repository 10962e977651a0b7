// The points that determine a mixture's weights.
#pragma once
#include "base/aligned.h"
#include "srbf/sampling.h"

namespace SRBF_NAMESPACE {

/// The shape of half-vector lobes. They are stretched along the tangent with this azimuth, or along the plane of
/// incidence if `cosine` and `sine` are both 0.
struct ProposalShape {
    HalfVectorShape lobes;
    float cosine = 0, sine = 0;
    std::optional<FacetTerms> facets = {};  ///< sampled beside the lobes

    bool has_axis() const { return cosine != 0 || sine != 0; }
    std::size_t components() const {
        return std::size_t(facets ? MixtureProposal::k_components : MixtureProposal::k_lobes);
    }
};

/// Pairs of directions with weights for the integral over dωl, and the densities of a mixture's components at them, as
/// columns.
struct SamplingPoints {
    static constexpr std::size_t k_padding = 32;  ///< the number of points is a multiple of this after padding

    std::array<Aligned<float>, 3> wl, wv;
    Aligned<float> weight;  ///< (f cosθl)² times the point's solid angle, relative to the squared albedo
    std::vector<Aligned<float>> density;  ///< components × points
    std::optional<ProposalShape> shape;   ///< shape of the lobes whose densities were computed; none: not yet

    std::size_t size() const { return weight.size(); }
    void add(const Vec3f& l, const Vec3f& v, float point_weight) {
        wl[0].push_back(l.x), wl[1].push_back(l.y), wl[2].push_back(l.z);
        wv[0].push_back(v.x), wv[1].push_back(v.y), wv[2].push_back(v.z);
        weight.push_back(point_weight);
        shape.reset();
    }
    Vec3f light(std::size_t i) const { return {wl[0][i], wl[1][i], wl[2][i]}; }
    /// Adds points of weight 0 up to a multiple of `k_padding`.
    void pad() {
        while (size() % k_padding != 0) add(light(size() - 1), {wv[0].back(), wv[1].back(), wv[2].back()}, 0);
    }
};

/// Computes the densities of MixtureProposal's components with this shape; densities that are known are kept. The
/// points must be padded.
void set_densities(SamplingPoints& points, const ProposalShape& shape);
/// slope_k = Σ_i weight_i density_ki / pdf_i², where pdf_i = Σ_k lobe_weight_k density_ki. Returns Σ_i weight_i /
/// pdf_i. The points must be padded.
double set_slopes(const SamplingPoints& points, std::span<const float> lobe_weight, std::span<double> slope);

/// Points for these views, `count` for each of them and for each component of these shapes. Their densities are those
/// of the first shape.
SamplingPoints make_points(const Evaluate& brdf, std::span<const Vec3f> views, int count,
                           std::span<const ProposalShape> shapes);

std::vector<float> uniform_weights(std::size_t lobes);
/// Moves weights towards those of least variance over the points. Returns the moment before the last step.
double improve(const SamplingPoints& points, int steps, std::vector<float>& weight);
/// Removes small weights; lobe 0 (the cosine) keeps `k_min_cosine`.
std::vector<float> drop_small_weights(std::vector<float> weight);
/// The weights of least variance over the points; without points the cosine is alone.
std::vector<float> best_weights(const SamplingPoints& points, std::size_t lobes, int steps);
/// The second moment of f cosθl / pdf for these weights, relative to the square of its mean.
double moment_of(const SamplingPoints& points, std::span<const float> weight);

}  // namespace
