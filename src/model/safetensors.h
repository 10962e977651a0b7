// The safetensors container: an 8-byte little-endian header length, a JSON header, raw little-endian data.
#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "srbf/result.h"

namespace srbf {

/// A tensor of 16-bit halves.
struct HalfTensor {
    std::vector<std::uint64_t> shape;
    std::vector<std::uint16_t> data;  ///< as many as the product of the shape
};

/// What a file holds: tensors by name and the string metadata.
struct Safetensors {
    std::map<std::string, HalfTensor> tensors;
    std::map<std::string, std::string> metadata;
};

/// The container's bytes, tensors in the order of their names; the header is padded so that data begin at a
/// multiple of 8.
std::vector<std::byte> write_safetensors(const Safetensors& content);

/// Every size is checked before anything is allocated: tensors must be F16, their offsets must agree with
/// their shapes and tile the data without overlap, gap or rest.
Result<Safetensors> read_safetensors(std::span<const std::byte> bytes, const std::string& source);

}  // namespace srbf
