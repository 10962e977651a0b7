// `srbf fit --pairs`: the texels of a file of arrays.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>

#include "app/commands.h"
#include "app/fit.h"
#include "app/hash.h"
#include "app/pairs.h"
#include "srbf/basis.h"
#include "srbf/file.h"
#include "srbf/fit_batch.h"
#include "srbf/half.h"
#include "srbf/npy.h"
#include "srbf/printable.h"

namespace srbf {
namespace {

namespace fs = std::filesystem;

/// A file of f_r [1/sr]: float32 [T, M, 3], or [T, M, 1] and [T, M] of grey ones.
class Texels {
  public:
    static Result<Texels> open(const std::string& path, std::size_t pairs) {
        const auto beginning = read_part(path, 0, k_most_npy_head);
        if (!beginning) return beginning.error();
        std::error_code code;
        const std::uint64_t size = fs::file_size(path, code);
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
    std::size_t count() const { return count_; }
    Result<Done> read(std::size_t first, std::span<Rgb> f) const {
        const std::size_t bytes = f.size() * channels_ * sizeof(float);
        const auto part = read_part(path_, data_ + first * pairs_ * channels_ * sizeof(float), bytes);
        if (!part) return part.error();
        if (part->size() != bytes)
            return Error{path_, data_, "size", "that of its header", "a file that became smaller"};
        for (std::size_t i = 0; i < f.size(); ++i)
            for (std::size_t c = 0; c < 3; ++c) {
                float number;
                std::memcpy(&number, part->data() + (i * channels_ + (channels_ == 3 ? c : 0)) * sizeof number,
                            sizeof number);
                f[i][int(c)] = number;
            }
        return Done{};
    }

  private:
    std::string path_;
    std::uint64_t data_ = 0;
    std::size_t pairs_ = 0, channels_ = 3, count_ = 0;
};

/// What is kept of the slabs for the summary.
struct Summary {
    std::size_t fitted = 0, black = 0, failed = 0, kept = 0;
    double error = 0;  ///< sum over fitted and kept texels
    std::string first_failure;
};

/// A stack that an earlier run made of the same values by the same options; none if it is missing or not whole.
std::optional<ModelStack> done_before(const std::string& path, const std::string& key, std::size_t count) {
    const auto bytes = read_file(path);
    if (!bytes) return {};
    auto stack = read_stack(*bytes, path);
    if (!stack || stack->models.size() != count || stack->provenance["key"] != key) return {};
    return *std::move(stack);
}

}  // namespace

int fit_texels(const TexelFits& fit) {
    const auto pairs = load_pairs(fit.pairs);
    if (!pairs) return complain(pairs.error());
    const auto texels = Texels::open(fit.input, pairs->wl.size());
    if (!texels) return complain(texels.error());
    if (fit.begin >= texels->count() || fit.end > texels->count())
        return complain({fit.input,
                         {},
                         "texels",
                         fmt::format("a range of 0:{}", texels->count()),
                         fmt::format("{}:{}", fit.begin, fit.end),
                         ErrorCode::argument});
    if (const auto folder = make_folder(fit.folder); !folder) return complain(folder.error());

    const std::string stem = fs::path(fit.input).stem().string();
    const auto name_of = [&](std::size_t first) {
        return (fs::path(fit.folder) / fmt::format("{}-{:09}.srbf", stem, first)).string();
    };
    Hash of_all;
    of_all.add(std::as_bytes(std::span(pairs->wl))), of_all.add(std::as_bytes(std::span(pairs->wv)));
    of_all.add(as_bytes(fmt::format("{} {} {}", SRBF_VERSION, fit.options, fit.anisotropic)));
    const auto key_of = [&](std::span<const Rgb> f) {
        Hash hash = of_all;
        hash.add(std::as_bytes(f));
        return hash.text();
    };

    Summary summary;
    const auto add_kept = [&](const ModelStack& stack) {
        summary.kept += stack.models.size();
        for (const float error : stack.error) summary.error += double(error);
    };
    const Stopwatch watch;
    ProgressLine line;
    BatchOptions options;
    options.request = fit.request;
    TexelStream stream{fit.begin, fit.end > 0 ? fit.end : texels->count(), fit.slab, {}, {}, {}};
    std::string key;  // of the slab that was read last
    stream.read = [&](std::size_t first, std::span<Rgb> f) {
        auto read = texels->read(first, f);
        key = key_of(f);
        return read;
    };
    stream.is_done = [&](std::size_t first, std::size_t count) {
        std::error_code none;
        if (!fit.resume || !fs::exists(name_of(first), none)) return false;
        std::vector<Rgb> f(count * pairs->wl.size());
        if (!texels->read(first, f)) return false;
        const auto stack = done_before(name_of(first), key_of(f), count);
        if (stack) add_kept(*stack);
        return stack.has_value();
    };
    stream.take = [&](std::size_t first, std::span<const TexelFit> fits) -> Result<Done> {
        ModelStack stack;
        for (const TexelFit& of : fits) {
            stack.models.push_back(of.model);
            const bool fitted = of.state == TexelState::fitted;
            stack.error.push_back(fitted ? float(error_of(of.errors, fit.request.objective)) : 0.f);
            stack.state.push_back(std::uint16_t(of.state));
            summary.fitted += fitted, summary.black += of.state == TexelState::black;
            summary.failed += of.state == TexelState::failed;
            summary.error += double(stack.error.back());
            if (of.failure && summary.first_failure.empty()) summary.first_failure = message(*of.failure);
        }
        stack.provenance = {{"generator", "srbf " SRBF_VERSION},
                            {"source", fs::path(fit.input).filename().string()},
                            {"first", std::to_string(first)},
                            {"objective", std::string(name(fit.request.objective))},
                            {"key", key}};
        return write_file(name_of(first), write_stack(stack));
    };
    const auto done = fit_batch({pairs->wl, pairs->wv, !fit.anisotropic}, stream, options,
                                [&](const Progress& now) { return line.show(now.stage, now.fraction), true; });
    line.clear();
    if (!done) return complain(done.error());
    const double seconds = watch.seconds(), with_error = double(summary.fitted + summary.kept);
    fmt::print("  {} texels fitted in {:.1f} s, {:.3g} a second; {} kept, {} black, {} failed\n",
               grouped(summary.fitted), seconds, double(summary.fitted) / seconds, grouped(summary.kept),
               grouped(summary.black), grouped(summary.failed));
    if (with_error > 0)
        fmt::print("  {}: mean {}\n", measure_named_for(fit.request.objective).title,
                   percent(summary.error / with_error));
    fmt::print("  models        {}\n", printable(fit.folder));
    if (summary.failed > 0) fmt::print(stderr, "srbf: {} texels: {}\n", summary.failed, summary.first_failure);
    if (const auto written = flush_standard_output(); !written) return complain(written.error());
    return summary.failed > 0 ? k_input_error : k_done;
}

namespace {

/// Texels among which those are chosen that span the set, and how many.
constexpr std::size_t k_spread_texels = 1024, k_spanning_texels = 48;

/// The values of texels that span the set: of some at equal distances each the farthest from those chosen before, by
/// cube roots.
std::vector<Rgb> spanning_texels(std::span<const Rgb> f, std::size_t pairs) {
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
    for (std::size_t n = 0; n < std::min(count, k_spanning_texels); ++n) {
        chosen.insert(chosen.end(), f.begin() + std::ptrdiff_t(next * pairs),
                      f.begin() + std::ptrdiff_t((next + 1) * pairs));
        for (std::size_t t = 0; t < count; ++t) nearest[t] = std::min(nearest[t], distance(t, next));
        next = std::size_t(std::ranges::max_element(nearest) - nearest.begin());
    }
    return chosen;
}

/// Coefficients that an earlier run made, and those that this one adds: a file of 16-bit floats, of each texel its
/// 3 J coefficients and its error.
class Journal {
  public:
    Journal(std::string path, std::size_t numbers) : path_(std::move(path)), texel_(numbers * sizeof(std::uint16_t)) {}
    /// The number of texels that are whole in it, a multiple of the slab; the rest is cut off.
    std::size_t kept(std::size_t slab) const {
        std::error_code none;
        const auto size = fs::file_size(path_, none);
        if (none) return 0;
        const std::size_t whole = std::size_t(size) / (slab * texel_) * slab;
        fs::resize_file(path_, whole * texel_, none);
        return none ? 0 : whole;
    }
    Result<Done> add(std::span<const std::uint16_t> numbers) const {
        std::ofstream file(path_, std::ios::binary | std::ios::app);
        file.write(reinterpret_cast<const char*>(numbers.data()), std::streamsize(numbers.size_bytes()));
        file.flush();
        if (!file) return Error{path_, {}, "cannot be written", "space", "an error"};
        return Done{};
    }
    const std::string& path() const { return path_; }

