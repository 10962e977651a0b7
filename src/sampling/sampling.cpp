#include "srbf/sampling.h"

#include "sampling/mixture.h"
#include "srbf/elementary.h"
#include "srbf/kernel.h"

namespace SRBF_NAMESPACE {
namespace {
using K = Kernel<float>;
}

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
    ProposeOptions adapted = options;
    adapted.facets = facets_of(model);
    if (adapted.facets && !is_isotropic(model)) adapted.azimuths = std::max(adapted.azimuths, k_anisotropic_azimuths);
    return propose(evaluator(model), adapted);
}

}  // namespace
