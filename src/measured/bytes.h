// Numbers out of bytes, and the formats told apart: private to the readers.
#pragma once
#include <bit>
#include <cstddef>
#include <cstring>
#include <span>
#include <vector>

namespace srbf {

static_assert(std::endian::native == std::endian::little, "the formats read here are little-endian");

/// The number stored at `bytes`, at any alignment.
template <typename T> T load(const std::byte* bytes) {
    T number;
    std::memcpy(&number, bytes, sizeof number);
    return number;
}

/// Appends the number as it is stored.
template <typename T> void store(std::vector<std::byte>& bytes, const T& number) {
    const auto raw = std::as_bytes(std::span(&number, 1));
    bytes.insert(bytes.end(), raw.begin(), raw.end());
}

/// Whether `bytes` open a file of the format: for MERL, three dimensions that give the size, or those of the
/// database (so that a truncated table is known for what it is); for RGL, the name of the container; for UTIA, the size.
bool is_merl(std::span<const std::byte> bytes);
bool is_rgl(std::span<const std::byte> bytes);
bool is_utia(std::span<const std::byte> bytes);

}  // namespace srbf
