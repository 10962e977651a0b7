#include "srbf/result.h"

#include <fmt/format.h>

namespace srbf {

std::string message(const Error& error) {
    std::string line = error.source;
    const auto append = [&line](const std::string& part) {
        if (part.empty()) return;
        if (!line.empty()) line += ": ";
        line += part;
    };
    if (error.offset) append(fmt::format("at {}", *error.offset));
    append(error.what);
    std::string contrast;
    if (!error.expected.empty()) contrast = "expected " + error.expected;
    if (!error.found.empty()) contrast += (contrast.empty() ? "found " : ", found ") + error.found;
    append(contrast);
    // Names of files and of what they hold may carry any byte, but a message is one line.
    for (char& c : line)
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
    return line;
}

}  // namespace srbf
