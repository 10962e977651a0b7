// Numbers in bytes, and recognition of binary formats.
#pragma once
#include <bit>
#include <cstddef>
#include <cstring>
#include <span>
#include <vector>

namespace SRBF_NAMESPACE {

static_assert(std::endian::native == std::endian::little, "the formats read here are little-endian");

/// Reads a number at `bytes`, which need not be aligned.
template <typename T> T load(const std::byte* bytes) {
    T number;
    std::memcpy(&number, bytes, sizeof number);
    return number;
}

template <typename T> void store(std::vector<std::byte>& bytes, const T& number) {
    const auto raw = std::as_bytes(std::span(&number, 1));
    bytes.insert(bytes.end(), raw.begin(), raw.end());
}

/// True if `bytes` begin a file of the format. A MERL file has three dimensions that match its size, or those of the
/// database, so that a truncated table is recognised. A UTIA file is recognised by its size, others by their first
/// words.
bool is_merl(std::span<const std::byte> bytes);
bool is_rgl(std::span<const std::byte> bytes);
bool is_utia(std::span<const std::byte> bytes);
bool is_mbsdf(std::span<const std::byte> bytes);

/// The size of a MERL file by the dimensions at its head; 0 if they are invalid.
std::uint64_t merl_bytes(std::span<const std::byte> head);
std::uint64_t utia_bytes();

}  // namespace srbf
