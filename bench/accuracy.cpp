// Accuracy of the forms over many materials: fits every file in each form within 160 bytes. Prints the mean, median,
// 95th percentile and maximum of the errors, then a row for each material.
//   usage: accuracy OBJECTIVE FILE...
#include <chrono>
#include <filesystem>

#include "fit/fits.h"
#include "material_table.h"
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

const std::vector<Column<Row>> k_columns{
    {"f, %", [](const Row& r) { return 100 * r.heldout.squared_error_ratio; }},
    {"f cosθl, %", [](const Row& r) { return 100 * r.heldout.squared_error_ratio_cosine; }},
    {"RMS of log", [](const Row& r) { return r.heldout.log_rms_cosine; }},
    {"cube root, %", [](const Row& r) { return 100 * r.heldout.cube_root_error_ratio; }},
    {"albedo, %", [](const Row& r) { return 100 * r.albedo_error; }},
    {"seconds", [](const Row& r) { return r.seconds; }},
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
        fmt::print("\n## Form {}, J = {}, N = {}, {} bytes\n", name(size.form), size.lobes, size.variates,
                   rows[0].bytes);
        print_table(rows, k_columns);
    }
    return 0;
}
