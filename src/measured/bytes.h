// Numbers in bytes, and recognition of the formats: private to the readers.
#pragma once
#include <bit>
#include <cstddef>
#include <cstring>
#include <span>
#include <vector>

namespace srbf {

static_assert(std::endian::native == std::endian::little, "the formats read here are little-endian");

/// Reads a number at `bytes`, without alignment requirements.
template <typename T> T load(const std::byte* bytes) {
    T number;
    std::memcpy(&number, bytes, sizeof number);
    return number;
}

/// Appends the bytes of a number.
template <typename T> void store(std::vector<std::byte>& bytes, const T& number) {
    const auto raw = std::as_bytes(std::span(&number, 1));
    bytes.insert(bytes.end(), raw.begin(), raw.end());
}

/// True if `bytes` begin a file of the format. MERL: three dimensions that match the size, or those of the database (so
/// that a truncated table is recognised); RGL: the name of the container; UTIA: the size; MBSDF: its first words.
bool is_merl(std::span<const std::byte> bytes);
bool is_rgl(std::span<const std::byte> bytes);
bool is_utia(std::span<const std::byte> bytes);
bool is_mbsdf(std::span<const std::byte> bytes);

std::uint64_t merl_bytes(std::span<const std::byte> head);  ///< by its dimensions; 0: none
std::uint64_t utia_bytes();

}  // namespace srbf
