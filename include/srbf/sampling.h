// Sampling of the light that a BRDF reflects to the viewer.
#pragma once
#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <variant>
#include <vector>

#include "srbf/model.h"
#include "srbf/srbf.h"

namespace [[gnu::visibility("default")]] srbf {

// A *proposal* is a density of directions to the light that depends on the viewer. It has the functions
//   sample(proposal, wv, u, selector)   a direction from a point and a selector of a lobe, all uniform in
//                                       [0,1); z ≤ 0 if the sample has none
//   pdf(proposal, wl, wv)               its density [1/sr]; 0 if wl.z ≤ 0, positive where f cosθl is positive
// for unit vectors wl and wv with wv.z > 0, and ∫ pdf dωl + P(no direction) = 1. Where wv is not above the horizon
// (`above_horizon`), the result of `sample` has no meaning, and `pdf` is 0.

/// The cosine, whatever the BRDF: pdf = wl.z / π if both are above the horizon, otherwise 0, and
/// wl = (√u.x cos 2πu.y, √u.x sin 2πu.y, √(1 − u.x)).
struct CosineProposal {};
Vec3f sample(const CosineProposal& proposal, Vec3f wv, Vec2f u, float selector);
float pdf(const CosineProposal& proposal, Vec3f wl, Vec3f wv);

/// A mixture of kernel.glsl's proposal lobes, Σ_k w_k(θv) pdf_k: the cosine and its square, lobes about the mirror
/// direction, lobes of half vectors. The weights, and the stretch and power of the half-vector lobes, are linear in
/// √cosθv between nodes, whose own are those of least variance for the BRDF.
class MixtureProposal {
  public:
    static constexpr int k_nodes = 13, k_lobes = 16;
    static constexpr int k_numbers = k_lobes + 2;  ///< of a node
    using Row = std::array<float, k_lobes>;

    /// The weights at node i, where √cosθv = 1 − i / 12; they sum to 1.
    const Row& weight(std::size_t node) const { return weight_[node]; }
    /// Their running sums.
    const Row& running(std::size_t node) const { return running_[node]; }
    void set_weights(std::size_t node, std::span<const float, k_lobes> weight);

    /// At the nodes: half-vector lobes are so many times as wide along a tangent as across, and weighted by this power
    /// of their visibility to the viewer.
    std::array<float, k_nodes> stretch = ones(), power = ones();
    /// Cosine and sine of the azimuth of the axis of an anisotropic BRDF. If both are 0, lobes are stretched along the
    /// plane of incidence.
    float cosine = 0, sine = 0;

    bool has_axis() const { return cosine != 0 || sine != 0; }

    /// The weights, the stretch and the power of a node.
    std::array<float, k_numbers> numbers(std::size_t node) const {
        std::array<float, k_numbers> all;
        std::copy(weight_[node].begin(), weight_[node].end(), all.begin());
        all[k_lobes] = stretch[node], all[k_lobes + 1] = power[node];
        return all;
    }

