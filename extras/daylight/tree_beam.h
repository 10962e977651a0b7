// Beams in tensor trees: private to fits.
#pragma once
#include <optional>

#include "srbf/measured.h"

namespace srbf {

/// A tree keeps light that is not scattered as a peak of its finest leaves about the mirror direction.
struct SeparatedTree {
    Evaluate rest;  ///< f with the peak cut off at the level about it
    Beam beam;      ///< the share that is cut off
};
/// None if there is no such peak: a lobe that is wider than the leaves stays. Keeps a reference to `tree`.
std::optional<SeparatedTree> separated_beam(const TreeTable& tree);

}  // namespace srbf
