// Names that exported code defines, each by one owner.
#pragma once
#include <fmt/format.h>

#include <map>

#include "srbf/result.h"

namespace SRBF_NAMESPACE {

/// The names that the texts of one file define.
class DefinedNames {
  public:
    /// Adds a name that the code of `owner` defines. Returns an error if another owner defines it.
    Result<Done> add(const std::string& name, const std::string& owner) {
        const auto [entry, is_new] = owners_.emplace(name, owner);
        if (is_new) return Done{};
        return Error{fmt::format("{} and {}", entry->second, owner),
                     {},
                     "names in their code",
                     "different ones",
                     fmt::format("{} of both: rename one of the files", name),
                     ErrorCode::argument};
    }

  private:
    std::map<std::string, std::string> owners_;
};

}  // namespace
