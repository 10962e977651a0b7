// Compares directional albedos of models with those of the tables that they were fitted to. Prints for each cosθv the
// relative errors of the channels, the largest difference, and the largest excess over both 1 and the table.
//   usage: albedos TABLE MODEL [TABLE MODEL]...
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "brdf/directions.h"
#include "srbf/elementary.h"
#include "srbf/measured.h"
#include "srbf/metrics.h"
#include "srbf/model.h"

namespace srbf {
namespace {

constexpr double k_cosines[] = {1, 0.5, 0.25, 0.1, 0.03, 0.01, 0.003};

/// Albedos at the views of `k_cosines`.
struct Albedos {
    std::array<Rgb, std::size(k_cosines)> table, model;
};

Result<Albedos> albedos(const char* table, const char* model) {
    const auto measured = load_measured(table);
    if (!measured) return measured.error();
    const auto fitted = load_model(model);
    if (!fitted) return fitted.error();
    Albedos all;
    for (std::size_t k = 0; k < std::size(k_cosines); ++k) {
        const double theta = elementary::acos(k_cosines[k]);
        all.table[k] = albedo(evaluator(*measured), theta, k_pi / 2);
        all.model[k] = albedo(evaluator(*fitted), theta, k_pi / 2);
    }
    return all;
}

void print_view(std::span<const Albedos> pairs, std::size_t view) {
    std::vector<double> relative;
    double largest = 0, excess = -1;
    for (const Albedos& pair : pairs) {
        for (int c = 0; c < 3; ++c) {
            const double measured = double(pair.table[view][c]), fitted = double(pair.model[view][c]);
            relative.push_back(std::abs(fitted - measured) / measured);
            largest = std::max(largest, std::abs(fitted - measured));
            excess = std::max(excess, fitted - std::max(measured, 1.0));
        }
    }
    std::ranges::sort(relative);
    fmt::print("| {} | {:.2g} % | {:.2g} % | {:.2g} % | {:.2g} | {:.2g} |\n", k_cosines[view],
               100 * relative[relative.size() / 2], 100 * relative[relative.size() * 95 / 100], 100 * relative.back(),
               largest, excess);
}

}  // namespace
}  // namespace srbf

int main(int argc, char** argv) {
    std::vector<srbf::Albedos> all;
    for (int i = 1; i + 1 < argc; i += 2) {
        const auto pair = srbf::albedos(argv[i], argv[i + 1]);
        if (!pair) {
            fmt::print(stderr, "{}\n", srbf::message(pair.error()));
            return 1;
        }
        all.push_back(*pair);
    }
    if (all.empty()) return 1;
    fmt::print("| cosθv | median | 95 % | largest | largest difference | most above 1 and the table |\n");
    fmt::print("|---|---|---|---|---|---|\n");
    for (std::size_t view = 0; view < std::size(srbf::k_cosines); ++view) srbf::print_view(all, view);
    return 0;
}
