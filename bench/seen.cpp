// What is seen of many materials: fits every file by each objective in the default size, view by view too, and prints
// errors of pictures: the mean, median, 95th percentile and maximum, then a row for each material.
//   usage: seen FILE...
#include <filesystem>
#include <limits>
#include <map>

#include "material_table.h"
#include "srbf/fitting.h"
#include "srbf/measured.h"

namespace srbf {
namespace {

struct Row {
    std::string material;
    PictureErrors fit, view_by_view;            ///< by the default objective
    std::map<Objective, PictureErrors> others;  ///< by the others
};
double least_flip_of_others(const Row& row) {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& [objective, errors] : row.others) least = std::min(least, errors.flip);
    return least;
}
Column<Row> of_objective(const char* title, Objective objective) {
    return {title, [objective](const Row& row) { return row.others.at(objective).delta_e; }};
}
const std::vector<Column<Row>> k_columns{
    {"ΔE_ITP", [](const Row& r) { return r.fit.delta_e; }},
    of_objective("cosine", Objective::cosine),
    of_objective("log", Objective::log),
    of_objective("cube root", Objective::cube_root),
    {"ꟻLIP", [](const Row& r) { return r.fit.flip; }},
    {"least of the three", least_flip_of_others},
    {"RMS", [](const Row& r) { return r.fit.rms; }},
    {"SU: ΔE_ITP", [](const Row& r) { return r.view_by_view.delta_e; }},
    {"SU: RMS", [](const Row& r) { return r.view_by_view.rms; }},
};

Result<Row> fit_all(const std::string& path) {
    const auto measured = load_measured(path);
    if (!measured) return measured.error();
    Row row{std::filesystem::path(path).stem().string(), {}, {}, {}};
    const auto fitted = [&](FitRequest request, PictureErrors& errors) -> Result<Done> {
        const auto outcome = fit(*measured, request);
        if (!outcome) return outcome.error();
        errors = outcome->errors->appearance.mean;
        return Done{};
    };
    for (const Objective objective : {Objective::cosine, Objective::log, Objective::cube_root})
        if (const auto done = fitted({.model = PmRequest{}, .objective = objective}, row.others[objective]); !done)
            return done.error();
    if (const auto done = fitted({.model = PmRequest{}}, row.fit); !done) return done.error();
    if (const auto done = fitted({.model = SuRequest{.lobes = 5}}, row.view_by_view); !done) return done.error();
    return row;
}

}  // namespace
}  // namespace srbf

int main(int argc, char** argv) {
    using namespace srbf;
    std::vector<Row> rows;
    for (int i = 1; i < argc; ++i) {
        auto row = fit_all(argv[i]);
        if (!row) {
            fmt::print(stderr, "{}\n", message(row.error()));
            return 1;
        }
        rows.push_back(*std::move(row));
    }
    if (rows.empty()) {
        fmt::print(stderr, "usage: {} FILE...\n", argv[0]);
        return 2;
    }
    print_table(rows, k_columns);
    return 0;
}
