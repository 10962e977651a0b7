// Sampling of the light that a BRDF reflects to the viewer.
#pragma once
#include <array>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "srbf/model.h"
#include "srbf/srbf.h"

SRBF_BEGIN

// A *proposal* is a density of light directions that depends on the viewer. It has the functions
//   sample(proposal, wv, u, selector)   a direction, from a point and a selector of a lobe, all uniform in
//                                       [0,1); z ≤ 0 if the sample has no direction
//   pdf(proposal, wl, wv)               its density [1/sr]; 0 if wl.z ≤ 0, positive where f cosθl is positive
// for unit vectors wl and wv with wv.z > 0. They satisfy ∫ pdf dωl + P(no direction) = 1. If wv is not above the
// horizon (`above_horizon`), the result of `sample` is meaningless and `pdf` is 0.

/// The cosine, whatever the BRDF. pdf = wl.z / π if both directions are above the horizon, otherwise 0; wl = (√u.x
/// cos 2πu.y, √u.x sin 2πu.y, √(1 − u.x)).
struct CosineProposal {};
Vec3f sample(const CosineProposal& proposal, Vec3f wv, Vec2f u, float selector);
float pdf(const CosineProposal& proposal, Vec3f wl, Vec3f wv);

/// Facets with GGX's distribution of normals, by the symmetric matrix ((xx, xy), (xy, yy)), whose eigenvalues are their
/// roughness along a tangent and across it.
struct Facets {
    float xx = 1, xy = 0, yy = 1;
};
/// The facets of a model of at most two terms; a missing term has the roughness 1.
using FacetTerms = std::array<Facets, 2>;
FacetTerms facets_of(const GgxModel& model);
FacetTerms facets_of(const OpenPbrModel& model);
/// Models without facets have none.
template <typename Other> std::optional<FacetTerms> facets_of(const Other&) { return {}; }
std::optional<FacetTerms> facets_of(const Model& model);
template <typename... Kinds> std::optional<FacetTerms> facets_of(const std::variant<Kinds...>& any) {
    return std::visit([](const auto& kind) -> std::optional<FacetTerms> { return facets_of(kind); }, any);
}

/// The shape of half-vector lobes: they are `stretch` times as wide along a tangent as across it, and weighted by this
/// power of their visibility to the viewer.
struct HalfVectorShape {
    float stretch = 1, power = 1;
    bool operator==(const HalfVectorShape&) const = default;
};

/// A mixture of kernel.glsl's proposal lobes, Σ_k w_k(θv) pdf_k: the cosine and its square, lobes around the mirror
/// direction, lobes of half vectors, and for BRDFs of facets their visible normals (Heitz 2018). The weights, and the
/// stretches and powers of the half-vector lobes, are linear in ∜cosθv between nodes, down to cosθv = 10⁻⁴.
class MixtureProposal {
  public:
    static constexpr int k_nodes = 15, k_lobes = 16;
    static constexpr int k_components = k_lobes + int(std::tuple_size_v<FacetTerms>);
    using Row = std::array<float, k_lobes>;

    /// The weights of the lobes at node i, where ∜cosθv = 1 − 0.9 i / 14; together with `facet_weight` they sum to 1.
    const Row& weight(std::size_t node) const { return weight_[node]; }
    /// The running sums of the weights.
    const Row& running(std::size_t node) const { return running_[node]; }
    void set_weights(std::size_t node, std::span<const float, k_lobes> weight);

    /// The facets whose visible normals are sampled, and for each node their weights.
    std::optional<FacetTerms> facets;
    std::array<std::array<float, 2>, k_nodes> facet_weight{};

    /// For each node the shape of half-vector lobes.
    std::array<HalfVectorShape, k_nodes> shape{};
    /// Cosine and sine of the azimuth of an anisotropic BRDF's axis. If both are 0, lobes are stretched along the
    /// plane of incidence.
    float cosine = 0, sine = 0;

    bool has_axis() const { return cosine != 0 || sine != 0; }

  private:
    alignas(64) std::array<Row, k_nodes> weight_{}, running_{};
};
/// The selector chooses a lobe, and u a direction of it. The domain is the same for every proposal, above.
Vec3f sample(const MixtureProposal& proposal, Vec3f wv, Vec2f u, float selector);
/// The density; 0 if wl.z or wv.z is 0, negative or subnormal.
float pdf(const MixtureProposal& proposal, Vec3f wl, Vec3f wv);
/// A direction and its density [1/sr], as `sample` and `pdf` return them. If there is no direction, wl.z ≤ 0 and
/// pdf is 0.
struct DirectionSample {
    Vec3f wl;
    float pdf;
};
DirectionSample sample_with_pdf(const MixtureProposal& proposal, Vec3f wv, Vec2f u, float selector);

