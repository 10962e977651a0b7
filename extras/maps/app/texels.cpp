#include "extras/maps/app/texels.h"

#include <fmt/format.h>

#include <cstring>
#include <filesystem>

#include "base/files.h"
#include "srbf/file.h"
#include "srbf/npy.h"

namespace srbf {

Result<Texels> Texels::open(const std::string& path, std::size_t pairs) {
    const auto beginning = read_part(path, 0, k_most_npy_head);
    if (!beginning) return beginning.error();
    std::error_code code;
    const std::uint64_t size = std::filesystem::file_size(path, code);
    if (code) return Error{path, {}, "cannot be read", "a file", code.message(), ErrorCode::unreadable};
    const auto head = read_npy_head(*beginning, size, path);
    if (!head) return head.error();
    const auto& shape = head->shape;
    const std::uint64_t channels = shape.size() == 3 ? shape[2] : 1;
    if (shape.size() < 2 || shape.size() > 3 || shape[1] != pairs || (channels != 1 && channels != 3))
        return Error{path, 10, "shape", fmt::format("[T, {0}, 3], [T, {0}, 1] or [T, {0}]", pairs),
                     fmt::format("[{}]", fmt::join(shape, ", "))};
    Texels texels;
    texels.path_ = path, texels.pairs_ = pairs, texels.data_ = head->data;
    texels.channels_ = std::size_t(channels), texels.count_ = std::size_t(shape[0]);
    return texels;
}

Result<Done> Texels::read(std::size_t first, std::span<Rgb> f) const {
    const std::size_t bytes = f.size() * channels_ * sizeof(float);
    const auto part = read_part(path_, data_ + first * pairs_ * channels_ * sizeof(float), bytes);
    if (!part) return part.error();
    if (part->size() != bytes) return Error{path_, data_, "size", "that of its header", "a file that became smaller"};
    for (std::size_t i = 0; i < f.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            float number;
            std::memcpy(&number, part->data() + (i * channels_ + (channels_ == 3 ? c : 0)) * sizeof number,
                        sizeof number);
            f[i][int(c)] = number;
        }
    return Done{};
}

}  // namespace srbf
