// `srbf fit` of many files into a folder.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <numeric>
#include <thread>

#include "app/commands.h"
#include "app/fit.h"
#include "app/hash.h"
#include "app/jobs.h"
#include "base/printable.h"
#include "srbf/file.h"

namespace srbf {
namespace {

namespace fs = std::filesystem;

constexpr double k_none = std::numeric_limits<double>::quiet_NaN();

/// The numbers of a fit's line, which are kept. A report without one of them is not whole; of a BSDF there is
/// the largest error of a part alone, which is weighted by both cosines like that of images.
struct Line {
    std::size_t bytes = 0;
    double image_error = 0, raw_error = k_none, delta_e = k_none, seconds = 0;
};
std::optional<Line> line_of(const Json& report) {
    const auto number = [](const Json& of, const char* key) {
        const auto at = of.find(key);
        return at != of.end() && at->is_number() ? std::optional(at->get<double>()) : std::nullopt;
    };
    if (!report.is_object()) return {};
    if (const auto parts = report.find("parts"); parts != report.end() && parts->is_array()) {
        const auto bytes = number(report, "payload_bytes"), seconds = number(report, "fit_seconds");
        if (!bytes || !seconds) return {};
        Line line{.bytes = std::size_t(*bytes), .seconds = *seconds};
        for (const Json& part : *parts) {
            const auto error = part.is_object() ? number(part, "squared_error_ratio") : std::nullopt;
            if (!error) return {};
            line.image_error = std::max(line.image_error, *error);
        }
        return line;
    }
    const Json* pictures = judged_pictures(report);
    if (pictures == nullptr) return {};
    const auto bytes = number(report, "payload_bytes"), seconds = number(report, "fit_seconds"),
               image = number(report, "heldout_squared_error_ratio_cosine"),
               raw = number(report, "heldout_squared_error_ratio"), delta_e = number(*pictures, "delta_e_itp");
    if (!bytes || !seconds || !image || !raw || !delta_e) return {};
    return Line{std::size_t(*bytes), *image, *raw, *delta_e, *seconds};
}

enum class State { waiting, fitted, kept, failed };
struct FileOfMany {
    std::string name;
    FileFit fit;
    State state = State::waiting;
    Line line;          ///< of a model
    std::string error;  ///< of a failure
};

/// Fits one file, or finds that it is done: its report is that of the model, and the report's key covers the file's
/// content, the options and the program's version.
Result<State> fit_one(FileOfMany& of, const FolderFit& all, const ProgressToken& progress) {
    ResultKey of_model("model", all.settings);
    of_model.add(fs::path(of.fit.input).filename().string());
    if (const auto bytes = read_input(of.fit.input, of.fit.read))
        of_model.add(*bytes);
    else
        return bytes.error();
    const std::string key = of_model.text();
    if (all.resume)
        if (const auto report = read_json(of.fit.json))
            if (const auto line = line_of(*report); line && report->value("key", Json()) == key)
                if (is_report_of(*report, of.fit.output)) return of.line = *line, State::kept;

    const auto measured = load_measured(of.fit);
    if (!measured) return measured.error();
    const auto keep = [&](const auto& outcome) -> Result<State> {
        if (!outcome) return outcome.error();
        Json report = report_of(of.fit, *measured, *outcome);
        report["key"] = key;
        const NewFile files[] = {{of.fit.output, write_model(outcome->model)}, {of.fit.json, json_bytes(report)}};
        if (const auto written = write_files(files); !written) return written.error();
        of.line = line_of(report).value_or(Line{});
        return State::fitted;
    };
    if (std::holds_alternative<BsdfTable>(measured->table)) return keep(fit_bsdf(*measured, of.fit.request, progress));
    return keep(fit(*measured, of.fit.request, progress));
}

void print_line(const FileOfMany& of) {
    if (of.state == State::failed) {
        fmt::print(stderr, "srbf: {}\n", of.error);
        return;
    }
    const bool both_sides = std::isnan(of.line.raw_error);
    fmt::print("{:<32}{:>10}{:>14}{:>14}{:>10}{:>10}\n", printable(of.name), of.line.bytes,
               percent(of.line.image_error), both_sides ? "-" : percent(of.line.raw_error),
               both_sides ? "-" : fmt::format("{:.3g}", of.line.delta_e),
               of.state == State::kept ? "kept" : fmt::format("{:.2f}", of.line.seconds));
}

void print_summary(const FolderFit& all, const std::vector<FileOfMany>& materials, double seconds) {
    const auto count = [&](State state) { return std::ranges::count(materials, state, &FileOfMany::state); };
    const auto summary = [&](const char* title, double Line::*member, bool is_ratio) {
        std::vector<double> sorted;
        for (const FileOfMany& of : materials)
            if (of.state != State::failed && !std::isnan(of.line.*member)) sorted.push_back(of.line.*member);
        if (sorted.empty()) return;
        std::ranges::sort(sorted);
        const auto shown = [&](double x) { return is_ratio ? percent(x) : fmt::format("{:.3g}", x); };
        const auto at = [&](double share) {
            return shown(sorted[std::size_t(std::ceil(share * double(sorted.size()))) - 1]);
        };
        const double mean = std::accumulate(sorted.begin(), sorted.end(), 0.0) / double(sorted.size());
        fmt::print("  {:<14}mean {}, median {}, 95 % {}\n", title, shown(mean), at(0.5), at(0.95));
    };
    fmt::print("\n");
    summary("image error", &Line::image_error, true);
    summary("raw error", &Line::raw_error, true);
    summary("Delta E", &Line::delta_e, false);
    fmt::print("  {} fitted in {:.1f} s, {:.3g} a second; {} kept; {} failed\n", count(State::fitted), seconds,
               double(count(State::fitted)) / seconds, count(State::kept), count(State::failed));
    fmt::print("  models        {}\n", printable(all.folder));
}

}  // namespace

int fit_files(const FolderFit& all) {
    if (const auto made = make_folder(all.folder); !made) return complain(made.error());

    std::vector<FileOfMany> materials;
    std::map<std::string, std::string> input_of;
    for (const std::string& input : all.inputs) {
        FileOfMany of;
        of.name = fs::path(input).stem().string();
        of.fit = all.each;
        of.fit.input = input;
        of.fit.output = (fs::path(all.folder) / (of.name + ".srbf")).string();
        of.fit.json = (fs::path(all.folder) / (of.name + ".json")).string();
        if (const auto [at, is_new] = input_of.try_emplace(of.name, input); !is_new)
            of.state = State::failed,
            of.error = message({input, {}, "model", "a name of its own", "that of " + at->second});
        else if (const auto free = check_outputs({input}, {of.fit.output, of.fit.json}); !free)
            of.state = State::failed, of.error = message(free.error());
        materials.push_back(std::move(of));
    }
    // Fits of one thread each, side by side, as long as there are enough of them.
    const int cores = all.each.request.threads > 0 ? all.each.request.threads
                                                   : int(std::max(std::thread::hardware_concurrency(), 1u));
    const int jobs = jobs_within_memory(std::min(std::size_t(cores), materials.size()));
    for (FileOfMany& of : materials) of.fit.request.threads = std::max(cores / jobs, 1);

    const Stopwatch watch;
    ProgressLine line;
    Board board(materials.size(), line);
    std::size_t printed = 0;
    fmt::print("{:<32}{:>10}{:>14}{:>14}{:>10}{:>10}\n", "material", "bytes", "image error", "raw error", "Delta E",
               "seconds");
    in_jobs(materials.size(), jobs, [&](std::size_t i) {
        FileOfMany of = materials[i];
        if (of.state == State::waiting) {
            const auto show = [&](const Progress& now) {
                board.show(i, fmt::format("{} of {}, {}: {}", i + 1, materials.size(), of.name, now.stage),
                           now.fraction);
                return true;
            };
            const auto done = within_memory(of.fit.input, [&] { return fit_one(of, all, show); });
            of.state = done ? *done : State::failed;
            if (!done) of.error = message(done.error());
        }
        board.show(i, of.name, 1);
        board.print([&] {
            materials[i] = std::move(of);
            for (; printed < materials.size(); ++printed) {
                if (materials[printed].state == State::waiting) break;
                print_line(materials[printed]);
            }
            std::fflush(stdout);
        });
    });
    print_summary(all, materials, watch.seconds());
    if (const auto written = flush_standard_output(); !written) return complain(written.error());
    return std::ranges::count(materials, State::failed, &FileOfMany::state) > 0 ? k_input_error : k_done;
}

}  // namespace srbf
