// `srbf map`: texels with lobes of their own, in stacks of models.
#include <fmt/format.h>

#include <filesystem>
#include <map>

#include "app/commands.h"
#include "app/hash.h"
#include "app/output.h"
#include "app/pairs.h"
#include "base/printable.h"
#include "base/text.h"
#include "brdf/directions.h"
#include "extras/maps/app/map.h"
#include "extras/maps/app/spanning_texels.h"
#include "extras/maps/app/texels.h"
#include "fit/texel_stream.h"
#include "srbf/file.h"

namespace SRBF_NAMESPACE {
namespace {

namespace fs = std::filesystem;

/// Counts over the slabs, for the summary.
struct SlabSummary {
    std::size_t fitted = 0, black = 0, failed = 0, kept = 0;
    double error = 0;  ///< sum over fitted and kept texels
    std::string first_failure;
};

constexpr char k_hash[] = "hash";

/// The file of a stack, including the hash of the file without the hash.
std::vector<std::byte> write_hashed(ModelStack stack) {
    stack.provenance[k_hash] = hash_of(write_stack(stack));
    return write_stack(stack);
}

/// A stack that an earlier run made from the same values with the same options; no value if it is missing or
/// changed.
std::optional<ModelStack> read_finished(const std::string& path, const std::string& key, std::size_t count) {
    const auto bytes = read_file(path);
    if (!bytes) return {};
    auto stack = read_stack(*bytes, path);
    if (!stack || stack->models.size() != count || stack->provenance["key"] != key) return {};
    ModelStack unhashed = *stack;
    unhashed.provenance.erase(k_hash);
    if (write_hashed(std::move(unhashed)) != *bytes) return {};
    return *std::move(stack);
}

/// Errors: slabs in the folder that divide the texels differently, or have more texels than the file. Readers would
/// mistake them for slabs of this file.
Result<Done> check_slabs(const MapCommand& fit, const std::string& stem, std::size_t texels, std::size_t end) {
    std::map<std::size_t, std::string> slabs;  // by their first texel
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(fit.output, ignored)) {
        const std::string name = entry.path().stem().string();
        if (entry.path().extension() != ".srbf" || !name.starts_with(stem + "-")) continue;
        if (const auto first = to_number<std::size_t>(std::string_view(name).substr(stem.size() + 1)))
            slabs[*first] = entry.path().string();
    }
    const auto refuse = [](const std::string& path, std::string expected) {
        return Error{path,
                     {},
                     "slab",
                     std::move(expected),
                     "one of another --slab or another file; delete it or write to another folder"};
    };
    for (const auto& [first, path] : slabs) {
        const bool is_within = first >= fit.first && first < end && (first - fit.first) % fit.slab != 0;
        if (is_within || first >= texels) return refuse(path, "none that begins at this texel");
    }
    std::vector<std::size_t> bounds{fit.first};
    if (end < texels) bounds.insert(bounds.end(), {end, texels});  // otherwise the last slab is replaced
    for (const std::size_t bound : bounds) {
        const auto after = slabs.lower_bound(bound);
        if (after == slabs.begin()) continue;
        const auto& [first, path] = *std::prev(after);
        const auto bytes = read_file(path);
        if (!bytes) continue;
        const auto stack = read_stack(*bytes, path);
        if (stack && first + stack->models.size() > bound)
            return refuse(path, fmt::format("none across texel {}", bound));
    }
    return Done{};
}

/// The files of slabs. Reads texels, and writes the fits of a slab with the key of everything on which they depend.
class Slabs {
  public:
    Slabs(const MapCommand& fit, const Pairs& pairs, const Texels& texels, std::span<const PmModel> examples)
        : fit_(fit), pairs_(pairs), texels_(texels), common_key_("slab", fit.settings) {
        for (const PmModel& example : examples) common_key_.add(write_model({example, {}}));
        common_key_.add(std::as_bytes(std::span(pairs.wl))), common_key_.add(std::as_bytes(std::span(pairs.wv)));
        common_key_.add(source());
    }
    std::string stem() const { return fs::path(fit_.texels).stem().string(); }
    Result<Done> read(std::size_t first, std::span<Rgb> f) {
        auto read = texels_.read(first, f);
        key_ = key_of(first, f);
        return read;
    }
    bool is_done(std::size_t first, std::size_t count) {
        std::error_code ignored;
        if (!fit_.resume || !fs::exists(name_of(first), ignored)) return false;
        std::vector<Rgb> f(count * pairs_.wl.size());
        if (!texels_.read(first, f)) return false;
        const auto stack = read_finished(name_of(first), key_of(first, f), count);
        if (!stack) return false;
        summary.kept += stack->models.size();
        for (const float error : stack->error) summary.error += double(error);
        return true;
    }
    Result<Done> take(std::size_t first, std::span<const TexelFit> fits) {
        const Objective objective = fit_.request.objective;
        ModelStack stack;
        for (const TexelFit& texel : fits) {
            stack.models.push_back(texel.model);
            const bool fitted = texel.state == TexelState::fitted;
            stack.error.push_back(fitted ? float(error_of(texel.errors, objective)) : 0.f);
            stack.state.push_back(std::uint16_t(texel.state));
            summary.fitted += fitted, summary.black += texel.state == TexelState::black;
            summary.failed += texel.state == TexelState::failed;
            summary.error += double(stack.error.back());
            if (texel.failure && summary.first_failure.empty()) summary.first_failure = message(*texel.failure);
        }
        stack.provenance = {{"generator", "srbf " SRBF_VERSION},
                            {"source", source()},
                            {"first", std::to_string(first)},
                            {"objective", std::string(name(objective))},
                            {"key", key_}};
        return write_file(name_of(first), write_hashed(std::move(stack)));
    }

