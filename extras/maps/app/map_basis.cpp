// `srbf map --basis`: texels that share their lobes, in one library.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "app/commands.h"
#include "app/hash.h"
#include "app/output.h"
#include "app/pairs.h"
#include "base/files.h"
#include "base/half.h"
#include "base/printable.h"
#include "brdf/directions.h"
#include "brdf/values.h"
#include "extras/maps/app/journal.h"
#include "extras/maps/app/map.h"
#include "extras/maps/app/spanning_texels.h"
#include "extras/maps/app/texels.h"
#include "measured/tables.h"
#include "models/library_file.h"
#include "srbf/basis.h"
#include "srbf/file.h"

namespace SRBF_NAMESPACE {
namespace {

/// Number of values in memory, and of texels whose coefficients are in a record of the journal, at least 64.
constexpr std::size_t k_values_per_record = std::size_t(1) << 22;
std::size_t texels_per_record(std::size_t pairs) {
    constexpr std::size_t multiple = 64;
    return std::max(k_values_per_record / pairs / multiple, std::size_t(1)) * multiple;
}
/// Number of texels in which lobes are found.
constexpr std::size_t k_spanning_texels = 48;

/// The beginning of a record of the journal.
struct RecordHead {
    std::uint64_t texels, left_out, black, failed;  ///< left_out: values
    double error;                                   ///< sum of the texels' errors
};
/// A record of the journal: its head, and the texels' errors and coefficients as 16-bit floats.
std::vector<std::byte> record_of(const TexelCoefficients& texels) {
    RecordHead head{texels.error.size(), 0, 0, 0, 0};
    std::vector<std::uint16_t> numbers;
    for (std::size_t t = 0; t < texels.error.size(); ++t) {
        head.left_out += texels.left_out[t];
        head.black += texels.state[t] == TexelState::black, head.failed += texels.state[t] == TexelState::failed;
        head.error += double(texels.error[t]);
        numbers.push_back(to_half(std::min(texels.error[t], k_half_max)));
    }
    for (const Rgb& beta : texels.coefficient)
        for (int c = 0; c < 3; ++c) numbers.push_back(to_half(beta[c]));
    std::vector<std::byte> record(sizeof head + 2 * numbers.size());
    std::memcpy(record.data(), &head, sizeof head);
    std::memcpy(record.data() + sizeof head, numbers.data(), 2 * numbers.size());
    return record;
}

/// The shared lobes, and the coefficients of the texels in which they were found.
Result<Library> texel_basis(const BasisOptions& options, const SharedPairs& pairs, const Texels& texels,
                            ProgressLine& line) {
    const auto spanning = spanning_values(texels, pairs, k_spanning_texels);
    if (!spanning) return spanning.error();
    auto library = fit_texel_basis(pairs, *spanning, options,
                                   [&](const Progress& now) { return line.show(now.stage, now.fraction), true; });
    if (library) library->provenance = {{"generator", "srbf " SRBF_VERSION}, {"objective", "appearance"}};
    return library;
}

BasisOptions map_options(const MapCommand& fit) {
    return {.form = fit.lobe().form.value_or(BasisOptions{}.form),
            .axial = fit.lobe().axial.value_or(true),
            .lobes = fit.basis,
            .variates = fit.lobe().variates.value_or(BasisOptions{}.variates),
            .active = 0,
            .max_theta = fit.request.max_theta.value_or(0),
            .seed = fit.request.seed,
            .threads = fit.request.threads};
}

struct FittedMap {
    Library library;       // the shared lobes, without texels
    RecordHead total{};    // over all records
    std::size_t kept = 0;  // texels of an earlier run
    double basis_seconds = 0, seconds = 0;

