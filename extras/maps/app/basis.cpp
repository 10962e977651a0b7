// `srbf basis`: a library of materials that share their lobes.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <numeric>

#include "app/commands.h"
#include "app/extra_subcommands.h"
#include "app/fit_options.h"
#include "app/output.h"
#include "base/files.h"
#include "base/printable.h"
#include "base/text.h"
#include "brdf/directions.h"
#include "fit/request_traits.h"
#include "models/library_file.h"
#include "srbf/basis.h"
#include "srbf/file.h"
#include "srbf/npy.h"

namespace SRBF_NAMESPACE {
namespace {

namespace fs = std::filesystem;

struct BasisCommand {
    std::vector<std::string> inputs;
    std::string output, lobes = std::to_string(BasisOptions{}.lobes);  // a number, or the library whose lobes are used
    FitTexts texts;
    FitRequest request;         // the parsed texts
    int active = 0;             // 0: all lobes
    double target_delta_e = 0;  // 0: no target

    std::optional<int> count() const { return to_number<int>(lobes); }
    BasisOptions options() const {
        const auto& lobe = std::get<PmRequest>(request.model);
        return {.form = lobe.form.value_or(BasisOptions{}.form),
                .axial = lobe.axial.value_or(true),
                .lobes = count().value_or(BasisOptions{}.lobes),
                .variates = lobe.variates.value_or(BasisOptions{}.variates),
                .active = active,
                .max_theta = request.max_theta.value_or(0),
                .seed = request.seed,
                .threads = request.threads};
    }
};

/// Maximum number of materials in the report: those with the largest errors.
constexpr std::size_t k_most_listed_materials = 20;

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

/// Fits libraries with doubling numbers of lobes, up to that of the options. Returns the first whose mean error
/// reaches the target, or else the one with most lobes. `report` receives a line for each.
Result<Library> smallest_library(const BasisCommand& fit, std::span<const LibrarySource> sources,
                                 const ProgressToken& progress, std::string& report) {
    BasisOptions options = fit.options();
    const int max_lobes = options.lobes;
    for (int lobes = std::max(1, options.active);; lobes *= 2) {
        options.lobes = std::min(lobes, max_lobes);
        auto library = fit_library(sources, options, progress);
        if (!library) return library;
        const double error = mean_error(*library);
        const bool is_last = options.lobes == max_lobes;
        report += fmt::format("  {:>3} lobes     mean ΔE_ITP {:.3g}{}\n", options.lobes, error,
                              is_last && error > fit.target_delta_e ? ", above the target" : "");
        if (error <= fit.target_delta_e || is_last) return library;
    }
}

void print_library(const BasisCommand& fit, const Library& library, double seconds) {
    std::vector<std::size_t> order(library.count());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::ranges::stable_sort(order, std::greater<>(), [&](std::size_t t) { return library.error[t]; });
    fmt::print("{} materials of {} shared lobes, {} each, in {:.1f} s\n", library.count(), library.basis.lobes,
               library.dense() ? std::string("all of them") : fmt::format("at most {}", library.stored), seconds);
    fmt::print("  bytes         {} shared, {} a material\n", basis_bytes(library), material_bytes(library));
    fmt::print("  mean ΔE_ITP   {:.3g}\n", mean_error(library));
    const std::size_t listed_count = std::min(order.size(), k_most_listed_materials);
    for (std::size_t i = 0; i < listed_count; ++i)
        fmt::print("  {:<13} {:.3g}\n", printable(library.names[order[i]]), library.error[order[i]]);
    if (listed_count < order.size()) fmt::print("  .. and {} better ones\n", order.size() - listed_count);
    fmt::print("  library       {}\n", printable(fit.output));
}

int fit_basis(const BasisCommand& fit) {
    std::vector<LibrarySource> sources;
    for (const std::string& input : fit.inputs)
        sources.push_back({fs::path(input).stem().string(), [input] { return load_measured(input); }});
    const auto writable = check_outputs(fit.inputs, {fit.output});
    if (!writable) return complain(writable.error());
    const Stopwatch watch;
    ProgressLine line;
    const auto progress = [&](const Progress& now) { return line.show(now.stage, now.fraction), true; };
    Result<Library> library = Library{};
    std::string report;
    if (fit.target_delta_e > 0) {
        library = smallest_library(fit, sources, progress, report);
    } else if (fit.count()) {
        library = fit_library(sources, fit.options(), progress);
    } else {
        const auto basis = load_library(fit.lobes);
        if (!basis) return complain(basis.error());
        BasisOptions options = fit.options();
        if (options.active == 0 && !basis->dense()) options.active = basis->stored;
        library = fit_to_basis(*basis, sources, options, progress);
    }
    line.clear();
    if (!library) return complain(library.error());
    library->provenance = {{"generator", "srbf " SRBF_VERSION}, {"objective", "appearance"}};
    const std::vector<NewFile> files{{fit.output, write_library(*library)}};
    const auto written = write_files(files, [&]() -> Result<Done> {
        fmt::print("{}", report);
        print_library(fit, *library, watch.seconds());
        return flush_standard_output();
    });
    return written ? k_done : complain(written.error());
}

/// A number of lobes that can be shared, or the name of a library.
Check number_or_library() {
    return [](std::string& text) { return to_number<int>(text) ? within(1, k_most_basis_lobes)(text) : std::string(); };
}

}  // namespace

void add_basis(CommandLine& app, int& status) {
    const auto fit = std::make_shared<BasisCommand>();
    const Subcommand sub = app.add_subcommand("basis", "Fit lobes that many materials share, into one library");
    sub.add_option("INPUT", fit->inputs, "Tables of BRDFs. In the library they are LIBRARY#STEM")
        .type_name("")
        .required();
    sub.add_option("-o,--output", fit->output, "The library to write").type_name("LIBRARY").required();
    sub.add_option(
           "--lobes", fit->lobes,
           fmt::format("Number of shared lobes, 1 to {}; or an earlier library, whose lobes are used without a\n"
                       "search",
                       k_most_basis_lobes))
        .type_name("J|LIBRARY")
        .check(number_or_library())
        .capture_default_str();
    const Option active =
        sub.add_option("--active", fit->active, "Each material is a sum of at most K of the lobes; default: of all")
            .type_name("K")
            .check(within(1, k_most_basis_lobes));
    const Option target =
        sub.add_option("--target-delta-e", fit->target_delta_e,
                       "The fewest lobes, up to J, with at most this mean visible error of the materials: Delta E\n"
                       "(ITP) of pictures of a sphere, where 1 is just noticeable")
            .type_name("E")
            .check(within(k_finest_delta_e, k_most_delta_e));
    const OptionsByName options =
        add_fit_options(sub, fit->texts, {"form", "variates", "axial", "max_theta", "seed", "threads"});
    sub.footer(
        "Examples:\n  srbf basis materials/*.binary --lobes 32 --active 16 -o library.srbf\n"
        "  srbf basis new.binary --lobes library.srbf -o more.srbf");
    sub.callback(
        [sub, fit, &status] {
            fit->request = requested(sub, fit->texts);
            status = fit_basis(*fit);
        },
        {{{active},
          "at most the number of shared lobes",
          [fit] { return fit->active <= fit->count().value_or(k_most_basis_lobes); }},
         {{target, options.at("form"), options.at("variates"), options.at("axial")},
          "only with a number of lobes",
          [fit] { return fit->count().has_value(); }}});
}

}  // namespace srbf
