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

/// What the numbers of a tensor are.
enum class Type16 { half, count };  // "F16", "U16"

/// A tensor of numbers of 16 bits.
struct Tensor16 {
    Type16 type = Type16::half;
    std::vector<std::uint64_t> shape;
    std::vector<std::uint16_t> data;  ///< as many as the product of the shape
};

/// What is asked of a tensor: its numbers' type and its shape.
struct TensorShape {
    Type16 type;
    std::vector<std::uint64_t> shape;
};
/// An error where `tensors` are not those of `expected`, no more and no fewer, or where a half is not finite.
Result<Done> check_tensors(const std::map<std::string, Tensor16>& tensors,
                           const std::map<std::string, TensorShape>& expected, const std::string& source);
/// "[2, 3]".
std::string shape_text(const std::vector<std::uint64_t>& shape);

/// What a file holds: tensors by name and the string metadata.
struct Safetensors {
    std::map<std::string, Tensor16> tensors;
    std::map<std::string, std::string> metadata;
};

/// The container's bytes, tensors in the order of their names; the header is padded so that data begin at a
/// multiple of 8.
std::vector<std::byte> write_safetensors(const Safetensors& content);

/// Every size is checked before anything is allocated: tensors must be F16 or U16, their offsets must agree with
/// their shapes and tile the data without overlap, gap or rest.
Result<Safetensors> read_safetensors(std::span<const std::byte> bytes, const std::string& source);

}  // namespace srbf
