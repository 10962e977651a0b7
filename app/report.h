// What several subcommands print: measures as tables and JSON, progress, durations.
#pragma once
#include <array>
#include <chrono>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "app/load.h"
#include "srbf/fit.h"
#include "srbf/metrics.h"

namespace srbf {

using Json = nlohmann::ordered_json;

/// The measure of `k_measures` that an objective is judged by.
const MeasureName& measure_named_for(Objective objective);
/// A measure's value as it is printed.
std::string text(const MeasureName& name, const Measures& measures);

/// Adds measures to `json`, their names after `prefix`: "", "unrounded_", "samples_"; of a comparison all of them.
void add_measures(Json& json, const Measures& measures, std::string_view prefix);
void add_measures(Json& json, const Comparison& comparison, std::string_view prefix);

/// A table of measures, a column for each set of each comparison.
void print_measures(const std::vector<std::pair<std::string, const Comparison*>>& comparisons);

/// Writes `json` to `path`; "-" is standard output, flushed.
Result<Done> write_json(const Json& json, const std::string& path);

/// What a model is made of, in lines as `srbf info` has them.
std::string parameters_text(const Model& model);

/// An error where one of `outputs` cannot be written: its folder is missing, it is a folder itself, an input or
/// the same file as another output. An empty name is no output. Asked before the work, so that an hour is not
/// lost to a misspelt name; the write itself may still fail.
Result<Done> check_outputs(const std::vector<std::string>& inputs, const std::vector<std::string>& outputs);
/// An error where standard output has not taken all that was printed: its disk is full.
Result<Done> flush_standard_output();

/// "1,234,567".
std::string grouped(std::uint64_t n);
/// "0.741 %", three digits.
std::string percent(double ratio);

/// Seconds since it was made.
class Stopwatch {
  public:
    double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

  private:
    using Clock = std::chrono::steady_clock;
    Clock::time_point start_ = Clock::now();
};

/// A line on standard error that tells how far the work is and the time left; only on a terminal, and only
/// after the first half second; cut off where the terminal ends. Gone when it is destroyed.
class ProgressLine {
  public:
    ~ProgressLine() { clear(); }
    void show(std::string_view stage, double fraction);
    void clear();

  private:
    Stopwatch watch_;
    std::string stage_;
    double shown_ = 0;
    bool visible_ = false;
};

}  // namespace srbf
