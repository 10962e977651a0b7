// Common output of the subcommands: measures as tables and JSON, progress, durations.
#pragma once
#include <chrono>
#include <nlohmann/json.hpp>

#include "app/load.h"
#include "brdf/info_rows.h"
#include "errors/measures.h"
#include "models/kind/parameters.h"
#include "srbf/metrics.h"
#include "srbf/progress.h"

namespace srbf {

using Json = nlohmann::ordered_json;

/// The row of `k_measures` by which fits with this objective are judged.
const MeasureName& measure_named_for(Objective objective);
/// The printed value of a measure.
std::string text(const MeasureName& name, const Measures& measures);

/// Adds the measures of a comparison to `json`.
void add_measures(Json& json, const Comparison& comparison);
/// Errors of pictures: means, worst, and the errors under each lighting.
Json json_of(const Appearance& appearance);
Json json_of(const Parameter& parameter);

/// The errors of pictures by which a fit is judged, in its report; null if the report has none.
const Json* judged_pictures(const Json& report);

/// Picture errors of a table against itself with light and viewer exchanged; none if it is reciprocal or not a table.
std::optional<Appearance> reciprocity_errors(const AnyBrdf& brdf, int threads = 0);
/// "within ΔE_ITP 14.4 (worst 21.4) where light and viewer are exchanged"
std::string reciprocity_text(const Appearance& exchanged);

/// Prints a table of measures, with a column for each set of pairs.
void print_measures(const Comparison& comparison);

/// The bytes of a JSON file.
std::vector<std::byte> json_bytes(const Json& json);
/// Writes `json` to `path`; "-" is standard output, which is flushed.
Result<Done> write_json(const Json& json, const std::string& path);
/// The JSON in a file, if the file can be read and is complete.
std::optional<Json> read_json(const std::string& path);

/// The member of a report that holds the hash of its model's file.
inline constexpr const char* k_model_hash = "model_hash";
/// True if the file holds a readable model and `report` is its report.
bool is_report_of(const Json& report, const std::string& model_file);

/// Returns an error if one of `outputs` cannot be written: its folder is missing, it is a folder or an input, or it
/// is the same file as another output. Empty names are ignored. Call it before long computations.
Result<Done> check_outputs(const std::vector<std::string>& inputs, const std::vector<std::string>& outputs);
/// Makes a folder to write into, unless it exists. Returns an error if it cannot be made or written.
Result<Done> make_folder(const std::string& path);
/// `error` with the file that caused it.
inline Error with_source(Error error, const std::string& file) {
    error.source = file;
    return error;
}
/// Returns an error if standard output has not accepted everything that was printed (disk full).
Result<Done> flush_standard_output();

/// A ratio in percent with three digits: "0.741 %".
std::string percent(double ratio);

/// Measures the seconds since its construction.
class Stopwatch {
  public:
    double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

  private:
    using Clock = std::chrono::steady_clock;
    Clock::time_point start_ = Clock::now();
};

/// A progress line on standard error with the remaining time. It appears only on a terminal and after half a
/// second, truncated to the terminal's width. The destructor erases it.
class ProgressLine {
  public:
    ~ProgressLine() { clear(); }
    void show(std::string_view stage, double fraction);
    /// Shows the progress that a function of the library reports, as one stage if `stage` is given, and never cancels
    /// it. This object must outlive the function.
    auto shown_progress(std::string_view stage = {}) {
        return [this, stage](const Progress& now) {
            show(stage.empty() ? now.stage : stage, now.fraction);
            return true;
        };
    }
    void clear();

  private:
    Stopwatch watch_;
    std::string stage_;
    double shown_ = 0;
    bool visible_ = false;
};

}  // namespace srbf