    void add(const RecordHead& head) {
        total.texels += head.texels, total.left_out += head.left_out;
        total.black += head.black, total.failed += head.failed, total.error += head.error;
    }
};

Result<RecordHead> head_of(const Journal& journal, const Journal::Record& record, std::size_t J) {
    RecordHead head{};
    const auto bytes = journal.read(record, 0, std::min<std::size_t>(record.size, sizeof head));
    if (!bytes) return bytes.error();
    std::memcpy(&head, bytes->data(), bytes->size());
    if (record.size < sizeof head || record.size != sizeof head + 2 * head.texels * (1 + 3 * J))
        return Error{"journal", record.offset, "record", "whole texels", fmt::format("{} bytes", record.size)};
    return head;
}

/// Continues the work recorded in the journal.
Result<FittedMap> fit_rest(const MapCommand& fit, const SharedPairs& pairs, const Texels& texels, Journal& journal) {
    const Stopwatch watch;
    ProgressLine line;
    if (journal.records().empty()) {
        const auto basis = texel_basis(map_options(fit), pairs, texels, line);
        if (!basis) return basis.error();
        if (const auto added = journal.add(write_library(*basis)); !added) return added.error();
    }
    const auto bytes = journal.read(journal.records()[0]);
    if (!bytes) return bytes.error();
    const auto basis = read_library(*bytes, fit.output + ".part");
    if (!basis) return basis.error();
    FittedMap map{*basis, {}, 0, watch.seconds(), 0};
    map.library.names.clear(), map.library.width = fit.width;
    map.library.coefficient.clear(), map.library.error.clear();
    for (const Journal::Record& record : std::span(journal.records()).subspan(1)) {
        const auto head = head_of(journal, record, std::size_t(basis->basis.lobes));
        if (!head) return head.error();
        map.add(*head);
    }
    map.kept = map.total.texels;
    line.clear();
    ProgressLine texel_line;
    std::vector<Rgb> f;
    const std::size_t most = texels_per_record(pairs.wl.size());
    for (std::size_t first = map.kept; first < texels.count(); first += most) {
        f.resize(std::min(most, texels.count() - first) * pairs.wl.size());
        if (const auto done = texels.read(first, f); !done) return done.error();
        const auto record = record_of(fit_texels_to_basis(*basis, pairs, f, fit.request.threads));
        if (const auto done = journal.add(record); !done) return done.error();
        RecordHead head;
        std::memcpy(&head, record.data(), sizeof head);
        map.add(head);
        texel_line.show("solving for coefficients",
                        double(map.total.texels - map.kept) / double(texels.count() - map.kept));
    }
    map.seconds = watch.seconds() - map.basis_seconds;
    return map;
}

/// Writes the library of the journal's records, of which one at a time is in memory.
Result<Done> write_map(const std::string& path, const FittedMap& map, const Journal& journal) {
    const auto records = std::span(journal.records()).subspan(1);
    const std::size_t texel_bytes = 2 * (1 + 3 * std::size_t(map.library.basis.lobes));
    LibraryParts parts = parts_of_library(map.library, map.total.texels);
    std::size_t step = 0;  // head, errors of each record, middle, coefficients of each record, tail
    return write_file(path, [&]() -> Result<std::vector<std::byte>> {
        const std::size_t n = step++, count_of_records = records.size();
        if (n == 0) return std::move(parts.head);
        if (n == count_of_records + 1) return std::move(parts.middle);
        if (n == 2 * count_of_records + 2) return std::move(parts.tail);
        if (n > 2 * count_of_records + 2) return std::vector<std::byte>();
        const bool is_error = n <= count_of_records;
        const Journal::Record& record = records[is_error ? n - 1 : n - count_of_records - 2];
        const std::size_t count = (record.size - sizeof(RecordHead)) / texel_bytes;
        return is_error ? journal.read(record, sizeof(RecordHead), 2 * count)
                        : journal.read(record, sizeof(RecordHead) + 2 * count, (texel_bytes - 2) * count);
    });
}

void print_map(const MapCommand& fit, const FittedMap& map) {
    const RecordHead& total = map.total;
    fmt::print("{} texels of {} shared lobes, found in {:.1f} s; {} kept, the others in {:.1f} s, {:.4g} a second\n",
               grouped(total.texels), map.library.basis.lobes, map.basis_seconds, grouped(map.kept), map.seconds,
               double(total.texels - map.kept) / std::max(map.seconds, 1e-9));
    fmt::print("  {} black, {} failed; {} values left out\n", grouped(total.black), grouped(total.failed),
               grouped(total.left_out));
    fmt::print("  weighted RMS  mean {}\n  library       {}\n", percent(total.error / double(total.texels)),
               printable(fit.output));
}

}  // namespace

int fit_map(const MapCommand& fit) {
    const auto read = load_pairs(fit.pairs);
    if (!read) return complain(read.error());
    const SharedPairs pairs{read->wl, read->wv, fit.lobe().axial.value_or(true)};
    const auto texels = Texels::open(fit.texels, pairs.wl.size());
    if (!texels) return complain(texels.error());
    if (fit.width > 0 && texels->count() % fit.width != 0)
        return complain({fit.texels,
                         {},
                         "texels",
                         fmt::format("a multiple of the width, {}", fit.width),
                         fmt::format("{}", texels->count()),
                         ErrorCode::argument});
    if (const auto writable = check_outputs({fit.texels, fit.pairs}, {fit.output}); !writable)
        return complain(writable.error());
    ResultKey key("map", fit.settings);
    for (const std::string& input : {fit.pairs, fit.texels})
        if (const auto added = key.add_file(input); !added) return complain(added.error());
    auto journal = Journal::open(fit.output, key.text(), fit.resume);
    if (!journal) return complain(journal.error());
    const auto map = fit_rest(fit, pairs, *texels, *journal);
    if (!map) return complain(map.error());
    const auto written = write_map(fit.output, *map, *journal);
    if (!written) return complain(written.error());
    journal->remove();
    print_map(fit, *map);
    if (!texels->note().empty()) fmt::print(stderr, "srbf: {}: {}\n", printable(fit.texels), texels->note());
    return k_done;
}

}  // namespace srbf
