// Accuracy of the forms over many materials: fits every file in each form within 160 bytes. Prints the mean, median,
// 95th percentile and maximum of the errors, then a row for each material.
//   usage: accuracy OBJECTIVE FILE...
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "srbf/fit.h"
#include "srbf/measured.h"
#include "srbf/metrics.h"

namespace srbf {
namespace {

struct Size {
    PmForm form;
    int lobes, variates;
};
constexpr Size k_sizes[] = {{PmForm::gaussian, 8, 4}, {PmForm::horizon, 8, 4}, {PmForm::extended, 6, 4}};

struct Row {
    std::string material;
    std::size_t bytes;
    double seconds;
    Measures heldout;
    double albedo_error;
};

struct Column {
    const char* title;
    double (*of)(const Row&);
    double scale;
};
constexpr Column k_columns[] = {
    {"f, %", [](const Row& r) { return r.heldout.squared_error_ratio; }, 100},
    {"f cosθl, %", [](const Row& r) { return r.heldout.squared_error_ratio_cosine; }, 100},
    {"RMS of log", [](const Row& r) { return r.heldout.log_rms_cosine; }, 1},
    {"cube root, %", [](const Row& r) { return r.heldout.cube_root_error_ratio; }, 100},
    {"albedo, %", [](const Row& r) { return r.albedo_error; }, 100},
    {"seconds", [](const Row& r) { return r.seconds; }, 1},
};

Result<Row> fit_one(const std::string& path, const Size& size, Objective objective) {
    using Clock = std::chrono::steady_clock;
    const auto start = Clock::now();
    const auto measured = load_measured(path);
    if (!measured) return measured.error();
    const auto observations = observe(signed_evaluator(*measured), {.objective = objective});
    if (!observations) return observations.error();
    FitOptions options;
    options.form = size.form;
    options.lobes = size.lobes;
    options.variates = size.variates;
    const auto fit = fit_pm(*observations, options);
    if (!fit) return fit.error();
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    const Evaluate others[] = {evaluator(fit->model)};
    const double cap = default_max_theta(objective);
    return Row{std::filesystem::path(path).stem().string(), payload_bytes(fit->model), seconds,
               measure_heldout(evaluator(*measured), others, {cap, 0})[0],
               albedo_error(evaluator(*measured), others[0], cap)};
}

void print_row(const std::string& name, auto value_of_column) {
    fmt::print("| {} |", name);
    for (const Column& column : k_columns) fmt::print(" {:.3g} |", column.scale * value_of_column(column));
    fmt::print("\n");
}

void print_table(const Size& size, const std::vector<Row>& rows) {
    fmt::print("\n## Form {}, J = {}, N = {}, {} bytes\n\n|", name(size.form), size.lobes, size.variates,
               rows[0].bytes);
    fmt::print(" {} materials |", rows.size());
    for (const Column& column : k_columns) fmt::print(" {} |", column.title);
    fmt::print("\n|---|");
    for (std::size_t k = 0; k < std::size(k_columns); ++k) fmt::print("---|");
    fmt::print("\n");
    const auto ranked = [&](const Column& column, double quantile) {
        std::vector<double> values;
        for (const Row& row : rows) values.push_back(column.of(row));
        std::sort(values.begin(), values.end());
        return values[std::size_t(quantile * double(values.size() - 1) + 0.5)];
    };
    print_row("mean", [&](const Column& column) {
        double sum = 0;
        for (const Row& row : rows) sum += column.of(row) / double(rows.size());
        return sum;
    });
    print_row("median", [&](const Column& column) { return ranked(column, 0.5); });
    print_row("95 % of them", [&](const Column& column) { return ranked(column, 0.95); });
    print_row("worst", [&](const Column& column) { return ranked(column, 1); });
    for (const Row& row : rows) print_row(row.material, [&](const Column& column) { return column.of(row); });
}

}  // namespace
}  // namespace srbf

int main(int argc, char** argv) {
    using namespace srbf;
    const auto objective = argc > 2 ? objective_named(argv[1]) : std::nullopt;
    if (!objective) {
        fmt::print(stderr, "usage: {} raw|cosine|log|cube-root FILE...\n", argv[0]);
        return 2;
    }
    for (const Size& size : k_sizes) {
        std::vector<Row> rows;
        for (int i = 2; i < argc; ++i) {
            auto row = fit_one(argv[i], size, *objective);
            if (!row) {
                fmt::print(stderr, "{}\n", message(row.error()));
                return 1;
            }
            rows.push_back(*std::move(row));
        }
        print_table(size, rows);
    }
    return 0;
}
