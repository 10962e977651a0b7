// `srbf fit --pairs`: the texels of a file of arrays.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <map>

#include "app/commands.h"
#include "app/fit.h"
#include "app/hash.h"
#include "app/journal.h"
#include "app/pairs.h"
#include "srbf/basis.h"
#include "srbf/file.h"
#include "srbf/fit_batch.h"
#include "srbf/half.h"
#include "srbf/npy.h"
#include "srbf/printable.h"
#include "srbf/text.h"

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

constexpr char k_hash[] = "hash";

/// The file of a stack with the hash of the file without it.
std::vector<std::byte> write_hashed(ModelStack stack) {
    stack.provenance[k_hash] = hash_of(write_stack(stack));
    return write_stack(stack);
}

/// A stack that an earlier run made of the same values by the same options; none if it is missing or has changed.
std::optional<ModelStack> done_before(const std::string& path, const std::string& key, std::size_t count) {
    const auto bytes = read_file(path);
    if (!bytes) return {};
    auto stack = read_stack(*bytes, path);
    if (!stack || stack->models.size() != count || stack->provenance["key"] != key) return {};
    ModelStack without = *stack;
    without.provenance.erase(k_hash);
    if (write_hashed(std::move(without)) != *bytes) return {};
    return *std::move(stack);
}