struct ProposeOptions {
    /// Number of azimuths of the view over which the variance is averaged. With more than one, half-vector lobes
    /// may be stretched along an axis. Of the functions of this header only `propose(model)` chooses it, for facets
    /// that are rougher along a tangent.
    int azimuths = 1;
    int threads = 0;  ///< number of threads; 0: all of the machine. The result does not depend on it
    std::optional<FacetTerms> facets = {};  ///< the facets of a BRDF that has some, `facets_of`
};
/// The recommended number of azimuths for an anisotropic BRDF.
inline constexpr int k_anisotropic_azimuths = 8;
/// The recommended `ProposeOptions::azimuths`.
constexpr int azimuths_for(bool is_isotropic) { return is_isotropic ? 1 : k_anisotropic_azimuths; }
/// The mixture for a BRDF. At each node the weights minimise ∫ (f cosθl)² / pdf dωl, f in luminance, averaged over
/// the views at the node and a third of the way to its neighbours. They result from 200 steps of
///   w_k ← w_k √(∂_k / Σ_i w_i ∂_i),  ∂_k = ∫ (f cosθl / pdf)² pdf_k dωl,
/// each of which lowers the integral (Silvey, Titterington & Torgersen 1978). The cosine keeps a weight of 0.02.
///
/// In the plane of incidence, stretches 0.8^i and powers 0.8^(2 − 2j) are tried, i from −4 to 20 and j from 0 to 15.
/// Each node has the best shape that descents find from fixed steps and from the next node's shape. With an axis, the
/// stretch is one of eight up to 16 along one of 12 azimuths, with the least variance at views of 45°. Values that were
/// not measured count as 0.
MixtureProposal propose(const Evaluate& brdf, const ProposeOptions& options = {});

/// The proposal of a view-by-view model (Tsai 2009). It chooses a sampled view near wv by its interpolation weight,
/// then one of its lobes in proportion to the integral ∫ ρ_j cosθl dωl (luminance). The direction has the von
/// Mises-Fisher density of the lobe times the cosine, without the lobe's shape; directions below the horizon are
/// reflected to above it.
///
/// A fraction v / (v + V) of the samples of each view, at least a tenth, is drawn by the cosine instead. V is the
/// relative variance of sampling by the cosine alone, and v = 0.2. The proposal refers to the model, whose sampled
/// direction is the view.
struct ViewProposal {
    const SuModel* model = nullptr;
    /// n × (1 + J) probabilities of the cosine and of the lobes of each view, which sum to 1
    std::vector<float> fraction;
};
ViewProposal propose(const SuModel& model);
ViewProposal propose(const SuModel&&) = delete;
Vec3f sample(const ViewProposal& proposal, Vec3f wv, Vec2f u, float selector);
float pdf(const ViewProposal& proposal, Vec3f wl, Vec3f wv);

/// A proposal of any kind.
using Proposal = std::variant<CosineProposal, MixtureProposal, ViewProposal>;
Vec3f sample(const Proposal& proposal, Vec3f wv, Vec2f u, float selector);
DirectionSample sample_with_pdf(const Proposal& proposal, Vec3f wv, Vec2f u, float selector);
float pdf(const Proposal& proposal, Vec3f wl, Vec3f wv);

/// The proposal for a model. View-by-view models whose sampled direction is the view get a `ViewProposal`, which
/// refers to the model; all others get a mixture.
Proposal propose(const Model& model, const ProposeOptions& options = {});
Proposal propose(const Model&&, const ProposeOptions& options = {}) = delete;

/// A direction and its density, for proposals that have no faster way.
template <typename P> DirectionSample sample_with_pdf(const P& proposal, Vec3f wv, Vec2f u, float selector) {
    const Vec3f wl = sample(proposal, wv, u, selector);
    return {wl, wl.z > 0 ? pdf(proposal, wl, wv) : 0};
}

/// Samples the light for `brdf`. Values that were not measured count as 0. If wv is not above the horizon, pdf is 0.
template <Brdf B, typename P> LightSample sample(const B& brdf, const P& proposal, Vec3f wv, Vec2f u, float selector) {
    LightSample result;
    if (!above_horizon(wv, wv)) return result;
    const DirectionSample direction = sample_with_pdf(proposal, wv, u, selector);
    result.wl = direction.wl;
    if (!(direction.wl.z > 0 && direction.pdf > 0)) return result;
    result.pdf = direction.pdf;
    const Rgb f = value(brdf, result.wl, wv);
    if (!is_finite(f)) return result;
    const float scale = result.wl.z / result.pdf;
    result.weight = {scale * f.r, scale * f.g, scale * f.b};
    return result;
}

SRBF_END
