// `srbf fit --pairs`: the texels of a file of arrays.
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <filesystem>

#include "app/commands.h"
#include "app/fit.h"
#include "app/hash.h"
#include "app/pairs.h"
#include "srbf/file.h"
#include "srbf/fit_batch.h"
#include "srbf/npy.h"

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
    const auto csv = read_file(fit.pairs);
    if (!csv) return complain(csv.error());
    const auto pairs = read_pairs(std::string_view(reinterpret_cast<const char*>(csv->data()), csv->size()), fit.pairs);
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
    of_all.add(*csv);
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
    fmt::print("  models        {}\n", fit.folder);
    if (summary.failed > 0) fmt::print(stderr, "srbf: {} texels: {}\n", summary.failed, summary.first_failure);
    if (const auto written = flush_standard_output(); !written) return complain(written.error());
    return summary.failed > 0 ? k_input_error : k_done;
}

}  // namespace srbf
