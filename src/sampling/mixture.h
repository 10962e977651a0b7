// The numbers of mixtures.
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>

#include "srbf/kernel.h"
#include "srbf/sampling.h"

SRBF_BEGIN

/// The least weight of the cosine in a mixture.
inline constexpr float k_least_cosine = 0.02f;
/// The stretches that a mixture with an axis is chosen from.
inline constexpr std::array<float, 8> k_stretches{1, 1.4f, 2, 2.8f, 4, 5.6f, 8, 16};

/// Facets as the kernel has them.
inline Kernel<float>::Facets kernel_facets(const Facets& facets) { return {facets.xx, facets.xy, facets.yy}; }

/// The tangent along which lobes are stretched for a viewer, not normalised.
inline Vec3f tangent(const MixtureProposal& proposal, const Vec3f& wv) {
    return proposal.has_axis() ? Vec3f(proposal.cosine, proposal.sine, 0) : wv;
}

/// The numbers of a node: the weights of the lobes, stretch and power of the even and of the odd ones; then of facets
/// the weights and matrices.
inline constexpr std::size_t k_lobe_numbers = MixtureProposal::k_lobes + 4, k_node_numbers = k_lobe_numbers + 8;
inline std::array<float, k_node_numbers> numbers_of(const MixtureProposal& proposal, std::size_t node) {
    std::array<float, k_node_numbers> numbers;
    float* next = std::ranges::copy(proposal.weight(node), numbers.data()).out;
    for (const HalfVectorShape& shape : proposal.shape[node]) *next++ = shape.stretch, *next++ = shape.power;
    next = std::ranges::copy(proposal.facet_weight[node], next).out;
    for (const Facets& facets : proposal.facets.value_or(FacetTerms{}))
        *next++ = facets.xx, *next++ = facets.xy, *next++ = facets.yy;
    return numbers;
}

SRBF_END
