// The tables of a report: the content of its CSV files, and the source of all numbers of its page.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "extras/report/study.h"

namespace srbf {

/// Rows of one kind, written as NAME.csv.
struct Table {
    std::string name;
    std::vector<std::string> columns;
    std::vector<Json> rows;  ///< objects; missing and null values are empty fields
};
std::string csv(const Table& table);
/// A value in CSV; numbers have as many digits as necessary for a round trip.
std::string field(const Json& value);

/// A material of the command line: a study, or an error.
struct Reported {
    std::string name;   ///< unique
    std::string label;  ///< given by the user
    std::string file;
    std::optional<Study> study;
    std::string error;        ///< one line
    std::string frame_error;  ///< why frames were not timed; empty: they were
};

struct Tables {
    Table constants;  ///< constants of the pages' text: directions, pairs, folds, angles
    Table summary;    ///< numbers of materials, of failures, and of those of each verdict
    Table materials;  ///< for each file: its origin, masked and clamped values, failures
    Table fits;       ///< for each fit: its kind, bytes, seconds and errors
    Table failures;   ///< fits that failed
    Table
        /// mean, median, 95th percentile and maximum of each measure of each kind of fit over the materials
        statistics;
    Table pictures;  ///< differences of the pictures from that of the measurement
    Table frames;    ///< frames per second, and size of the data that is looked up
    Table source;    ///< Tsai 2009, Tables 7.1 and 7.2
    std::vector<const Table*> all() const {
        return {&constants, &summary, &materials, &fits, &failures, &statistics, &pictures, &frames, &source};
    }
};
Tables tables_of(const std::vector<Reported>& materials);

/// The rows of a table with that value in that column.
std::vector<const Json*> rows_with(const Table& table, const std::string& column, const Json& value);
/// The first of the rows with that value; none: null.
const Json* row_with(const std::vector<const Json*>& rows, const std::string& column, const Json& value);

/// Name, title and format of a measure.
struct MeasureText {
    const char* column;
    const char* title;
    const char* meaning;
    bool is_ratio;  ///< displayed in per cent
};
/// The measures of the statistics, in the order of the page.
extern const std::vector<MeasureText> k_measure_texts;

}  // namespace srbf
