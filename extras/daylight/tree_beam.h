// Beams in tensor trees: private to fits.
#pragma once
#include <optional>

#include "srbf/daylight.h"

namespace srbf {

/// A tree keeps light that is not scattered as a peak of its finest leaves about the mirror direction.
/// None if there is no such peak: a lobe that is wider than the leaves stays.
std::optional<SeparatedBeam> separated_beam(const std::shared_ptr<const TreeTable>& tree);

}  // namespace srbf
