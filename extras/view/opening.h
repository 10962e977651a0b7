// The field in which a file to open is typed or selected; independent of the window.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace SRBF_NAMESPACE {

struct Opening {
    std::string typed;
    std::vector<std::string> recent;  ///< paths, the latest first
    int chosen = -1;                  ///< index into `matches`; −1: the typed file
    bool is_confirmed = false, is_cancelled = false;
};

/// The recent files whose paths contain the typed text.
std::vector<std::string> matches(const Opening& opening);
/// Down and Up select among the typed text and the matches, Enter confirms, Escape cancels. The names are those of
/// `Key`.
void press(std::string_view name, Opening& opening);
/// The selected match, or the typed path, in which a leading "~/" means the folder $HOME. Empty: none.
std::string file_of(const Opening& opening);

}  // namespace srbf