  private:
    static constexpr std::array<float, k_nodes> ones() {
        std::array<float, k_nodes> all{};
        all.fill(1);
        return all;
    }
    alignas(64) std::array<Row, k_nodes> weight_{}, running_{};
};
/// The tangent for a viewer, of any length.
inline Vec3f tangent(const MixtureProposal& proposal, const Vec3f& wv) {
    return proposal.has_axis() ? Vec3f(proposal.cosine, proposal.sine, 0) : wv;
}
/// The selector chooses a lobe, and u a direction of it. Domain: that of every proposal, above.
Vec3f sample(const MixtureProposal& proposal, Vec3f wv, Vec2f u, float selector);
/// 0 if wl.z or wv.z is 0, negative or subnormal.
float pdf(const MixtureProposal& proposal, Vec3f wl, Vec3f wv);
/// A direction and its density [1/sr], as `sample` and `pdf` return them one after the other; if there is no direction,
/// wl.z ≤ 0 and pdf is 0.
struct DirectionSample {
    Vec3f wl;
    float pdf;
};
DirectionSample sample_with_pdf(const MixtureProposal& proposal, Vec3f wv, Vec2f u, float selector);

/// A table of cells, for BRDFs with highlights that are not like lobes; one sample in twenty is of the cosine. Each
/// node, at one elevation of the view, has densities in cells of the projected hemisphere, the unit disk of p = (wl.x,
/// wl.y), where dp = cosθl dωl. The cells are sectors and rings about the mirror direction m. Their coordinates are
/// `turn`, the azimuth of p − m, which is that of the half vector, as the part of the way around the square |x| + |y| =
/// 1, 0 to 4 from the direction away from the normal; and ρ², ρ the distance |p − m| relative to that of the horizon in
/// the same direction. An octave of ρ² has two rings, down to 2⁻²⁴. Nodes are uniform in t = (1 + ∜cosθv − √(1 −
/// cosθv)) / 2; between them densities are linear.
struct TableProposal {
    static constexpr int k_nodes = 49, k_sectors = 32, k_rings = 48;
    static constexpr float k_share = 0.95f;  ///< of the samples that are the table's
    std::vector<float> density;              ///< of (turn, ρ²): nodes × sectors × rings
    std::vector<float> of_sector, of_ring;  ///< running sums of shares, to 1: nodes × sectors, and in each of its rings
};
Vec3f sample(const TableProposal& proposal, Vec3f wv, Vec2f u, float selector);
float pdf(const TableProposal& proposal, Vec3f wl, Vec3f wv);

struct ProposeOptions {
    /// Number of azimuths of the view, over which the variance is averaged. With several the half-vector lobes may be
    /// stretched along an axis, and there is no table of cells. No function of this header chooses the number.
    int azimuths = 1;
    int threads = 0;              ///< 0: as many as the machine has; the result does not depend on it
    double most_variance = 0.15;  ///< relative, of f cosθl / pdf: for `refined`
};
/// The number of azimuths for an anisotropic BRDF.
inline constexpr int k_anisotropic_azimuths = 8;
/// The mixture for a BRDF: at each node the weights that minimise ∫ (f cosθl)² / pdf dωl, f in luminance, averaged over
/// the views at the node and a third of the way to its neighbours, by 200 steps of
///   w_k ← w_k √(∂_k / Σ_i w_i ∂_i),  ∂_k = ∫ (f cosθl / pdf)² pdf_k dωl,
/// each of which lowers it (Silvey, Titterington & Torgersen 1978). If more than 3/4 % of the samples would be invalid
/// at one elevation, the weights of the lobes that cause this are reduced, in at most seven steps (three with an axis).
/// The cosine keeps `k_least_cosine`. The stretch in the plane of incidence, 0.8^i, and the power, 0.8^(2 − 2j), i from
/// −6 to 6 and j from 0 to 6, are such that among their neighbours none has a smaller minimum. An axis' stretch is
/// that of `k_stretches`, along one of 12 azimuths, with which the variance at the views of 45° is least. What was not
/// measured counts as 0.
MixtureProposal propose(const Evaluate& brdf, const ProposeOptions& options = {});
inline constexpr float k_least_cosine = 0.02f;
inline constexpr std::array<float, 8> k_stretches{1, 1.4f, 2, 2.8f, 4, 5.6f, 8, 16};

/// The draw of a view-by-view model (Tsai 2009): a sampled view about wv by its interpolation weight, one of its lobes in
/// proportion to the integral ∫ ρ_j cosθl dωl (luminance), a von Mises-Fisher direction of the lobe that it is times the
/// cosine, without its shape, reflected to above the horizon. The share v / (v + V) of the samples of each view, at least a
/// tenth, are drawn by the cosine instead, where V is the relative variance by the cosine alone and v = 0.2. It refers to the model, whose sampled direction is the view.
struct ViewProposal {
    const SuModel* model = nullptr;
    std::vector<float> share;  ///< n × (1 + J): of the cosine, and of the lobes of each view; they sum to 1
};
ViewProposal propose(const SuModel& model);
ViewProposal propose(const SuModel&&) = delete;
Vec3f sample(const ViewProposal& proposal, Vec3f wv, Vec2f u, float selector);
float pdf(const ViewProposal& proposal, Vec3f wl, Vec3f wv);

/// Any of them.
using Proposal = std::variant<CosineProposal, MixtureProposal, ViewProposal, TableProposal>;
Vec3f sample(const Proposal& proposal, Vec3f wv, Vec2f u, float selector);
DirectionSample sample_with_pdf(const Proposal& proposal, Vec3f wv, Vec2f u, float selector);
float pdf(const Proposal& proposal, Vec3f wl, Vec3f wv);

/// The proposal for a model: of a view-by-view model whose sampled direction is the view a `ViewProposal`, which refers
/// to the model; of any other a mixture.
Proposal propose(const Model& model, const ProposeOptions& options = {});
Proposal propose(const Model&&, const ProposeOptions& options = {}) = delete;

/// The mixture if its relative variance is at most `most_variance` at views every 5° from 2.5° on, or no table has less;
/// otherwise a table. No bound holds between these views, or for what neither represents: docs/sampling.md has the largest
/// variances that were found. Its densities are of least variance: in proportion to the root mean square of f over a
/// cell, at the views about a node, times the cell's projected area. It is for a BRDF that depends on the azimuths'
/// difference alone, and is not made where `azimuths` is more than 1.
Proposal refined(const Evaluate& brdf, const MixtureProposal& mixture, const ProposeOptions& options = {});

/// A direction and its density, where a proposal has no better way.
template <typename P> DirectionSample sample_with_pdf(const P& proposal, Vec3f wv, Vec2f u, float selector) {
    const Vec3f wl = sample(proposal, wv, u, selector);
    return {wl, wl.z > 0 ? pdf(proposal, wl, wv) : 0};
}

/// Samples the light for `brdf`, of which values that were not measured count as 0. If wv is not above the horizon, pdf is 0.
template <Brdf B, typename P> LightSample sample(const B& brdf, const P& proposal, Vec3f wv, Vec2f u, float selector) {
    LightSample drawn;
    if (!above_horizon(wv, wv)) return drawn;
    const DirectionSample direction = sample_with_pdf(proposal, wv, u, selector);
    drawn.wl = direction.wl;
    if (!(direction.wl.z > 0 && direction.pdf > 0)) return drawn;
    drawn.pdf = direction.pdf;
    const Rgb f = value(brdf, drawn.wl, wv);
    if (!is_finite(f)) return drawn;
    const float scale = drawn.wl.z / drawn.pdf;
    drawn.weight = {scale * f.r, scale * f.g, scale * f.b};
    return drawn;
}

}  // namespace srbf
