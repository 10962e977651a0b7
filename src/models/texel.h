// One model of a stack.
#pragma once
#include "srbf/model.h"

namespace SRBF_NAMESPACE {

/// Model 0..T−1 of a stack's file, with its state and its error in the provenance. Errors: those of read_stack; there
/// is no such texel.
Result<Model> read_texel(std::span<const std::byte> bytes, std::uint64_t texel, const std::string& file_name);

}  // namespace srbf
