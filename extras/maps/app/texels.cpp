#include "extras/maps/app/texels.h"

#include <filesystem>

#include "brdf/directions.h"
#include "brdf/values.h"
#include "extras/maps/npy.h"
#include "measured/samples.h"
#include "measured/tables.h"

namespace SRBF_NAMESPACE {
namespace {

/// Number of candidates for the texels that span the set, and the most values of them in memory.
constexpr std::size_t k_spread_texels = 1024, k_max_values = std::size_t(1) << 24;
/// A candidate's values are left out where f cosθl cosθv is more than k_max_of_others times the largest one of any
/// pair in all but the brightest k_brightest of the candidates.
constexpr double k_brightest = 0.02, k_max_of_others = 1000;

/// Sets values of the candidates that no other texel is near to NaN.
void leave_out_outliers(const SharedPairs& pairs, std::span<Rgb> f) {
    const std::size_t M = pairs.wl.size();
    const auto value = [&](std::size_t i) {
        const double product = largest_of(f[i]) * cosines(pairs.wl[i % M], pairs.wv[i % M]);
        return is_finite(f[i]) ? product : 0;
    };
    std::vector<double> largest(f.size() / M);
    for (std::size_t i = 0; i < f.size(); ++i) largest[i / M] = std::max(largest[i / M], value(i));
    std::ranges::sort(largest);
    const double max = k_max_of_others * largest[std::size_t((1 - k_brightest) * double(largest.size() - 1))];
    for (std::size_t i = 0; i < f.size() && max > 0; ++i)
        if (value(i) > max) f[i].r = std::numeric_limits<float>::quiet_NaN();
}

/// The values of texels that span the set. Each next texel is the one whose cube roots differ most from all texels that
/// were chosen before.
std::vector<Rgb> spanning_texels(std::span<const Rgb> f, std::size_t pairs, std::size_t max) {
    const std::size_t count = f.size() / pairs;
    const auto distance = [&](std::size_t a, std::size_t b) {
        double sum = 0;
        for (std::size_t i = 0; i < pairs; ++i)
            for (int c = 0; c < 3; ++c) {
                const double x = double(f[a * pairs + i][c]), y = double(f[b * pairs + i][c]);
                const double d = std::cbrt(x) - std::cbrt(y);
                if (std::isfinite(d)) sum += d * d;
            }
        return sum;
    };
    std::vector<double> nearest(count, std::numeric_limits<double>::infinity());
    std::vector<Rgb> chosen;
    std::size_t next = 0;
    for (std::size_t n = 0; n < std::min(count, max); ++n) {
        chosen.insert(chosen.end(), f.begin() + std::ptrdiff_t(next * pairs),
                      f.begin() + std::ptrdiff_t((next + 1) * pairs));
        for (std::size_t t = 0; t < count; ++t) nearest[t] = std::min(nearest[t], distance(t, next));
        next = std::size_t(std::ranges::max_element(nearest) - nearest.begin());
    }
    return chosen;
}

}  // namespace

Result<NpyFile> NpyFile::open(const std::string& path) {
    auto reader = FileReader::open(path);
    if (!reader) return reader.error();
    std::vector<std::byte> beginning(k_max_npy_head);
    const auto count = reader->read(0, beginning);
    if (!count) return count.error();
    std::error_code code;
    const std::uint64_t size = std::filesystem::file_size(path, code);
    if (code) return Error{path, {}, "cannot be read", "a file", code.message(), ErrorCode::unreadable};
    const auto head = read_npy_head(std::span(beginning).first(*count), size, path);
    if (!head) return head.error();
    NpyFile file(*std::move(reader));
    file.shape_ = head->shape;
    file.data_ = head->data;
    return file;
}

Result<Done> NpyFile::read(std::uint64_t first, std::span<float> numbers) const {
    const auto read = file_.read(data_ + first * sizeof(float), std::as_writable_bytes(numbers));
    if (!read) return read.error();
    if (*read == numbers.size_bytes()) return Done{};
    return Error{file_.path(), data_, "size", "that of its header", "a file that became smaller"};
}

Result<Texels> Texels::open(const std::string& path, std::size_t pairs) {
    auto file = NpyFile::open(path);
    if (!file) return file.error();
    const auto& shape = file->shape();
    const std::uint64_t channels = shape.size() == 3 ? shape[2] : 1;
    if (shape.size() < 2 || shape.size() > 3 || shape[1] != pairs || (channels != 1 && channels != 3))
        return Error{path, 10, "shape", fmt::format("[T, {0}, 3], [T, {0}, 1] or [T, {0}]", pairs),
                     fmt::format("[{}]", fmt::join(shape, ", "))};
    return Texels(*std::move(file), pairs, std::size_t(channels));
}

Result<Done> Texels::read(std::size_t first, std::span<Rgb> f) const {
    // Grey numbers are read into the end of the array of colours, and are then spread from its beginning.
    const auto numbers = std::span(&f[0].r, 3 * f.size()).last(f.size() * channels_);
    if (const auto read = file_.read(first * pairs_ * channels_, numbers); !read) return read;
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

Result<std::vector<Rgb>> Texels::spanning(const SharedPairs& pairs, std::size_t max) const {
    const std::size_t held = std::max(k_max_values / pairs_, max), spread = std::min({count(), k_spread_texels, held});
    std::vector<Rgb> candidates(spread * pairs_);
    for (std::size_t n = 0; n < spread; ++n)
        if (const auto done = read(n * count() / spread, std::span(candidates).subspan(n * pairs_, pairs_)); !done)
            return done.error();
    leave_out_outliers(pairs, candidates);
    return spanning_texels(candidates, pairs_, max);
}

}  // namespace
