#include "app/output.h"

#include <cmath>
#include <filesystem>
#include <system_error>

#include "app/hash.h"
#include "base/files.h"
#include "base/printable.h"
#include "base/system_files.h"
#include "base/text.h"
#include "errors/picture_errors.h"
#include "srbf/file.h"

namespace srbf {
namespace {

namespace fs = std::filesystem;

/// True if two names refer to the same file, whether it exists or not. A device or a pipe may be named twice.
bool is_same_file(const std::string& first, const std::string& second) {
    const fs::path a = system_files::path_of(first), b = system_files::path_of(second);
    std::error_code ignored;
    if (fs::is_other(a, ignored)) return false;
    return fs::equivalent(a, b, ignored) || fs::weakly_canonical(fs::absolute(a, ignored), ignored) ==
                                                fs::weakly_canonical(fs::absolute(b, ignored), ignored);
}

Result<Done> check_output(const std::string& path) {
    const auto refused = [&](std::string expected, std::string found) {
        return Error{path, {}, "output", std::move(expected), std::move(found)};
    };
    std::error_code code;
    const fs::file_type type = fs::status(system_files::path_of(path), code).type();
    if (type == fs::file_type::none) return refused("a file's name", code.message());
    if (type == fs::file_type::directory) return refused("a file's name", "a folder");
    if (path == "-") return refused("a file's name, or /dev/stdout", "-");
    if (type != fs::file_type::not_found && !system_files::is_writable(path))
        return refused("a writable file", "one without write permission");
    // A device or a pipe is written directly.
    if (type != fs::file_type::not_found && type != fs::file_type::regular) return Done{};
    const fs::path folder = fs::weakly_canonical(fs::absolute(system_files::path_of(path), code), code).parent_path();
    if (!fs::is_directory(folder, code))
        return refused("a folder that exists", fmt::format("no '{}'", system_files::path_text(folder)));
    if (!system_files::is_writable(system_files::path_text(folder)))
        return refused("a writable folder", "one without write permission");
    return Done{};
}

}  // namespace

void print_measures(const Comparison& comparison) {
    const auto print_row = [](std::string_view title, std::string_view left, std::string_view right) {
        fmt::print("{:<26}{:>13}{:>13}\n", title, left, right);
    };
    print_row("measure", "matrix", "held out");
    for (const MeasureName& m : k_measures) print_row(m.title, text(m, comparison.matrix), text(m, comparison.heldout));
    print_row("albedo error, largest", "", percent(comparison.albedo_error));
    fmt::print("\n");
    print_row("pictures of a sphere", "mean", "worst light");
    const Appearance& appearance = comparison.appearance;
    for (const PictureErrorName& e : k_picture_errors)
        print_row(e.title, fmt::format("{:.3g}", appearance.mean.*e.member),
                  e.member == &PictureErrors::delta_e ? fmt::format("{:.3g}", appearance.worst_delta_e) : "");
    if (const auto& heldout = comparison.heldout_appearance)
        fmt::print("{:<26}{:>13.3g}{:>13.3g}\n", "ΔE_ITP, held out", heldout->mean.delta_e, heldout->worst_delta_e);
}

const Json* judged_pictures(const Json& report) {
    for (const char* name : {"judged_pictures", "pictures"})
        if (const auto entry = report.find(name); entry != report.end() && entry->is_object()) return &*entry;
    return nullptr;
}

std::vector<std::byte> json_bytes(const Json& json) {
    const std::string text = printable_json(json.dump(2, ' ', false, Json::error_handler_t::replace)) + "\n";
    const auto bytes = as_bytes(text);
    return {bytes.begin(), bytes.end()};
}

Result<Done> write_json(const Json& json, const std::string& path) {
    const std::vector<std::byte> bytes = json_bytes(json);
    if (path != "-") return write_file(path, bytes);
    fmt::print("{}", as_text(bytes));
    return flush_standard_output();
}

std::optional<Json> read_json(const std::string& path) {
    // Far above any report. Parsed JSON takes up to forty times the memory of its text.
    static constexpr std::uint64_t k_max_bytes = std::uint64_t(1) << 24;
    constexpr int k_max_depth = 16;
    const auto bytes = read_file(path, [](auto) { return k_max_bytes; });
    if (!bytes || bytes->size() > k_max_bytes) return {};
    bool too_deep = false;
    const auto is_shallow = [&](int depth, Json::parse_event_t, const Json&) {
        too_deep = too_deep || depth > k_max_depth;
        return !too_deep;
    };
    const std::string_view text = as_text(*bytes);
    Json json = Json::parse(text.begin(), text.end(), is_shallow, false);
    if (too_deep || json.is_discarded()) return {};
    return json;
}

bool is_report_of(const Json& report, const std::string& model_file) {
    const auto bytes = read_file(model_file);
    if (!bytes || !report.is_object() || !read_model(*bytes, model_file)) return false;
    const auto hash = report.find(k_model_hash);
    return hash != report.end() && *hash == hash_of(*bytes);
}

Result<Done> check_outputs(const std::vector<std::string>& inputs, const std::vector<std::string>& outputs) {
    for (auto path = outputs.begin(); path != outputs.end(); ++path) {
        if (path->empty()) continue;
        const auto is_same = [&](const std::string& other) { return !other.empty() && is_same_file(*path, other); };
        if (const auto writable = check_output(*path); !writable) return writable.error();
        if (std::any_of(inputs.begin(), inputs.end(), is_same))
            return Error{*path, {}, "output", "another file than the input", "the input"};
        if (std::any_of(outputs.begin(), path, is_same))
            return Error{*path, {}, "output", "a file for each output", "the same file twice"};
    }
    return Done{};
}

Result<Done> make_folder(const std::string& path) {
    std::error_code code;
    const fs::path folder = system_files::path_of(path);
    fs::create_directories(folder, code);
    if (std::error_code none; !fs::is_directory(folder, none)) {
        const std::string found = fs::exists(folder, none) || !code ? "something else" : code.message();
        return Error{path, {}, "output", "a folder, or a new name", found};
    }
    if (!system_files::is_writable(path))
        return Error{path, {}, "output", "a writable folder", "one without write permission"};
    return Done{};
}

Result<Done> flush_standard_output() {
    if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return Done{};
    return Error{"standard output", {}, "cannot be written", {}, std::generic_category().message(errno)};
}

void ProgressLine::show(std::string_view stage, double fraction) {
    constexpr double k_delay = 0.5, k_interval = 0.1, k_min_estimated_fraction = 0.01;  // the first two in seconds
    const double now = watch_.seconds();
    if (now < k_delay || (now - shown_ < k_interval && stage == stage_) || !system_files::is_terminal(2)) return;
    shown_ = now;
    stage_ = stage;
    visible_ = true;
    std::string time;
    if (fraction > k_min_estimated_fraction) {
        const double remaining = now * (1 - fraction) / fraction;
        time = remaining < 100 ? fmt::format(", {:.0f} s left", std::ceil(remaining))
                               : fmt::format(", {:.0f} min left", std::ceil(remaining / 60));
    }
    fmt::print(stderr, "\r\033[K\033[?7l{:3.0f} %  {}{}\033[?7h", 100 * fraction, printable(stage),
               time);  // ?7: line wrapping off and on
}

void ProgressLine::clear() {
    if (visible_) fmt::print(stderr, "\r\033[K");
    visible_ = false;
}

}  // namespace srbf
