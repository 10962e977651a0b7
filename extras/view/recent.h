// Files that were opened lately, over runs of the program.
#pragma once
#include <string>
#include <vector>

namespace srbf {

/// Absolute paths, the latest first, at most `k_most_recent`; those that are no longer there are left out. They are
/// lines of srbf/recent in $XDG_STATE_HOME, by default ~/.local/state.
std::vector<std::string> recent_files();
inline constexpr std::size_t k_most_recent = 12;
/// Makes a file the latest. Where the list cannot be written, nothing happens.
void keep_recent(const std::string& path);

}  // namespace srbf
