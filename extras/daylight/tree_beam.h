// Beams in tensor trees. Private to fits.
#pragma once
#include "measured/tables.h"
#include "srbf/daylight.h"

namespace SRBF_NAMESPACE {

/// A tree keeps unscattered light as a peak of its finest leaves around the mirror direction. Returns that beam and
/// the tree without it; none if there is no such peak. A lobe wider than the leaves is not a beam.
std::optional<SeparatedBeam> separated_beam(const std::shared_ptr<const TreeTable>& tree);

}  // namespace
