// The numbers of mixtures.
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>

#include "srbf/sampling.h"

namespace [[gnu::visibility("default")]] srbf {

/// The least weight of the cosine in a mixture.
inline constexpr float k_least_cosine = 0.02f;
/// The stretches that a mixture with an axis is chosen from.
inline constexpr std::array<float, 8> k_stretches{1, 1.4f, 2, 2.8f, 4, 5.6f, 8, 16};

/// The tangent along which lobes are stretched for a viewer, not normalised.
inline Vec3f tangent(const MixtureProposal& proposal, const Vec3f& wv) {
    return proposal.has_axis() ? Vec3f(proposal.cosine, proposal.sine, 0) : wv;
}

/// The weights, the stretch and the power of a node.
inline std::array<float, MixtureProposal::k_numbers> numbers_of(const MixtureProposal& proposal, std::size_t node) {
    constexpr int k_lobes = MixtureProposal::k_lobes;
    std::array<float, MixtureProposal::k_numbers> numbers;
    std::ranges::copy(proposal.weight(node), numbers.begin());
    numbers[k_lobes] = proposal.stretch[node], numbers[k_lobes + 1] = proposal.power[node];
    return numbers;
}

}  // namespace srbf
