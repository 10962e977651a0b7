// The numbers of mixtures.
#pragma once
#include <cstddef>

#include "srbf/kernel.h"
#include "srbf/sampling.h"

SRBF_BEGIN

/// The least weight of the cosine in a mixture.
inline constexpr float k_min_cosine = 0.02f;
/// The stretches among which one is chosen for a mixture with an axis.
inline constexpr std::array<float, 8> k_stretches{1, 1.4f, 2, 2.8f, 4, 5.6f, 8, 16};

/// Facets in the kernel's structure.
inline Kernel<float>::Facets kernel_facets(const Facets& facets) { return {facets.xx, facets.xy, facets.yy}; }

/// The tangent along which lobes are stretched for a viewer, not normalised.
inline Vec3f tangent(const MixtureProposal& proposal, const Vec3f& wv) {
    return proposal.has_axis() ? Vec3f(proposal.cosine, proposal.sine, 0) : wv;
}

/// The parameters of the lobes, as columns: cosines and lobes of light directions, then the same number of lobes of
/// half vectors.
struct LobeTable {
    static constexpr int k_count = MixtureProposal::k_lobes, k_per_kind = SRBF_FIRST_HALF_VECTOR_LOBE;
    static_assert(k_count == 2 * k_per_kind);
    using Row = std::array<float, k_per_kind>;
    /// Lobes of directions around the mirror direction. A cosine has bandwidth 0.
    alignas(32) Row bandwidth, width, scale, rest;
    /// The polynomial in cosθl that multiplies their densities. At −cosθl only the constant is left.
    alignas(32) Row constant, linear, square;
    /// Lobes of half vectors.
    alignas(32) Row half_bandwidth;
};
const LobeTable& lobe_table();

/// The numbers of a node: weights of the lobes and, if there are facets, of these; stretch and power of half-vector
/// lobes; then the matrices of facets.
inline constexpr std::size_t k_shape_numbers = 2, k_node_numbers = MixtureProposal::k_components + k_shape_numbers + 6;
inline std::vector<float> node_numbers(const MixtureProposal& proposal, std::size_t node, bool has_facets) {
    std::vector<float> numbers(proposal.weight(node).begin(), proposal.weight(node).end());
    if (has_facets)
        numbers.insert(numbers.end(), proposal.facet_weight[node].begin(), proposal.facet_weight[node].end());
    numbers.insert(numbers.end(), {proposal.shape[node].stretch, proposal.shape[node].power});
    for (const Facets& facets : proposal.facets.value_or(FacetTerms{}))
        if (has_facets) numbers.insert(numbers.end(), {facets.xx, facets.xy, facets.yy});
    return numbers;
}

SRBF_END
