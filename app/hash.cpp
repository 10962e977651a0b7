#include "app/hash.h"

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

}  // namespace srbf
