// Expectations of readers of text: changed and truncated files are errors.
#pragma once
#include "properties.h"

namespace srbf {

/// A change of a text, and words of the error that it causes.
struct BadChange {
    std::string_view part, replacement, error;
};
/// Expects that `read` of the text with each of the changes is an error of one line.
template <typename Read>
void expect_errors(const Read& read, const std::string& text, std::initializer_list<BadChange> changes) {
    for (const auto& [part, replacement, error] : changes) {
        const std::string found = error_text(read(replaced(text, part, replacement)));
        EXPECT_NE(found, "") << part << " → " << replacement;
        EXPECT_CONTAINS(found, error) << part << " → " << replacement;
        EXPECT_LACKS(found, "\n");
    }
}

/// Expects that `read` of the first 0, `step`, 2 `step`.. characters is an error, while `end` or more are missing.
template <typename Read>
void expect_truncations_refused(const Read& read, const std::string& text, std::size_t end = 1, std::size_t step = 1) {
    for (std::size_t size = 0; size + end <= text.size(); size += step)
        EXPECT_NE(error_text(read(text.substr(0, size))), "") << size;
}

}  // namespace srbf
