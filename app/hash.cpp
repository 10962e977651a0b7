#include "app/hash.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "base/files.h"
#include "srbf/file.h"

namespace srbf {

ResultKey::ResultKey(std::string_view kind, std::string_view settings) {
    for (const std::string_view text : {std::string_view(SRBF_VERSION), kind, settings}) add(text);
}

void ResultKey::add(std::span<const std::byte> bytes) {
    const std::uint64_t size = bytes.size();  // so that the same bytes in other parts have another hash
    hash_.add(std::as_bytes(std::span(&size, 1)));
    hash_.add(bytes);
}

void ResultKey::add(std::string_view text) { add(as_bytes(text)); }

Result<Done> ResultKey::add_file(const std::string& path) {
    auto file = FileReader::open(path);
    if (!file) return file.error();
    // Steps of FNV-1a with words instead of bytes, in four sequences; rotations take high bits to the low ones.
    std::array<std::uint64_t, 4> state{1, 2, 3, 4}, words;
    std::vector<std::byte> block(std::size_t(1) << 20);
    for (std::uint64_t size = 0;;) {
        const auto count = file->read(block);
        if (!count) return count.error();
        size += *count;
        std::fill(block.begin() + std::ptrdiff_t(*count), block.end(), std::byte(0));
        for (std::size_t i = 0; i < *count; i += sizeof words) {
            std::memcpy(words.data(), block.data() + i, sizeof words);
            for (std::size_t k = 0; k < words.size(); ++k)
                state[k] = std::rotl((state[k] ^ words[k]) * 0x100000001b3, 29);
        }
        if (*count == block.size()) continue;
        add(std::as_bytes(std::span(&size, 1)));
        add(std::as_bytes(std::span(state)));
        return Done{};
    }
}

}  // namespace srbf
