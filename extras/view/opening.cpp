#include "extras/view/opening.h"

#include <algorithm>
#include <cstdlib>

namespace srbf {

std::vector<std::string> matches(const Opening& opening) {
    std::vector<std::string> found;
    for (const std::string& path : opening.recent)
        if (path.find(opening.typed) != path.npos) found.push_back(path);
    return found;
}

void press(std::string_view name, Opening& opening) {
    const int by = name == "Down" ? 1 : name == "Up" ? -1 : 0;
    opening.chosen = std::clamp(opening.chosen + by, -1, int(matches(opening).size()) - 1);
    opening.is_confirmed = opening.is_confirmed || name == "Enter";
    opening.is_cancelled = opening.is_cancelled || name == "Escape";
}

std::string file_of(const Opening& opening) {
    const std::vector<std::string> found = matches(opening);
    if (opening.chosen >= 0 && opening.chosen < int(found.size())) return found[std::size_t(opening.chosen)];
    const char* home = std::getenv("HOME");
    return home && opening.typed.starts_with("~/") ? home + opening.typed.substr(1) : opening.typed;
}

}  // namespace srbf
