#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <set>

#include "base/errors.h"
#include "base/floating_point.h"
#include "base/half.h"
#include "base/parallel.h"
#include "base/reporter.h"
#include "errors/picture_errors.h"
#include "extras/maps/material_coefficients.h"
#include "extras/maps/shared_lobes.h"
#include "models/library_file.h"
#include "models/pm/solve/rounding.h"
#include "srbf/basis.h"

namespace SRBF_NAMESPACE {
namespace {

/// The observations of this many tables are kept in memory, 8 MB each; those of further tables are made again.
constexpr std::size_t k_kept_tables = 64;

Error basis_error(const char* what, std::string expected, std::string found) {
    return argument_error("fit_library", what, std::move(expected), std::move(found));
}

Result<Done> check_names(std::span<const LibrarySource> sources) {
    std::set<std::string_view> names;
    if (sources.empty()) return basis_error("materials", "at least 1", "0");
    for (const LibrarySource& source : sources)
        if (!names.insert(source.name).second || source.name.empty() || source.name.find('\n') != std::string::npos)
            return basis_error("names of materials", "one for each, without line breaks", source.name);
    return Done{};
}

Result<Measured> table_of(const LibrarySource& source) {
    auto measured = source.read();
    if (!measured) return measured;
    if (std::holds_alternative<ScatteredSamples>(measured->table) || std::holds_alternative<BsdfTable>(measured->table))
        return Error{
            source.name,          {}, "input", "a table of one side", "samples, or reflection and transmission",
            ErrorCode::wrong_kind};
    return measured;
}

/// The observations of tables. Those of the first `kept` tables are made only once.
class ObservedTables {
  public:
    ObservedTables(std::span<const LibrarySource> sources, const BasisOptions& options, std::size_t kept)
        : sources_(sources), options_(options), kept_(std::min(sources.size(), kept)) {}

    /// May be called from any thread, but only by one at a time for each t.
    Result<std::shared_ptr<const Observations>> at(std::size_t t) {
        if (t < kept_.size() && kept_[t]) return kept_[t];
        const auto measured = table_of(sources_[t]);
        if (!measured) return measured.error();
        auto observed = observe(signed_evaluator(*measured),
                                {.max_theta = options_.max_theta, .seed = options_.seed, .threads = 1});
        if (!observed) return observed.error();
        auto shared = std::make_shared<const Observations>(*std::move(observed));
        if (t < kept_.size()) kept_[t] = shared;
        return shared;
    }

  private:
    std::span<const LibrarySource> sources_;
    const BasisOptions& options_;
    std::vector<std::shared_ptr<const Observations>> kept_;
};

/// Fits the sources' coefficients for these lobes, and computes their errors. `scaled`: keep the log scales of
/// `basis`.
Result<Library> library_of(PmModel basis, bool is_scaled, std::span<const LibrarySource> sources,
                           ObservedTables& tables, const BasisOptions& options, Reporter& reporter) {
    const LobeShape shape = shape_of(lobe_options(options));
    const Lobes lobes = to_lobes(basis, shape);
    std::vector<LogCoefficients> coefficients(sources.size());
    std::vector<std::optional<Error>> errors(sources.size());
    parallel_for(sources.size(), options.threads, [&](std::size_t t) {
        if (reporter.cancelled()) return;
        const auto observations = tables.at(t);
        if (!observations) return void(errors[t] = observations.error());
        coefficients[t] = coefficients_of(**observations, lobes, options);
        reporter.advance("solving for coefficients", 0.5);
    });
    for (const auto& error : errors)
        if (error) return *error;
    if (reporter.cancelled()) return cancelled_error("fit_library");
    Library library;
    library.basis = std::move(basis);
    if (!is_scaled) set_scales(library.basis, coefficients);
    library.stored = options.active > 0 ? options.active : library.basis.lobes;
    for (const LogCoefficients& material : coefficients) add_material(library, material);
    for (const LibrarySource& source : sources) library.names.push_back(source.name);
    library.error.assign(sources.size(), 0.f);
    library = rounded(std::move(library));
    parallel_for(sources.size(), options.threads, [&](std::size_t t) {
        const auto measured = table_of(sources[t]);
        if (!measured) return void(errors[t] = measured.error());
        const Model model = material(library, t);
        const Evaluate fitted = evaluator(model);
        const auto errors_of_pictures = compare_pictures(evaluator(*measured), {&fitted, 1}, 1);
        library.error[t] = round_to_half(float(std::min(errors_of_pictures[0].mean.delta_e, double(k_half_max))));
        reporter.advance("measuring errors", 0.5);
    });
    for (const auto& error : errors)
        if (error) return *error;
    return library;
}

}  // namespace

Result<Library> fit_library(std::span<const LibrarySource> sources, const BasisOptions& options,
                            const ProgressToken& progress) {
    const StandardArithmetic mode;
    if (const auto valid = check_basis_options(options); !valid) return valid.error();
    if (const auto valid = check_names(sources); !valid) return valid.error();
    Reporter reporter(progress, double(options.lobes) + 3 * double(sources.size()));
    ObservedTables tables(sources, options, k_kept_tables);
    std::vector<SharedRows> rows(sources.size());
    std::vector<std::optional<Error>> errors(sources.size());
    parallel_for(sources.size(), options.threads, [&](std::size_t t) {
        if (reporter.cancelled()) return;
        const auto observations = tables.at(t);
        if (!observations) return void(errors[t] = observations.error());
        rows[t] = rows_for_search(**observations);
        reporter.advance("observing", 1);
    });
    for (const auto& error : errors)
        if (error) return *error;
    if (reporter.cancelled()) return cancelled_error("fit_library");
    const auto observations = [&](std::size_t t) {
        const auto observed = tables.at(t);
        return observed ? *observed : nullptr;
    };
    PmModel basis = find_shared_lobes(rows, observations, options, reporter);
    if (reporter.cancelled()) return cancelled_error("fit_library");
    rows.clear();
    return library_of(std::move(basis), false, sources, tables, options, reporter);
}

Result<Library> fit_to_basis(const Library& basis, std::span<const LibrarySource> sources, const BasisOptions& options,
                             const ProgressToken& progress) {
    const StandardArithmetic mode;
    BasisOptions lobe_settings = options;
    lobe_settings.form = basis.basis.form, lobe_settings.axial = basis.basis.axial,
    lobe_settings.lobes = basis.basis.lobes;
    lobe_settings.variates = basis.basis.variates;
    if (const auto valid = check_basis_options(lobe_settings); !valid) return valid.error();
    if (const auto valid = check_names(sources); !valid) return valid.error();
    Reporter reporter(progress, double(sources.size()));
    ObservedTables tables(sources, lobe_settings, 0);
    return library_of(basis.basis, true, sources, tables, lobe_settings, reporter);
}

}  // namespace srbf
