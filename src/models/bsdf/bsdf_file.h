// The parts and beams of a BSDF as tensors of a model file.
#pragma once
#include "base/safetensors.h"
#include "srbf/bsdf.h"

namespace srbf {

/// Adds a part's tensors and metadata under its name.
void add_part(const Safetensors& part, Part of, Safetensors& content);
/// The inverse, which removes them.
Safetensors take_part(Safetensors& content, Part of);

/// The tensors of the beams, rounded to 16-bit floats.
std::map<std::string, Tensor16> encode_beams(const Beams& beams);
/// The beams of the tensors that are left; errors: there are others.
Result<Beams> decode_beams(const std::map<std::string, Tensor16>& tensors, const std::string& file_name);

}  // namespace srbf
