#include "extras/view/recent.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <span>

#include "base/text.h"
#include "srbf/file.h"

namespace SRBF_NAMESPACE {
namespace {

std::filesystem::path list_path() {
    if (const char* state = std::getenv("XDG_STATE_HOME"); state && *state)
        return std::filesystem::path(state) / "srbf" / "recent";
    if (const char* home = std::getenv("HOME"); home && *home)
        return std::filesystem::path(home) / ".local" / "state" / "srbf" / "recent";
    return {};
}

}  // namespace

std::vector<std::string> recent_files() {
    std::vector<std::string> files;
    const std::filesystem::path list = list_path();
    if (list.empty()) return files;
    const auto bytes = read_file(list.string());
    if (!bytes) return files;
    std::string_view remaining = as_text(*bytes);
    while (!remaining.empty() && files.size() < k_most_recent) {
        const auto end = std::min(remaining.find('\n'), remaining.size());
        std::error_code ignored;
        if (std::filesystem::is_regular_file(remaining.substr(0, end), ignored))
            files.emplace_back(remaining.substr(0, end));
        remaining.remove_prefix(std::min(end + 1, remaining.size()));
    }
    return files;
}

void keep_recent(const std::string& path) {
    const std::filesystem::path list = list_path();
    std::error_code error;
    const std::string absolute = std::filesystem::absolute(path, error).string();
    if (list.empty() || error || absolute.find('\n') != absolute.npos) return;
    std::vector<std::string> files = recent_files();
    std::erase(files, absolute);
    files.insert(files.begin(), absolute);
    std::string text;
    for (std::size_t i = 0; i < std::min(files.size(), k_most_recent); ++i) text += files[i] + '\n';
    std::filesystem::create_directories(list.parent_path(), error);
    if (!error) (void)write_file(list.string(), std::as_bytes(std::span(text)));
}

}  // namespace srbf
