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
#include "base/half.h"
#include "base/printable.h"
#include "brdf/directions.h"
#include "extras/maps/app/journal.h"
#include "extras/maps/app/map.h"
#include "extras/maps/app/texels.h"
#include "measured/tables.h"
#include "srbf/basis.h"
#include "srbf/file.h"

namespace srbf {
namespace {

/// Number of texels in memory, and in a record of the journal.
constexpr std::size_t k_texels_per_record = 4096;
/// Number of candidates for the texels that span the set, and the number chosen from them.
constexpr std::size_t k_spread_texels = 1024, k_spanning_texels = 48;

/// The values of texels that span the set: each is the one farthest from those chosen before, by cube roots.
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

/// A record of the journal: for each texel its 3 J coefficients and its error.
std::vector<std::uint16_t> numbers_of(const TexelCoefficients& texels, std::size_t J) {
    std::vector<std::uint16_t> numbers;
    for (std::size_t t = 0; t < texels.error.size(); ++t) {
        for (std::size_t j = 0; j < J; ++j)
            for (int c = 0; c < 3; ++c) numbers.push_back(to_half(texels.coefficient[t * J + j][c]));
        numbers.push_back(to_half(texels.error[t]));
    }
    return numbers;
}

/// Appends the coefficients and errors of a record to the library. Errors: a record without a whole number of
/// texels.
Result<Done> add_texels(Library& library, std::span<const std::byte> record, const std::string& file_name) {
    const std::size_t J = std::size_t(library.basis.lobes);
    std::vector<std::uint16_t> numbers(3 * J + 1);
    const std::size_t bytes = numbers.size() * sizeof numbers[0];
    if (record.size() % bytes != 0)
        return Error{file_name, {}, "record", "whole texels", fmt::format("{} bytes", record.size())};
    for (; !record.empty(); record = record.subspan(bytes)) {
        std::memcpy(numbers.data(), record.data(), bytes);
        for (std::size_t j = 0; j < J; ++j)
            library.coefficient.push_back(
                {from_half(numbers[3 * j]), from_half(numbers[3 * j + 1]), from_half(numbers[3 * j + 2])});
        library.error.push_back(from_half(numbers[3 * J]));
    }
    return Done{};
}

/// The shared lobes, and the coefficients of the texels in which they were found.
Result<Library> texel_basis(const BasisOptions& options, const SharedPairs& pairs, const Texels& texels,
                            ProgressLine& line) {
    const std::size_t M = pairs.wl.size(), spread = std::min(texels.count(), k_spread_texels);
    std::vector<Rgb> candidates(spread * M);
    for (std::size_t n = 0; n < spread; ++n)
        if (const auto read = texels.read(n * texels.count() / spread, std::span(candidates).subspan(n * M, M)); !read)
            return read.error();
    auto library = fit_texel_basis(pairs, spanning_texels(candidates, M), options,
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
    Library library;
    std::size_t kept = 0;  // texels of an earlier run
    double basis_seconds = 0, seconds = 0;
};

/// Continues the work recorded in the journal.
Result<FittedMap> fit_rest(const MapCommand& fit, const SharedPairs& pairs, const Texels& texels, Journal& journal) {
    const BasisOptions options = map_options(fit);
    const std::string part = fit.output + ".part";
    const Stopwatch watch;
    ProgressLine line;
    const bool is_new = journal.kept.empty();
    const auto basis = is_new ? texel_basis(options, pairs, texels, line) : read_library(journal.kept[0], part);
    if (!basis) return basis.error();
    if (is_new)
        if (const auto added = journal.add(write_library(*basis)); !added) return added.error();
    FittedMap map{*basis, 0, watch.seconds(), 0};
    Library& library = map.library;
    library.names.clear(), library.width = fit.width, library.coefficient.clear(), library.error.clear();
    for (std::size_t n = 1; n < journal.kept.size(); ++n)
        if (const auto added = add_texels(library, journal.kept[n], part); !added) return added.error();
    map.kept = library.count();
    std::vector<Rgb> f;
    for (std::size_t first = map.kept; first < texels.count(); first += k_texels_per_record) {
        f.resize(std::min(k_texels_per_record, texels.count() - first) * pairs.wl.size());
        if (const auto done = texels.read(first, f); !done) return done.error();
        const auto numbers =
            numbers_of(fit_texels_to_basis(*basis, pairs, f, fit.request.threads), std::size_t(basis->basis.lobes));
        const auto record = std::as_bytes(std::span(numbers));
        if (const auto done = journal.add(record); !done) return done.error();
        if (const auto done = add_texels(library, record, fit.output); !done) return done.error();
        line.show("solving for coefficients", double(first) / double(texels.count()));
    }
    map.seconds = watch.seconds() - map.basis_seconds;
    return map;
}

void print_map(const MapCommand& fit, const FittedMap& map) {
    const std::size_t count = map.library.count();
    double sum = 0;
    for (const float error : map.library.error) sum += double(error);
    fmt::print("{} texels of {} shared lobes, found in {:.1f} s; {} kept, the others in {:.1f} s, {:.4g} a second\n",
               grouped(count), map.library.basis.lobes, map.basis_seconds, grouped(map.kept), map.seconds,
               double(count - map.kept) / std::max(map.seconds, 1e-9));
    fmt::print("  weighted RMS  mean {}\n  library       {}\n", percent(sum / double(count)), printable(fit.output));
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
    const auto written = write_file(fit.output, write_library(map->library));
    if (!written) return complain(written.error());
    journal->remove();
    print_map(fit, *map);
    return k_done;
}

}  // namespace srbf
