#include "srbf/result.h"

#include <atomic>
#include <cstdio>
#include <cstdlib>

#include "base/errors.h"
#include "base/files.h"
#include "base/printable.h"

namespace SRBF_NAMESPACE {

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
    return printable(line);  // file names and contents may contain any byte
}

std::string_view name(ErrorCode code) {
    constexpr std::string_view names[] = {"malformed", "unreadable", "wrong kind", "argument", "no data", "cancelled"};
    return names[std::size_t(code)];
}

Error cancelled_error(std::string source) { return {std::move(source), {}, "cancelled", {}, {}, ErrorCode::cancelled}; }

Error out_of_memory_error(std::string source) {
    return {std::move(source), {}, "out of memory", {}, {}, ErrorCode::unreadable};
}

namespace {
std::atomic<MisuseHandler> misuse_handler = nullptr;
}
MisuseHandler set_misuse_handler(MisuseHandler handler) { return misuse_handler.exchange(handler); }

void misused(std::string_view what) {
    if (const MisuseHandler handler = misuse_handler)
        handler(what);
    else
        std::fprintf(stderr, "srbf: misuse: %.*s\n", int(what.size()), what.data());
    std::abort();
}

}  // namespace
