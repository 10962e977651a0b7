// libFuzzer for one of the targets, named by SRBF_FUZZ_TARGET.
#include <algorithm>
#include <cstdint>

#include "targets.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const auto target = *std::ranges::find(srbf::k_targets, SRBF_FUZZ_TARGET, &srbf::NamedTarget::name);
    target.check(std::as_bytes(std::span(data, size)));
    return 0;
}
