// `srbf fit` of many files into a folder.

#include <cmath>
#include <map>
#include <numeric>
#include <thread>

#include "app/commands.h"
#include "app/fit.h"
#include "app/hash.h"
#include "app/jobs.h"
#include "base/files.h"
#include "base/paths.h"
#include "base/printable.h"
#include "measured/readers.h"
#include "srbf/file.h"

namespace srbf {
namespace {

std::string in_folder(const std::string& folder, const std::string& name) {
    return system_files::path_text(system_files::path_of(folder) / system_files::path_of(name));
}

constexpr double k_none = std::numeric_limits<double>::quiet_NaN();

/// The numbers in the summary row of a fit. A report that lacks one of them is incomplete. A BSDF's report has only
/// the largest error of its parts, weighted by both cosines like the image error.
struct SummaryRow {
    std::size_t bytes = 0;
    double image_error = 0, raw_error = k_none, delta_e = k_none, seconds = 0;
};
std::optional<SummaryRow> summary_row_of(const Json& report) {
    const auto number = [](const Json& object, const char* key) {
        const auto member = object.find(key);
        return member != object.end() && member->is_number() ? std::optional(member->get<double>()) : std::nullopt;
    };
    if (!report.is_object()) return {};
    if (const auto parts = report.find("parts"); parts != report.end() && parts->is_array()) {
        const auto bytes = number(report, "payload_bytes"), seconds = number(report, "fit_seconds");
        if (!bytes || !seconds) return {};
        SummaryRow row{.bytes = std::size_t(*bytes), .seconds = *seconds};
        for (const Json& part : *parts) {
            const auto error = part.is_object() ? number(part, "squared_error_ratio") : std::nullopt;
            if (!error) return {};
            row.image_error = std::max(row.image_error, *error);
        }
        return row;
    }
    const Json* pictures = judged_pictures(report);
    if (pictures == nullptr) return {};
    // A fit to samples has errors at them and in cross-validation; the worse one counts.
    const auto error = [&](const std::string& name) {
        const auto heldout = number(report, ("heldout_" + name).c_str());
        return number(report, "samples") ? std::max(heldout, number(report, name.c_str())) : heldout;
    };
    const auto bytes = number(report, "payload_bytes"), seconds = number(report, "fit_seconds"),
               image = error("squared_error_ratio_cosine"), raw = error("squared_error_ratio"),
               delta_e = number(*pictures, "delta_e_itp");
    if (!bytes || !seconds || !image || !raw || !delta_e) return {};
    return SummaryRow{std::size_t(*bytes), *image, *raw, *delta_e, *seconds};
}

enum class FitState { waiting, fitted, kept, failed };
struct FolderFile {
    std::string name;
    FitJob fit;
    FitState state = FitState::waiting;
    SummaryRow row;     ///< row of the table, if there is a model
    std::string error;  ///< message, if the fit failed
};

/// Fits one file, unless an earlier result can be kept. A result is kept if its report belongs to the model and the
/// report's key, a hash of the file's content, the options and the program's version, is the same.
Result<FitState> fit_one(FolderFile& file, const FolderJob& folder, const ProgressToken& progress) {
    ResultKey result_key("model", folder.settings);
    result_key.add(system_files::path_text(system_files::path_of(file.fit.input).filename()));
    if (const auto bytes = read_input(file.fit.input, file.fit.read))
        result_key.add(*bytes);
    else
        return bytes.error();
    const std::string key = result_key.text();
    if (folder.resume)
        if (const auto report = read_json(file.fit.json))
            if (const auto row = summary_row_of(*report); row && report->value("key", Json()) == key)
                if (is_report_of(*report, file.fit.output)) {
                    file.row = *row;
                    return FitState::kept;
                }

    const auto measured = load_for_fit(file.fit);
    if (!measured) return measured.error();
    const auto keep = [&](const auto& outcome) -> Result<FitState> {
        if (!outcome) return outcome.error();
        Json report = report_of(file.fit, *measured, *outcome);
        report["key"] = key;
        const NewFile files[] = {{file.fit.output, write_model(outcome->model)}, {file.fit.json, json_bytes(report)}};
        if (const auto written = write_files(files); !written) return written.error();
        file.row = summary_row_of(report).value_or(SummaryRow{});
        return FitState::fitted;
    };
    if (std::holds_alternative<BsdfTable>(measured->table))
        return keep(fit_bsdf(*measured, file.fit.request, progress));
    return keep(fit(*measured, file.fit.request, progress));
}

void print_row(const FolderFile& file) {
    if (file.state == FitState::failed) {
        fmt::print(stderr, "srbf: {}\n", file.error);
        return;
    }
    const bool both_sides = std::isnan(file.row.raw_error);
    fmt::print("{:<32}{:>10}{:>14}{:>14}{:>10}{:>10}\n", printable(file.name), file.row.bytes,
               percent(file.row.image_error), both_sides ? "-" : percent(file.row.raw_error),
               both_sides ? "-" : fmt::format("{:.3g}", file.row.delta_e),
               file.state == FitState::kept ? "kept" : fmt::format("{:.2f}", file.row.seconds));
}

void print_summary(const FolderJob& folder, const std::vector<FolderFile>& materials, double seconds) {
    const auto count = [&](FitState state) { return std::ranges::count(materials, state, &FolderFile::state); };
    const auto summary = [&](const char* title, double SummaryRow::*member, std::string (*formatted)(double)) {
        std::vector<double> sorted;
        for (const FolderFile& material : materials)
            if (material.state != FitState::failed && !std::isnan(material.row.*member))
                sorted.push_back(material.row.*member);
        if (sorted.empty()) return;
        std::ranges::sort(sorted);
        const auto quantile = [&](double fraction) {
            return formatted(sorted[std::size_t(std::ceil(fraction * double(sorted.size()))) - 1]);
        };
        const double mean = std::accumulate(sorted.begin(), sorted.end(), 0.0) / double(sorted.size());
        fmt::print("  {:<14}mean {}, median {}, 95 % {}\n", title, formatted(mean), quantile(0.5), quantile(0.95));
    };
    fmt::print("\n");
    summary("image error", &SummaryRow::image_error, percent);
    summary("raw error", &SummaryRow::raw_error, percent);
    summary("Delta E", &SummaryRow::delta_e, [](double error) { return fmt::format("{:.3g}", error); });
    fmt::print("  {} fitted in {:.1f} s, {:.3g} a second; {} kept; {} failed\n", count(FitState::fitted), seconds,
               double(count(FitState::fitted)) / seconds, count(FitState::kept), count(FitState::failed));
    fmt::print("  models        {}\n", printable(folder.folder));
}

}  // namespace

int fit_files(const FolderJob& folder) {
    if (const auto made = make_folder(folder.folder); !made) return complain(made.error());

    std::vector<FolderFile> materials;
    std::map<std::string, std::string> input_of;
    for (const std::string& input : folder.inputs) {
        FolderFile material;
        material.name = system_files::stem(input);
        material.fit = folder.common;
        material.fit.input = input;
        material.fit.files = {input};
        material.fit.output = in_folder(folder.folder, material.name + ".srbf");
        material.fit.json = in_folder(folder.folder, material.name + ".json");
        if (const auto [earlier, is_new] = input_of.try_emplace(material.name, input); !is_new) {
            material.state = FitState::failed;
            material.error = message({input, {}, "model", "a name of its own", "that of " + earlier->second});
        } else if (const auto free = check_outputs({input}, {material.fit.output, material.fit.json}); !free) {
            material.state = FitState::failed;
            material.error = message(free.error());
        }
        materials.push_back(std::move(material));
    }
    // While there are enough fits, each runs on one thread.
    const int cores = folder.common.request.threads > 0 ? folder.common.request.threads
                                                        : int(std::max(std::thread::hardware_concurrency(), 1u));
    const int jobs = jobs_within_memory(std::min(std::size_t(cores), materials.size()));
    for (FolderFile& material : materials) material.fit.request.threads = std::max(cores / jobs, 1);

    const Stopwatch watch;
    ProgressLine line;
    JobProgress shown(materials.size(), line);
    std::size_t printed = 0;
    fmt::print("{:<32}{:>10}{:>14}{:>14}{:>10}{:>10}\n", "material", "bytes", "image error", "raw error", "Delta E",
               "seconds");
    in_jobs(materials.size(), jobs, [&](std::size_t i) {
        FolderFile material = materials[i];
        if (material.state == FitState::waiting) {
            const auto show = [&](const Progress& now) {
                shown.show(i, fmt::format("{} of {}, {}: {}", i + 1, materials.size(), material.name, now.stage),
                           now.fraction);
                return true;
            };
            const auto outcome = within_memory(material.fit.input, [&] { return fit_one(material, folder, show); });
            material.state = outcome ? *outcome : FitState::failed;
            if (!outcome) material.error = message(outcome.error());
        }
        shown.show(i, material.name, 1);
        shown.print([&] {
            materials[i] = std::move(material);
            for (; printed < materials.size(); ++printed) {
                if (materials[printed].state == FitState::waiting) break;
                print_row(materials[printed]);
            }
            std::fflush(stdout);
        });
    });
    print_summary(folder, materials, watch.seconds());
    if (const auto written = flush_standard_output(); !written) return complain(written.error());
    return std::ranges::count(materials, FitState::failed, &FolderFile::state) > 0 ? k_input_error : k_done;
}

}  // namespace srbf
