// The tables of a report: what its CSV files hold, and where each number of its page comes from.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "app/survey/study.h"

namespace srbf {

/// Rows of one kind, written as NAME.csv.
struct Table {
    std::string name;
    std::vector<std::string> columns;
    std::vector<Json> rows;  ///< objects; what a row lacks, or is null, is an empty field
};
std::string csv(const Table& table);
/// A value as the CSV has it: numbers with as many digits as tell them apart.
std::string field(const Json& value);

/// A material of the command line: a study, or why there is none.
struct Surveyed {
    std::string name;   ///< of all materials another one
    std::string label;  ///< what the user says of it
    std::string file;
    std::optional<Study> study;
    std::string error;        ///< one line
    std::string frame_error;  ///< why no frames were timed; empty: they were
};

struct Tables {
    Table constants;  ///< what the page's words name: directions, pairs, folds, angles, limits
    Table summary;    ///< how many materials there are, failed, and look alike, close and different
    Table materials;  ///< each file: its origin, what was masked and clamped, what failed
    Table fits;       ///< each fit: what it is, its bytes, seconds and errors
    Table failures;   ///< fits that failed
    Table
        statistics;  ///< mean, median, 95th percentile and worst of each measure of each kind of fit over the materials
    Table pictures;  ///< how far pictures are from the measured one
    Table frames;    ///< frames a second, and what is looked up for them
    Table source;    ///< Tsai 2009, Tables 7.1 and 7.2
    std::vector<const Table*> all() const {
        return {&constants, &summary, &materials, &fits, &failures, &statistics, &pictures, &frames, &source};
    }
};
Tables tables_of(const std::vector<Surveyed>& materials);

/// How alike a fit's picture looks by its mean ꟻLIP: "alike", "close" or "differs".
const char* likeness_word(double flip);
inline constexpr double k_alike = 0.03, k_close = 0.07;

/// The rows of a table that have that value in that column.
std::vector<const Json*> rows_with(const Table& table, const std::string& column, const Json& value);
/// The first of `rows` that has it; none: null.
const Json* row_with(const std::vector<const Json*>& rows, const std::string& column, const Json& value);

/// How a measure is named, told and printed.
struct MeasureText {
    const char* column;
    const char* title;
    const char* meaning;
    bool is_ratio;  ///< shown as per cent
};
/// What statistics are made of, in the order of the page.
extern const std::vector<MeasureText> k_measure_texts;

}  // namespace srbf
