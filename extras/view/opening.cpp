#include "extras/view/opening.h"

#include <algorithm>
#include <cstdlib>

namespace SRBF_NAMESPACE {

std::vector<std::string> matches(const Opening& opening) {
    std::vector<std::string> paths;
    for (const std::string& path : opening.recent)
        if (path.find(opening.typed) != path.npos) paths.push_back(path);
    return paths;
}

void press(std::string_view name, Opening& opening) {
    const int step = name == "Down" ? 1 : name == "Up" ? -1 : 0;
    opening.chosen = std::clamp(opening.chosen + step, -1, int(matches(opening).size()) - 1);
    opening.is_confirmed = opening.is_confirmed || name == "Enter";
    opening.is_cancelled = opening.is_cancelled || name == "Escape";
}

std::string file_of(const Opening& opening) {
    const std::vector<std::string> paths = matches(opening);
    if (opening.chosen >= 0 && opening.chosen < int(paths.size())) return paths[std::size_t(opening.chosen)];
    const char* home = std::getenv("HOME");
    return home && opening.typed.starts_with("~/") ? home + opening.typed.substr(1) : opening.typed;
}

}  // namespace srbf
