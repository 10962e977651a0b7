// The tables of a report: the content of its CSV files and the source of all numbers on its pages.
#pragma once
#include <vector>

#include "extras/report/study.h"

namespace SRBF_NAMESPACE {

/// Rows of one kind, written as NAME.csv.
struct Table {
    std::string name;
    std::vector<std::string> columns;
    std::vector<Json> rows;  ///< objects; missing and null values are empty fields
};
std::string csv(const Table& table);
/// A value as a field of CSV. Numbers have as many digits as a round trip needs.
std::string field(const Json& value);

/// A material on the command line: a study, or an error.
struct MaterialEntry {
    std::string name;  ///< unique
    std::string file;
    std::optional<Study> study;
    std::string error;        ///< one line
    std::string frame_error;  ///< why frames were not timed; empty: they were timed
};

struct Tables {
    Table materials;  ///< one row a file: origin, masked and clamped values, failures
    Table fits;       ///< one row a fit: kind, bytes, seconds and errors
    Table failures;   ///< fits that failed
    Table pictures;   ///< differences of pictures from the measurement's picture
    Table frames;     ///< frames per second, and the size of the data that shaders read
    Table source;     ///< Tsai 2009, Tables 7.1 and 7.2
    std::vector<const Table*> all() const { return {&materials, &fits, &failures, &pictures, &frames, &source}; }
};
Tables tables_of(const std::vector<MaterialEntry>& materials);

using Rows = std::vector<const Json*>;
/// The rows of a table that have `value` in `column`.
Rows rows_with(const Table& table, const std::string& column, const Json& value);
/// The first of the rows that has `value` in `column`; null if there is none.
const Json* row_with(const Rows& rows, const std::string& column, const Json& value);
/// The fit of a material that is drawn in this role.
const Json* fit_with_role(const Tables& tables, const Json& material, const std::string& role);
/// The completed materials, sorted by the visible error of the main fit (role "pm").
Rows by_visible_error(const Tables& tables);

/// The name, title, meaning and format of a measure.
struct MeasureText {
    const char* column;
    const char* title;
    const char* meaning;
    bool is_ratio;  ///< displayed in per cent
};
/// The measures of the pages' tables, in their order.
extern const std::vector<MeasureText> k_measure_texts;

}  // namespace