/// Slabs in the folder that are of another division of the texels, or of more of them than there are: readers would take
/// them for slabs of this file.
Result<Done> check_slabs(const TexelFits& fit, const std::string& stem, std::size_t texels, std::size_t end) {
    std::map<std::size_t, std::string> slabs;  // by their first texel
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(fit.folder, none)) {
        const std::string name = entry.path().stem().string();
        if (entry.path().extension() != ".srbf" || !name.starts_with(stem + "-")) continue;
        if (const auto first = to_number<std::size_t>(std::string_view(name).substr(stem.size() + 1)))
            slabs[*first] = entry.path().string();
    }
    const auto refused = [](const std::string& path, std::string expected) {
        return Error{path,
                     {},
                     "slab",
                     std::move(expected),
                     "one of another --slab or another file; delete it or write to another folder"};
    };
    for (const auto& [first, path] : slabs) {
        const bool is_within = first >= fit.begin && first < end && (first - fit.begin) % fit.slab != 0;
        if (is_within || first >= texels) return refused(path, "none that begins at this texel");
    }
    std::vector<std::size_t> bounds{fit.begin};
    if (end < texels) bounds.insert(bounds.end(), {end, texels});  // otherwise the last slab is replaced
    for (const std::size_t bound : bounds) {
        const auto after = slabs.lower_bound(bound);
        if (after == slabs.begin()) continue;
        const auto& [first, path] = *std::prev(after);
        const auto bytes = read_file(path);
        if (!bytes) continue;
        const auto stack = read_stack(*bytes, path);
        if (stack && first + stack->models.size() > bound)
            return refused(path, fmt::format("none across texel {}", bound));
    }
    return Done{};
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
    const std::size_t end = fit.end > 0 ? fit.end : texels->count();
    if (const auto alike = check_slabs(fit, stem, texels->count(), end); !alike) return complain(alike.error());
    const auto name_of = [&](std::size_t first) {
        return (fs::path(fit.folder) / fmt::format("{}-{:09}.srbf", stem, first)).string();
    };
    ResultKey of_all("slab", fit.settings);
    of_all.add(std::as_bytes(std::span(pairs->wl))), of_all.add(std::as_bytes(std::span(pairs->wv)));
    of_all.add(fs::path(fit.input).filename().string());
    const auto key_of = [&](std::size_t first, std::span<const Rgb> f) {
        ResultKey key = of_all;
        key.add(std::to_string(first));
        key.add(std::as_bytes(f));
        return key.text();
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
    TexelStream stream{fit.begin, end, fit.slab, {}, {}, {}};
    std::string key;  // of the slab that was read last
    stream.read = [&](std::size_t first, std::span<Rgb> f) {
        auto read = texels->read(first, f);
        key = key_of(first, f);
        return read;
    };
    stream.is_done = [&](std::size_t first, std::size_t count) {
        std::error_code none;
        if (!fit.resume || !fs::exists(name_of(first), none)) return false;
        std::vector<Rgb> f(count * pairs->wl.size());
        if (!texels->read(first, f)) return false;
        const auto stack = done_before(name_of(first), key_of(first, f), count);
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
        return write_file(name_of(first), write_hashed(std::move(stack)));
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

/// A record of the journal: of each texel its 3 J coefficients and its error.
std::vector<std::uint16_t> numbers_of(const TexelCoefficients& of, std::size_t J) {
    std::vector<std::uint16_t> numbers;
    for (std::size_t t = 0; t < of.error.size(); ++t) {
        for (std::size_t j = 0; j < J; ++j)
            for (int c = 0; c < 3; ++c) numbers.push_back(to_half(of.coefficient[t * J + j][c]));
        numbers.push_back(to_half(of.error[t]));
    }
    return numbers;
}

/// Appends the coefficients and errors of a record to the library. Errors: it has no whole number of texels.
Result<Done> add_texels(Library& library, std::span<const std::byte> record, const std::string& file_name) {
    const std::size_t J = std::size_t(library.basis.lobes);
    std::vector<std::uint16_t> of(3 * J + 1);
    const std::size_t bytes = of.size() * sizeof of[0];
    if (record.size() % bytes != 0)
        return Error{file_name, {}, "record", "whole texels", fmt::format("{} bytes", record.size())};
    for (; !record.empty(); record = record.subspan(bytes)) {
        std::memcpy(of.data(), record.data(), bytes);
        for (std::size_t j = 0; j < J; ++j)
            library.coefficient.push_back({from_half(of[3 * j]), from_half(of[3 * j + 1]), from_half(of[3 * j + 2])});
        library.error.push_back(from_half(of[3 * J]));
    }
    return Done{};
}

/// The shared lobes, and the coefficients of the texels in which they were found.
Result<Library> texel_basis(const BasisFit& fit, const SharedPairs& pairs, const Texels& texels, ProgressLine& line) {
    const std::size_t M = pairs.wl.size(), spread = std::min(texels.count(), k_spread_texels);
    std::vector<Rgb> some(spread * M);
    for (std::size_t n = 0; n < spread; ++n)
        if (const auto read = texels.read(n * texels.count() / spread, std::span(some).subspan(n * M, M)); !read)
            return read.error();
    auto library = fit_texel_basis(pairs, spanning_texels(some, M), fit.options,
                                   [&](const Progress& now) { return line.show(now.stage, now.fraction), true; });
    if (library) library->provenance = {{"generator", "srbf " SRBF_VERSION}, {"objective", "appearance"}};
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
    if (const auto writable = check_outputs({fit.inputs[0], fit.pairs}, {fit.output}); !writable)
        return complain(writable.error());
    ResultKey key("map", fit.settings);
    for (const std::string& input : {fit.pairs, fit.inputs[0]})
        if (const auto added = key.add_file(input); !added) return complain(added.error());
    auto journal = Journal::open(fit.output, key.text(), fit.resume);
    if (!journal) return complain(journal.error());

    const Stopwatch watch;
    ProgressLine line;
    auto basis = journal->kept.empty() ? texel_basis(fit, pairs, *texels, line)
                                       : read_library(journal->kept[0], fit.output + ".part");
    if (!basis) return line.clear(), complain(basis.error());
    if (journal->kept.empty())
        if (const auto added = journal->add(write_library(*basis)); !added)
            return line.clear(), complain(added.error());
    const double basis_seconds = watch.seconds();
    Library library = *basis;
    library.names.clear(), library.width = fit.width, library.coefficient.clear(), library.error.clear();
    for (std::size_t n = 1; n < journal->kept.size(); ++n)
        if (const auto added = add_texels(library, journal->kept[n], fit.output + ".part"); !added)
            return line.clear(), complain(added.error());
    const std::size_t J = std::size_t(basis->basis.lobes), kept = library.count();
    std::vector<Rgb> f;
    for (std::size_t first = kept; first < texels->count(); first += fit.slab) {
        f.resize(std::min(fit.slab, texels->count() - first) * M);
        if (const auto done = texels->read(first, f); !done) return line.clear(), complain(done.error());
        const auto numbers = numbers_of(fit_texels_to_basis(*basis, pairs, f, fit.options.threads), J);
        const auto record = std::as_bytes(std::span(numbers));
        if (const auto done = journal->add(record); !done) return line.clear(), complain(done.error());
        if (const auto done = add_texels(library, record, fit.output); !done)
            return line.clear(), complain(done.error());
        line.show("solving for coefficients", double(first) / double(texels->count()));
    }
    line.clear();
    const double seconds = watch.seconds() - basis_seconds;
    const auto written = write_file(fit.output, write_library(library));
    if (!written) return complain(written.error());
    journal->remove();
    double sum = 0;
    for (const float error : library.error) sum += double(error);
    fmt::print("{} texels of {} shared lobes, found in {:.1f} s; {} kept, the others in {:.1f} s, {:.4g} a second\n",
               grouped(texels->count()), J, basis_seconds, grouped(kept), seconds,
               double(texels->count() - kept) / std::max(seconds, 1e-9));
    fmt::print("  weighted RMS  mean {}\n  library       {}\n", percent(sum / double(texels->count())),
               printable(fit.output));
    return k_done;
}

}  // namespace srbf