    SlabSummary summary;

  private:
    std::string source() const { return fs::path(fit_.texels).filename().string(); }
    std::string name_of(std::size_t first) const {
        return (fs::path(fit_.output) / fmt::format("{}-{:09}.srbf", stem(), first)).string();
    }
    std::string key_of(std::size_t first, std::span<const Rgb> f) const {
        ResultKey key = common_key_;
        key.add(std::to_string(first));
        key.add(std::as_bytes(f));
        return key.text();
    }

    const MapCommand& fit_;
    const Pairs& pairs_;
    const Texels& texels_;
    ResultKey common_key_;
    std::string key_;  // key of the slab that was read last
};

/// Fits of texels that span the map, by searches.
Result<std::vector<PmModel>> searched_examples(const MapCommand& fit, const SharedPairs& pairs, const Texels& texels,
                                               const ProgressToken& progress) {
    const auto spanning = spanning_values(texels, pairs, fit.examples);
    if (!spanning) return spanning.error();
    BatchOptions options;
    options.request = fit.request;
    const auto fits = fit_batch(pairs, *spanning, options, progress);
    if (!fits) return fits.error();
    std::vector<PmModel> models;
    for (const TexelFit& texel : *fits) models.push_back(texel.model);
    return models;
}

int print_slabs(const MapCommand& fit, const SlabSummary& summary, const std::string& note, double seconds) {
    const double count = double(summary.fitted + summary.kept);
    fmt::print("  {} texels fitted in {:.1f} s, {:.3g} a second; {} kept, {} black, {} failed\n",
               grouped(summary.fitted), seconds, double(summary.fitted) / seconds, grouped(summary.kept),
               grouped(summary.black), grouped(summary.failed));
    if (count > 0)
        fmt::print("  {}: mean {}\n", measure_named_for(fit.request.objective).title, percent(summary.error / count));
    fmt::print("  models        {}\n", printable(fit.output));
    if (!note.empty()) fmt::print(stderr, "srbf: {}: {}\n", printable(fit.texels), note);
    if (summary.failed > 0) fmt::print(stderr, "srbf: {} texels: {}\n", summary.failed, summary.first_failure);
    if (const auto written = flush_standard_output(); !written) return complain(written.error());
    return summary.failed > 0 ? k_input_error : k_done;
}

}  // namespace

int fit_slabs(const MapCommand& fit) {
    const auto pairs = load_pairs(fit.pairs);
    if (!pairs) return complain(pairs.error());
    const auto texels = Texels::open(fit.texels, pairs->wl.size());
    if (!texels) return complain(texels.error());
    if (fit.first >= texels->count() || fit.last > texels->count())
        return complain({fit.texels,
                         {},
                         "texels",
                         fmt::format("a range of 0:{}", texels->count()),
                         fmt::format("{}:{}", fit.first, fit.last),
                         ErrorCode::argument});
    if (const auto folder = make_folder(fit.output); !folder) return complain(folder.error());

    const Stopwatch watch;
    ProgressLine line;
    const ProgressToken show = [&](const Progress& now) { return line.show(now.stage, now.fraction), true; };
    const SharedPairs shared{pairs->wl, pairs->wv, fit.lobe().axial.value_or(true)};
    BatchOptions options;
    options.request = fit.request;
    if (fit.examples > 0) {
        auto examples = searched_examples(fit, shared, *texels, show);
        if (!examples) return complain(examples.error());
        options.examples = *std::move(examples);
    }
    Slabs slabs(fit, *pairs, *texels, options.examples);
    const std::size_t end = fit.last > 0 ? fit.last : texels->count();
    if (const auto alike = check_slabs(fit, slabs.stem(), texels->count(), end); !alike) return complain(alike.error());
    TexelStream stream{fit.first, end, fit.slab, {}, {}, {}};
    stream.read = [&](std::size_t first, std::span<Rgb> f) { return slabs.read(first, f); };
    stream.is_done = [&](std::size_t first, std::size_t count) { return slabs.is_done(first, count); };
    stream.take = [&](std::size_t first, std::span<const TexelFit> fits) { return slabs.take(first, fits); };

    const auto done = fit_batch(shared, stream, options, show);
    line.clear();
    if (!done) return complain(done.error());
    return print_slabs(fit, slabs.summary, texels->note(), watch.seconds());
}

}  // namespace srbf