  private:
    std::string path_;
    std::size_t texel_;  // bytes
};

/// Coefficients as the journal has them, in the scale of 16-bit floats.
std::vector<std::uint16_t> numbers_of(const TexelCoefficients& of, std::size_t J) {
    std::vector<std::uint16_t> numbers;
    for (std::size_t t = 0; t < of.error.size(); ++t) {
        for (std::size_t j = 0; j < J; ++j)
            for (int c = 0; c < 3; ++c) numbers.push_back(to_half(std::min(of.coefficient[t * J + j][c], k_half_max)));
        numbers.push_back(to_half(of.error[t]));
    }
    return numbers;
}

/// The library of all texels, of the journal's numbers.
Result<Library> whole_library(Library library, const Journal& journal, std::size_t count) {
    const auto bytes = read_file(journal.path());
    if (!bytes) return bytes.error();
    const std::size_t J = std::size_t(library.basis.lobes), numbers = 3 * J + 1;
    if (bytes->size() != count * numbers * sizeof(std::uint16_t))
        return Error{journal.path(), {}, "size", "that of all texels", fmt::format("{} bytes", bytes->size())};
    library.coefficient.resize(count * J), library.error.resize(count);
    std::vector<std::uint16_t> of(numbers);
    for (std::size_t t = 0; t < count; ++t) {
        std::memcpy(of.data(), bytes->data() + t * numbers * sizeof of[0], numbers * sizeof of[0]);
        for (std::size_t k = 0; k < 3 * J; ++k) library.coefficient[t * J + k / 3][int(k % 3)] = from_half(of[k]);
        library.error[t] = from_half(of[3 * J]);
    }
    return library;
}

/// The shared lobes: those that an earlier run has found for the same texels and options, or new ones.
Result<Library> texel_basis(const BasisFit& fit, const SharedPairs& pairs, const Texels& texels, ProgressLine& line) {
    const std::size_t M = pairs.wl.size(), spread = std::min(texels.count(), k_spread_texels);
    std::vector<Rgb> some(spread * M);
    for (std::size_t n = 0; n < spread; ++n)
        if (const auto read = texels.read(n * texels.count() / spread, std::span(some).subspan(n * M, M)); !read)
            return read.error();
    Hash hash;
    hash.add(std::as_bytes(std::span(some))), hash.add(std::as_bytes(std::span(pairs.wl)));
    hash.add(std::as_bytes(std::span(pairs.wv)));
    hash.add(as_bytes(fmt::format("{} {} {}", SRBF_VERSION, fit.key, texels.count())));
    const std::string path = fit.output + ".basis";
    if (const auto bytes = fit.resume ? read_file(path) : Result<std::vector<std::byte>>(Error{}); bytes)
        if (auto library = read_library(*bytes, path); library && library->provenance["key"] == hash.text())
            return library;
    auto library = fit_texel_basis(pairs, spanning_texels(some, M), fit.options,
                                   [&](const Progress& now) { return line.show(now.stage, now.fraction), true; });
    if (!library) return library;
    library->provenance = {{"generator", "srbf " SRBF_VERSION}, {"objective", "appearance"}, {"key", hash.text()}};
    std::error_code none;
    fs::remove(fit.output + ".part", none);
    if (const auto written = write_file(path, write_library(*library)); !written) return written.error();
    return library;
}

}  // namespace

int fit_texel_maps(const BasisFit& fit) {
    const auto read = load_pairs(fit.pairs);
    if (!read) return complain(read.error());
    const SharedPairs pairs{read->wl, read->wv, fit.options.axial};
    const std::size_t M = pairs.wl.size();
    const auto texels = Texels::open(fit.inputs[0], M);
    if (!texels) return complain(texels.error());
    if (fit.width > 0 && texels->count() % fit.width != 0)
        return complain({fit.inputs[0],
                         {},
                         "texels",
                         fmt::format("a multiple of the width, {}", fit.width),
                         fmt::format("{}", texels->count()),
                         ErrorCode::argument});
    const Stopwatch watch;
    ProgressLine line;
    auto basis = texel_basis(fit, pairs, *texels, line);
    if (!basis) return line.clear(), complain(basis.error());
    const double basis_seconds = watch.seconds();
    const std::size_t J = std::size_t(basis->basis.lobes);
    const Journal journal(fit.output + ".part", 3 * J + 1);
    const std::size_t kept = fit.resume ? journal.kept(fit.slab) : 0;
    std::error_code none;
    if (!fit.resume) fs::remove(journal.path(), none);
    std::vector<Rgb> f;
    for (std::size_t first = kept; first < texels->count(); first += fit.slab) {
        f.resize(std::min(fit.slab, texels->count() - first) * M);
        if (const auto done = texels->read(first, f); !done) return line.clear(), complain(done.error());
        const auto numbers = numbers_of(fit_texels_to_basis(*basis, pairs, f, fit.options.threads), J);
        if (const auto done = journal.add(numbers); !done) return line.clear(), complain(done.error());
        line.show("solving for coefficients", double(first) / double(texels->count()));
    }
    line.clear();
    const double seconds = watch.seconds() - basis_seconds;
    basis->names.clear(), basis->width = fit.width;
    auto library = whole_library(*std::move(basis), journal, texels->count());
    if (!library) return complain(library.error());
    const auto written = write_file(fit.output, write_library(*library));
    if (!written) return complain(written.error());
    fs::remove(journal.path(), none), fs::remove(fit.output + ".basis", none);
    double sum = 0;
    for (const float error : library->error) sum += double(error);
    fmt::print("{} texels of {} shared lobes, found in {:.1f} s; {} kept, the others in {:.1f} s, {:.4g} a second\n",
               grouped(texels->count()), J, basis_seconds, grouped(kept), seconds,
               double(texels->count() - kept) / std::max(seconds, 1e-9));
    fmt::print("  weighted RMS  mean {}\n  library       {}\n", percent(sum / double(texels->count())),
               printable(fit.output));
    return k_done;
}

}  // namespace srbf
