// Hashes of files' contents.
#pragma once
#include <fmt/format.h>

#include <cstdint>
#include <span>
#include <string>

namespace srbf {

/// FNV-1a, 64 bits.
class Hash {
  public:
    void add(std::span<const std::byte> bytes) {
        for (const std::byte byte : bytes) state_ = (state_ ^ std::uint64_t(byte)) * 0x100000001b3;
    }
    std::string text() const { return fmt::format("{:016x}", state_); }

  private:
    std::uint64_t state_ = 0xcbf29ce484222325;
};

inline std::string hash_of(std::span<const std::byte> bytes) {
    Hash hash;
    hash.add(bytes);
    return hash.text();
}

}  // namespace srbf
