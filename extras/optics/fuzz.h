// Fuzz targets.
#pragma once
#include "srbf/optics.h"

namespace SRBF_NAMESPACE {

/// Checks that a written table can be read.
inline void check_zemax(std::span<const std::byte> bytes) {
    auto table = read_zemax(bytes, "f");
    if (!table) return check_error(table.error());
    const std::string written = write_zemax(*table);
    const auto again = read_zemax(std::as_bytes(std::span(written)), "f");
    require(again.ok() && again->slices.size() == table->slices.size(), "what is written is read");
    check_measured(Result<EvaluatedTable>(as_evaluated_table(*std::move(table))));
}

inline const NamedTarget k_optics_targets[] = {{"zemax", check_zemax}};

}  // namespace
