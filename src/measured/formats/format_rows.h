// Functions that the rows of the table of formats share, here and in extras.
#pragma once
#include <memory>

#include "base/text.h"
#include "measured/formats.h"
#include "measured/tables.h"

namespace SRBF_NAMESPACE {

template <typename Table> Result<Measured> measurement_of(Result<Table> table) {
    if (!table) return table.error();
    return Measured{{}, {}, 0, *std::move(table)};
}

template <auto read>
Result<Measured> read_by(std::span<const std::byte> bytes, const std::string& file_name, const ReadOptions&) {
    return measurement_of(read(bytes, file_name));
}

template <auto is_format> bool in_text(std::span<const std::byte> head) { return is_format(as_text(head)); }

inline std::vector<std::byte> bytes_of(std::string_view text) {
    const auto bytes = std::as_bytes(std::span(text));
    return {bytes.begin(), bytes.end()};
}

/// Makes an `EvaluatedTable` of the table type of one format by the functions `signed_value`, `is_isotropic` and
/// `lines_about` of that type. `functions` has the functions that only few formats define.
template <typename Table>
EvaluatedTable evaluated_table(const std::shared_ptr<const Table>& table, TableFunctions functions = {}) {
    functions.lines = [table] { return lines_about(*table); };
    EvaluatedTable evaluated;
    evaluated.values = [table](auto wl, auto wv, auto f) {
        for (std::size_t i = 0; i < f.size(); ++i) f[i] = signed_value(*table, wl[i], wv[i]);
    };
    evaluated.isotropic = is_isotropic(*table);
    evaluated.table = table, evaluated.table_name = Table::k_name;
    evaluated.functions = std::make_shared<const TableFunctions>(std::move(functions));
    return evaluated;
}

/// The formats without extras, each in the file of its reader.
extern const Format k_rgl_format, k_mbsdf_format, k_merl_format, k_alta_format, k_astm_format, k_cornell_format,
    k_csv_format, k_utia_format;

Result<std::vector<std::byte>> write_as_merl(const TableSource& source, const TableOptions& options);
Result<std::vector<std::byte>> write_as_rgl(const TableSource& source, const TableOptions& options);
Result<std::vector<std::byte>> write_as_mbsdf(const TableSource& source, const TableOptions& options);
Result<std::vector<std::byte>> write_as_csv(const TableSource& source, const TableOptions& options);

}  // namespace
