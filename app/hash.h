// Hashes of files' content, and keys of results.
#pragma once
#include <fmt/format.h>

#include <span>

#include "srbf/result.h"

namespace srbf {

/// The 64-bit hash FNV-1a.
class Hash {
  public:
    void add(std::span<const std::byte> bytes) {
        for (const std::byte byte : bytes) state_ = (state_ ^ std::uint64_t(byte)) * 0x100000001b3;
    }
    std::uint64_t number() const { return state_; }
    std::string text() const { return fmt::format("{:016x}", state_); }

  private:
    std::uint64_t state_ = 0xcbf29ce484222325;
};

inline std::string hash_of(std::span<const std::byte> bytes) {
    Hash hash;
    hash.add(bytes);
    return hash.text();
}

/// The key under which a later run finds a result: a hash of all that the result depends on. The constructor adds
/// the program's version and its arguments; the caller adds the inputs, in a fixed order.
class ResultKey {
  public:
    /// `kind`: the kind of result; `settings`: the options that it depends on (`Subcommand::settings`).
    ResultKey(std::string_view kind, std::string_view settings);
    void add(std::span<const std::byte> bytes);
    void add(std::string_view text);
    std::string text() const { return hash_.text(); }

  private:
    Hash hash_;
};

}  // namespace srbf
