// A table of numbers of many materials: their mean, median, 95th percentile and largest, then a row for each.
#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

namespace srbf {

template <typename Row> struct Column {
    const char* title;
    std::function<double(const Row&)> of;
};

/// `Row` has the name of its `material`.
template <typename Row> void print_table(const std::vector<Row>& rows, const std::vector<Column<Row>>& columns) {
    const auto print_row = [&](const std::string& name, const auto& value_of) {
        fmt::print("| {} |", name);
        for (const Column<Row>& column : columns) fmt::print(" {:.3g} |", value_of(column));
        fmt::print("\n");
    };
    const auto ranked = [&](double quantile) {
        return [&rows, quantile](const Column<Row>& column) {
            std::vector<double> values;
            for (const Row& row : rows) values.push_back(column.of(row));
            std::sort(values.begin(), values.end());
            return values[std::size_t(quantile * double(values.size() - 1) + 0.5)];
        };
    };
    fmt::print("\n| {} materials |", rows.size());
    for (const Column<Row>& column : columns) fmt::print(" {} |", column.title);
    fmt::print("\n|---|");
    for (std::size_t k = 0; k < columns.size(); ++k) fmt::print("---|");
    fmt::print("\n");
    print_row("mean", [&](const Column<Row>& column) {
        double sum = 0;
        for (const Row& row : rows) sum += column.of(row) / double(rows.size());
        return sum;
    });
    print_row("median", ranked(0.5));
    print_row("95 % of them", ranked(0.95));
    print_row("worst", ranked(1));
    for (const Row& row : rows) print_row(row.material, [&](const Column<Row>& column) { return column.of(row); });
}

}  // namespace srbf
