// The points by which a mixture's weights are found.
#pragma once
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "base/aligned.h"
#include "srbf/sampling.h"

namespace srbf {

/// How half-vector lobes are shaped: stretched along the tangent of this azimuth, or (both 0) along the plane of
/// incidence; and weighted by this power of their visibility to the viewer.
struct ProposalShape {
    float stretch = 1, power = 1;
    float cosine = 0, sine = 0;

    bool is_grain() const { return cosine != 0 || sine != 0; }
};

/// Pairs of directions, weighted to stand for ∫ dωl, and the densities of a mixture's lobes there, side by side.
struct SamplingPoints {
    static constexpr std::size_t k_block = 16;  ///< whole blocks once padded

    std::array<Aligned<float>, 3> wl, wv;
    Aligned<float> weight;  ///< (f cosθl)² times the point's solid angle, relative to the square of the albedo
    std::vector<Aligned<float>> density;  ///< lobes × points

    std::size_t size() const { return weight.size(); }
    void add(const Vec3f& l, const Vec3f& v, float of) {
        wl[0].push_back(l.x), wl[1].push_back(l.y), wl[2].push_back(l.z);
        wv[0].push_back(v.x), wv[1].push_back(v.y), wv[2].push_back(v.z);
        weight.push_back(of);
    }
    Vec3f light(std::size_t i) const { return {wl[0][i], wl[1][i], wl[2][i]}; }
    /// Fills the last block by points of no weight.
    void pad() {
        while (size() % k_block != 0) add(light(size() - 1), {wv[0].back(), wv[1].back(), wv[2].back()}, 0);
    }
};

// Padded points have
/// sets the densities of MixtureProposal's lobes, so shaped;
void set_densities(SamplingPoints& points, const ProposalShape& shape);
/// slope_k = Σ_i weight_i density_ki / pdf_i², pdf_i = Σ_k of_lobe_k density_ki; returns Σ_i weight_i / pdf_i.
double set_slopes(const SamplingPoints& points, std::span<const float> of_lobe, std::span<double> slope);

}  // namespace srbf
