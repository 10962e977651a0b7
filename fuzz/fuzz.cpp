// libFuzzer for one of the targets, named by SRBF_FUZZ_TARGET.
#include <algorithm>
#include <cstdint>
#include <cstring>

#include "uses.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max);

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const auto target = [] {
        auto targets = srbf::all_targets();
        targets.push_back({"uses", srbf::check_uses});
        return *std::ranges::find(targets, SRBF_FUZZ_TARGET, &srbf::NamedTarget::name);
    }();
    target.check(std::as_bytes(std::span(data, size)));
    return 0;
}

/// Half of the mutations of a model file change only its numbers, so that the file remains readable.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max, unsigned seed) {
    std::uint64_t header = 0;
    if (size > sizeof header) std::memcpy(&header, data, sizeof header);
    if (seed % 2 == 0 || header == 0 || header >= size - sizeof header) return LLVMFuzzerMutate(data, size, max);
    std::uint8_t* const numbers = data + sizeof header + header;
    const std::size_t count = size - sizeof header - header, changed = LLVMFuzzerMutate(numbers, count, count);
    std::fill(numbers + changed, numbers + count, std::uint8_t(0));
    return size;
}
