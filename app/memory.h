// The bound of --max-memory on what the program may take.
#pragma once
#include "srbf/result.h"

namespace srbf {

/// From now on the program takes at most so many megabytes of memory of its own, not counting files that it maps and
/// what the system shares; what would exceed it ends in an error "out of memory". Bounds cannot be raised again.
void limit_memory(int megabytes);

/// An error where memory is bounded: OpenGL's drivers then end the program by a signal.
Result<Done> check_drawing();

}  // namespace srbf
