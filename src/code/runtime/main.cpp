// Prints srbf_runtime.h.
#include <cstdio>
#include <string>

#include "srbf/shading_code.h"

int main() {
    const std::string text = srbf::runtime_code();
    return std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0 ? 0 : 1;
}
