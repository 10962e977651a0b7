// The field in which a file to open is typed or chosen; independent of the window.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace srbf {

struct Opening {
    std::string typed;
    std::vector<std::string> recent;  ///< paths, the latest first
    int chosen = -1;                  ///< of `matches`; −1: the file that is typed
    bool is_confirmed = false, is_cancelled = false;
};

/// The recent files whose paths contain what is typed.
std::vector<std::string> matches(const Opening& opening);
/// Down and Up choose among what is typed and the matches, Enter confirms, Escape cancels. Names as of `Key`.
void press(std::string_view name, Opening& opening);
/// The chosen match, or the path that is typed, of which a leading "~/" is the folder $HOME. Empty: none.
std::string file_of(const Opening& opening);

}  // namespace srbf
