// The memory limit of --max-memory.
#pragma once
#include "srbf/result.h"

namespace srbf {

/// Limits the private memory of the program to this many megabytes, without mapped files and memory that the system
/// shares. Beyond the limit there is an error "out of memory". A limit can be lowered later but not raised.
void limit_memory(int megabytes);

/// The machine's free memory [bytes]; 0 if unknown.
std::uint64_t free_memory();

/// An error if memory is limited, since OpenGL's drivers then end the program by a signal.
Result<Done> check_drawing();

}  // namespace srbf
