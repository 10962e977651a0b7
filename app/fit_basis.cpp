// `srbf fit --basis`: a library of materials that share their lobes.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <numeric>

#include "app/commands.h"
#include "app/fit.h"
#include "srbf/basis.h"
#include "srbf/file.h"
#include "srbf/npy.h"
#include "srbf/printable.h"

namespace srbf {
namespace {

namespace fs = std::filesystem;

/// How many materials the report lists, those with the largest errors.
constexpr std::size_t k_most_listed = 20;

Result<Library> load_library(const std::string& path) {
    return within_memory(path, [&]() -> Result<Library> {
        const auto bytes = read_file(path, all_if(is_safetensors));
        if (!bytes) return bytes.error();
        return read_library(*bytes, path);
    });
}

double mean_error(const Library& library) {
    return std::accumulate(library.error.begin(), library.error.end(), 0.0) / double(library.count());
}

/// The library with the fewest lobes, of numbers that double up to the options', whose mean error reaches the target, or else
/// that of most lobes; `tried` receives a line for each.
Result<Library> smallest_library(const BasisFit& fit, std::span<const LibrarySource> sources,
                                 const ProgressToken& progress, std::string& tried) {
    BasisOptions options = fit.options;
    for (int lobes = std::max(1, options.active);; lobes *= 2) {
        options.lobes = std::min(lobes, fit.options.lobes);
        auto library = fit_library(sources, options, progress);
        if (!library) return library;
        const double error = mean_error(*library);
        const bool is_last = options.lobes == fit.options.lobes;
        tried += fmt::format("  {:>3} lobes     mean ΔE_ITP {:.3g}{}\n", options.lobes, error,
                             is_last && error > fit.target_delta_e ? ", above the target" : "");
        if (error <= fit.target_delta_e || is_last) return library;
    }
}

void print_library(const BasisFit& fit, const Library& library, double seconds) {
    std::vector<std::size_t> order(library.count());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::ranges::stable_sort(order, std::greater<>(), [&](std::size_t t) { return library.error[t]; });
    fmt::print("{} materials of {} shared lobes, {} each, in {:.1f} s\n", library.count(), library.basis.lobes,
               library.dense() ? std::string("all of them") : fmt::format("at most {}", library.stored), seconds);
    fmt::print("  bytes         {} shared, {} a material\n", basis_bytes(library), material_bytes(library));
    fmt::print("  mean ΔE_ITP   {:.3g}\n", mean_error(library));
    const std::size_t listed = std::min(order.size(), k_most_listed);
    for (std::size_t i = 0; i < listed; ++i)
        fmt::print("  {:<13} {:.3g}\n", printable(library.names[order[i]]), library.error[order[i]]);
    if (listed < order.size()) fmt::print("  .. and {} better ones\n", order.size() - listed);
    fmt::print("  library       {}\n", printable(fit.output));
}

}  // namespace

int fit_basis(const BasisFit& fit) {
    std::vector<LibrarySource> sources;
    for (const std::string& input : fit.inputs)
        sources.push_back({fs::path(input).stem().string(), [input] { return load_measured(input); }});
    const auto writable = check_outputs(fit.inputs, {fit.output});
    if (!writable) return complain(writable.error());
    const Stopwatch watch;
    ProgressLine line;
    const auto progress = [&](const Progress& now) { return line.show(now.stage, now.fraction), true; };
    Result<Library> library = Library{};
    std::string tried;
    if (fit.target_delta_e > 0) {
        library = smallest_library(fit, sources, progress, tried);
    } else if (fit.basis.empty()) {
        library = fit_library(sources, fit.options, progress);
    } else {
        const auto basis = load_library(fit.basis);
        if (!basis) return complain(basis.error());
        BasisOptions options = fit.options;
        if (options.active == 0 && !basis->dense()) options.active = basis->stored;
        library = fit_to_basis(*basis, sources, options, progress);
    }
    line.clear();
    if (!library) return complain(library.error());
    library->provenance = {{"generator", "srbf " SRBF_VERSION}, {"objective", "appearance"}};
    const std::vector<NewFile> files{{fit.output, write_library(*library)}};
    const auto written = write_files(files, [&]() -> Result<Done> {
        fmt::print("{}", tried);
        print_library(fit, *library, watch.seconds());
        return flush_standard_output();
    });
    return written ? k_done : complain(written.error());
}

}  // namespace srbf
