// The lobes of a basis that a material needs.
#pragma once
#include <vector>

#include "models/pm/solve/lobe_problem.h"

namespace srbf {

/// At most so many of a problem's lobes, for which its loss is small, by the loss to second order in the coefficients about
/// those of the last call of `loss`: lobes are dropped, those first without which it rises least, and then exchanged as
/// long as that lowers it.
std::vector<std::size_t> active_lobes(LobeProblem& problem, std::size_t most);

}  // namespace srbf
