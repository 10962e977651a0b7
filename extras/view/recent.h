// Recently opened files, across runs of the program.
#pragma once
#include <string>
#include <vector>

namespace SRBF_NAMESPACE {

/// Absolute paths, the latest first, at most `k_most_recent`. Files that no longer exist are omitted. The list is
/// in the file srbf/recent in $XDG_STATE_HOME, by default ~/.local/state.
std::vector<std::string> recent_files();
inline constexpr std::size_t k_most_recent = 12;
/// Makes a file the latest. Does nothing if the list cannot be written.
void keep_recent(const std::string& path);

}  // namespace srbf
