// The lobes of a basis that a material needs.
#pragma once
#include <vector>

#include "models/pm/solve/lobe_problem.h"

namespace SRBF_NAMESPACE {

/// Chooses at most `most` of a problem's lobes such that its loss is small. The loss is taken to second order in
/// the coefficients around those of the last call of `loss`. The lobes that raise it least are dropped first; then
/// lobes are exchanged as long as that lowers it.
std::vector<std::size_t> active_lobes(LobeProblem& problem, std::size_t most);

}  // namespace srbf
