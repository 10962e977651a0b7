// The safetensors container: an 8-byte little-endian header length, a JSON header, raw little-endian data.
#pragma once
#include <array>
#include <cstddef>
#include <map>
#include <span>
#include <vector>

#include "srbf/result.h"

namespace SRBF_NAMESPACE {

enum class Type16 { half, count };  // "F16", "U16"

/// A tensor of 16-bit elements.
struct Tensor16 {
    Type16 type = Type16::half;
    std::vector<std::uint64_t> shape;
    std::vector<std::uint16_t> data;  ///< the elements; their number is the product of the shape
};

struct TensorShape {
    Type16 type;
    std::vector<std::uint64_t> shape;
};
/// Returns an error unless `tensors` has exactly the tensors of `expected` and every 16-bit float is finite.
Result<Done> check_tensors(const std::map<std::string, Tensor16>& tensors,
                           const std::map<std::string, TensorShape>& expected, const std::string& file_name);
/// The shape [A, B] of the tensor 'bandwidth', which determines the shapes of a model's other tensors. Returns an
/// error, in which `expected` states the limits, unless `min` ≤ [A, B] ≤ `max`.
using Shape2 = std::array<std::uint64_t, 2>;
Result<Shape2> shape_of_bandwidths(const std::map<std::string, Tensor16>& tensors, Shape2 min, Shape2 max,
                                   const std::string& expected, const std::string& file_name);
/// "[2, 3]".
std::string shape_text(const std::vector<std::uint64_t>& shape);

using Metadata = std::map<std::string, std::string>;
struct Safetensors {
    std::map<std::string, Tensor16> tensors;
    Metadata metadata;
};

/// Removes the metadata that determine the meaning of tensors; the rest is provenance.
struct MetadataReader {
    Metadata& metadata;
    const std::string& file_name;
    std::optional<Error> error = {};  ///< the first error

    /// Removes and returns the value of `key`, which must be one of `known`.
    std::string take(const char* key, const std::vector<std::string_view>& known);
};

/// Tensors are written in the order of their names. The header is padded so that data begin at a multiple of 8. Those
/// in `last` have no data, which the caller appends in this order.
std::vector<std::byte> write_safetensors(const Safetensors& content, const std::vector<std::string>& last = {});

/// Reads the length of the header. Returns an error if it is longer than the file or than 1 MB.
Result<std::uint64_t> header_length(std::span<const std::byte> bytes, const std::string& file_name);

/// Checks every size before it allocates: tensors must be F16 or U16, their offsets must match their shapes and cover
/// the data without overlaps, gaps or a remainder.
Result<Safetensors> read_safetensors(std::span<const std::byte> bytes, const std::string& file_name);

}  // namespace
