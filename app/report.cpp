#include "app/report.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>

#include "srbf/file.h"

namespace srbf {
namespace {

struct Measure {
    const char* name;
    const char* title;
    double Measures::*member;
    bool is_ratio;  // printed as per cent
};
constexpr Measure k_measures[] = {
    {"squared_error_ratio", "squared error ratio", &Measures::squared_error_ratio, true},
    {"squared_error_ratio_cosine", "  of f cosθl", &Measures::squared_error_ratio_cosine, true},
    {"log_rms_cosine", "RMS of log(1 + f cosθl)", &Measures::log_rms_cosine, false},
    {"cube_root_error_ratio", "cube root error ratio", &Measures::cube_root_error_ratio, true},
};

/// Pads by characters, where fmt would count an alias of θ's bytes.
std::string padded(std::string_view text, std::size_t width) {
    std::size_t characters = 0;
    for (const char c : text) characters += (c & 0xc0) != 0x80;
    return std::string(text) + std::string(width > characters ? width - characters : 0, ' ');
}

}  // namespace

std::vector<Comparison> compare(const Evaluate& reference, std::span<const Evaluate> others,
                                const MeasureOptions& options) {
    const auto matrix = measure_matrix(reference, others, options),
               heldout = measure_heldout(reference, others, options);
    std::vector<Comparison> comparisons;
    for (std::size_t k = 0; k < others.size(); ++k)
        comparisons.push_back({matrix[k], heldout[k], albedo_error(reference, others[k], options.max_theta)});
    return comparisons;
}

void add_measures(Json& json, const Comparison& comparison, std::string_view prefix) {
    for (const Measure& m : k_measures) json[fmt::format("{}{}", prefix, m.name)] = comparison.matrix.*m.member;
    for (const Measure& m : k_measures)
        json[fmt::format("{}heldout_{}", prefix, m.name)] = comparison.heldout.*m.member;
    json[fmt::format("{}albedo_error", prefix)] = comparison.albedo_error;
}

void print_measures(const std::vector<std::pair<std::string, const Comparison*>>& comparisons) {
    const auto text = [](const Measure& m, const Measures& measures) {
        return m.is_ratio ? percent(measures.*m.member) : fmt::format("{:.4g}", measures.*m.member);
    };
    std::string head = padded("", 26);
    for (const auto& [title, comparison] : comparisons) head += fmt::format("{:>26}", title);
    fmt::print("{}\n{}", head, padded("measure", 26));
    for (std::size_t k = 0; k < comparisons.size(); ++k) fmt::print("{:>13}{:>13}", "matrix", "held out");
    fmt::print("\n");
    for (const Measure& m : k_measures) {
        fmt::print("{}", padded(m.title, 26));
        for (const auto& [title, comparison] : comparisons)
            fmt::print("{:>13}{:>13}", text(m, comparison->matrix), text(m, comparison->heldout));
        fmt::print("\n");
    }
    fmt::print("{}", padded("albedo error, largest", 26));
    for (const auto& [title, comparison] : comparisons) fmt::print("{:>26}", percent(comparison->albedo_error));
    fmt::print("\n");
}

Result<Done> write_json(const Json& json, const std::string& path) {
    const std::string text = json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
    if (path != "-") return write_file(path, as_bytes(text));
    fmt::print("{}", text);
    return Done{};
}

Result<Done> check_output(const std::string& path) {
    namespace fs = std::filesystem;
    std::error_code ignored;
    if (fs::is_directory(path, ignored)) return Error{path, {}, "output", "a file's name", "a folder"};
    const fs::path folder = fs::path(path).parent_path();
    if (!folder.empty() && !fs::is_directory(folder, ignored))
        return Error{path, {}, "output", "a folder that exists", fmt::format("none at '{}'", folder.string())};
    if (access(folder.empty() ? "." : folder.c_str(), W_OK) != 0)
        return Error{path, {}, "output", "a folder that can be written", "one that cannot"};
    return Done{};
}

std::string grouped(std::uint64_t n) {
    std::string digits = std::to_string(n);
    for (int at = int(digits.size()) - 3; at > 0; at -= 3) digits.insert(std::size_t(at), 1, ',');
    return digits;
}

std::string percent(double ratio) { return fmt::format("{:.3g} %", 100 * ratio); }

void ProgressLine::show(std::string_view stage, double fraction) {
    const double now = watch_.seconds();
    if (now < 0.5 || now - shown_ < 0.1 || isatty(STDERR_FILENO) == 0) return;
    shown_ = now;
    visible_ = true;
    const double left = fraction > 0.01 ? now * (1 - fraction) / fraction : std::nan("");
    const std::string time = std::isfinite(left) ? fmt::format(", {:.0f} s left", std::ceil(left)) : "";
    fmt::print(stderr, "\r\033[K{:3.0f} %  {}{}", 100 * fraction, stage, time);
    std::fflush(stderr);
}

void ProgressLine::clear() {
    if (visible_) fmt::print(stderr, "\r\033[K");
    visible_ = false;
}

}  // namespace srbf
