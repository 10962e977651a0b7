// The objectives by their names.
#pragma once
#include <optional>
#include <span>

#include "srbf/objective.h"

SRBF_BEGIN

std::span<const Objective> objectives();        ///< all objectives
std::string_view summary(Objective objective);  ///< what it minimises, a line in ASCII
std::optional<Objective> objective_named(std::string_view text);
/// The measure that an objective minimises and by which its fits are judged.
double Measures::*measure_of(Objective objective);

SRBF_END
