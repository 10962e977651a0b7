// Hashes of files' contents, and keys of results.
#pragma once
#include <fmt/format.h>

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "srbf/result.h"

namespace srbf {

/// FNV-1a, 64 bits.
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

/// The key of a result that is kept by a later run: a hash of all that the result depends on. The version of the program
/// and what the constructor takes are a part of it; the inputs are to be added, in a fixed order.
class ResultKey {
  public:
    /// `kind`: of the result; `settings`: the options on which it depends (`Subcommand::settings`).
    ResultKey(std::string_view kind, std::string_view settings);
    void add(std::span<const std::byte> bytes);
    void add(std::string_view text);
    /// The content of a file, a block of it in memory. Errors: those of `FileReader`.
    Result<Done> add_file(const std::string& path);
    std::string text() const { return hash_.text(); }

  private:
    Hash hash_;
};

}  // namespace srbf
