#include "extras/maps/app/texels.h"

#include <fmt/format.h>

#include <filesystem>

#include "base/files.h"
#include "measured/samples.h"
#include "srbf/file.h"
#include "srbf/npy.h"

namespace SRBF_NAMESPACE {

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
    auto file = FileReader::open(path);
    if (!file) return file.error();
    Texels texels(*std::move(file));
    texels.pairs_ = pairs, texels.data_ = head->data;
    texels.channels_ = std::size_t(channels), texels.count_ = std::size_t(shape[0]);
    return texels;
}

Result<Done> Texels::read(std::size_t first, std::span<Rgb> f) const {
    // Grey numbers are read into the end of the colours, in front of which they are spread.
    const auto numbers = std::span(&f[0].r, 3 * f.size()).last(f.size() * channels_);
    const std::uint64_t offset = data_ + first * pairs_ * channels_ * sizeof(float);
    const auto read = file_.read(offset, std::as_writable_bytes(numbers));
    if (!read) return read.error();
    if (*read != numbers.size_bytes())
        return Error{file_.path(), data_, "size", "that of its header", "a file that became smaller"};
    for (std::size_t i = 0; channels_ == 1 && i < f.size(); ++i) {
        const float grey = numbers[i];
        f[i] = {grey, grey, grey};
    }
    for (std::size_t t = 0; t < f.size() / pairs_; ++t) {
        std::vector<std::string> notes;
        mask_missing({&f[t * pairs_].r, 3 * pairs_}, 3, &notes);
        if (note_.empty() && !notes.empty()) note_ = fmt::format("texel {}: {}", first + t, notes[0]);
    }
    return Done{};
}

}  // namespace srbf
