// The container of RGL measurements: named arrays of numbers.
//
//   "tensor_file\0", version 1.0 in two bytes, the number of fields (u32); for each field: length of the name (u16),
//   name, rank (u16), type (u8), offset of its numbers in the file (u64), extents (u64 each); then the numbers, with
// the
//   last index fastest. All numbers are little-endian.
#pragma once
#include <fmt/ranges.h>

#include <map>

#include "measured/bytes.h"
#include "srbf/result.h"

namespace SRBF_NAMESPACE {

inline constexpr std::string_view k_tensor_magic("tensor_file\0", 12);
/// Limits far above those of any measurement.
inline constexpr std::uint32_t k_max_tensor_fields = 1024;
inline constexpr std::uint16_t k_max_tensor_extents = 8;

/// Element types with their codes in the file.
enum class TensorType : std::uint8_t { u8 = 1, i8, u16, i16, u32, i32, u64, i64, f16, f32, f64 };
inline constexpr std::array<std::uint64_t, 12> k_tensor_type_bytes{0, 1, 1, 2, 2, 4, 4, 8, 8, 2, 4, 8};
inline constexpr std::array<std::string_view, 12> k_tensor_type_names{"",    "u8",  "i8",  "u16", "i16", "u32",
                                                                      "i32", "u64", "i64", "f16", "f32", "f64"};

/// A field; its numbers remain in the file's bytes.
struct TensorField {
    TensorType type{};
    std::uint64_t offset = 0;  ///< position of the numbers in the file
    std::vector<std::uint64_t> shape;
    std::span<const std::byte> bytes;  ///< the numbers
};

using TensorFile = std::map<std::string, TensorField, std::less<>>;

/// "8 x 32 x 32 of f32"
inline std::string describe(TensorType type, std::span<const std::uint64_t> shape) {
    return fmt::format("{} of {}", fmt::join(shape, " x "), k_tensor_type_names[std::size_t(type)]);
}

/// Reads consecutive numbers; no value past the end.
class ByteReader {
  public:
    explicit ByteReader(std::span<const std::byte> bytes) : bytes_(bytes) {}
    std::uint64_t offset() const { return offset_; }
    template <typename T> std::optional<T> take() {
        const auto raw = take_bytes(sizeof(T));
        if (!raw) return {};
        return load<T>(raw->data());
    }
    std::optional<std::span<const std::byte>> take_bytes(std::uint64_t count) {
        if (count > bytes_.size() - offset_) return {};
        const auto raw = bytes_.subspan(offset_, count);
        offset_ += count;
        return raw;
    }

  private:
    std::span<const std::byte> bytes_;
    std::size_t offset_ = 0;
};

/// The size of numbers of this type and shape in bytes; no value if it does not fit in 64 bits.
inline std::optional<std::uint64_t> tensor_bytes(TensorType type, std::span<const std::uint64_t> shape) {
    std::uint64_t size = k_tensor_type_bytes[std::size_t(type)];
    for (const std::uint64_t extent : shape)
        if (__builtin_mul_overflow(size, extent, &size)) return {};
    return size;
}

inline Result<std::pair<std::string, TensorField>> parse_tensor_field(ByteReader& reader,
                                                                      std::span<const std::byte> bytes,
                                                                      const std::string& file_name) {
    const std::uint64_t begin = reader.offset();
    const Error truncated{file_name, begin, "tensor field", "an entry in the table of fields", "the end of the file"};
    const auto name_length = reader.take<std::uint16_t>();
    const auto raw_name = name_length ? reader.take_bytes(*name_length) : std::nullopt;
    const auto rank = reader.take<std::uint16_t>();
    const auto type = reader.take<std::uint8_t>();
    const auto offset = reader.take<std::uint64_t>();
    if (!raw_name || !rank || !type || !offset) return truncated;
    const std::string name(reinterpret_cast<const char*>(raw_name->data()), raw_name->size());
    const std::string shown = name.substr(0, 40);
    if (*type == 0 || *type >= k_tensor_type_bytes.size())
        return Error{file_name, begin, "type of tensor field " + shown, "between 1 and 11", fmt::format("{}", *type)};

    if (*rank > k_max_tensor_extents)
        return Error{file_name, begin, "rank of tensor field " + shown, fmt::format("at most {}", k_max_tensor_extents),
                     fmt::format("{}", *rank)};

    TensorField field{TensorType(*type), *offset, {}, {}};
    for (int i = 0; i < *rank; ++i) {
        const auto extent = reader.take<std::uint64_t>();
        if (!extent) return truncated;
        field.shape.push_back(*extent);
    }
    const auto size = tensor_bytes(field.type, field.shape);
    if (!size || *offset > bytes.size() || *size > bytes.size() - *offset)
        return Error{file_name, begin, "tensor field " + shown, fmt::format("to lie within {} bytes", bytes.size()),
                     fmt::format("{} from byte {}", describe(field.type, field.shape), *offset)};
    field.bytes = bytes.subspan(*offset, *size);
    return std::pair(name, std::move(field));
}

inline Result<TensorFile> parse_tensor_file(std::span<const std::byte> bytes, const std::string& file_name) {
    ByteReader reader(bytes);
    const auto magic = reader.take_bytes(k_tensor_magic.size());
    if (!magic || std::memcmp(magic->data(), k_tensor_magic.data(), k_tensor_magic.size()) != 0)
        return Error{file_name, 0, "tensor file", "to begin with \"tensor_file\"", ""};
    const auto major = reader.take<std::uint8_t>(), minor = reader.take<std::uint8_t>();
    const auto count = reader.take<std::uint32_t>();
    if (!count) return Error{file_name, bytes.size(), "tensor file header", "18 bytes", "the end of the file"};
    if (*major != 1 || *minor != 0)
        return Error{file_name, 12, "version of the tensor file", "1.0", fmt::format("{}.{}", *major, *minor)};

    if (*count > k_max_tensor_fields)
        return Error{file_name, 14, "number of tensor fields", fmt::format("at most {}", k_max_tensor_fields),
                     fmt::format("{}", *count)};

    TensorFile file;
    for (std::uint32_t i = 0; i < *count; ++i) {
        const std::uint64_t begin = reader.offset();
        auto field = parse_tensor_field(reader, bytes, file_name);
        if (!field) return field.error();
        const std::string name = field->first;
        if (!file.insert(*std::move(field)).second)
            return Error{file_name, begin, "tensor field " + name.substr(0, 40), "each name once", "the name again"};
    }
    return file;
}

}  // namespace
