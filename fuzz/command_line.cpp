// libFuzzer for command lines.
#include "command_line.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    srbf::check_command_line(std::as_bytes(std::span(data, size)));
    return 0;
}
