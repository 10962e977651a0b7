#pragma once
#include "measured/formats.h"

namespace SRBF_NAMESPACE {

Result<std::vector<std::byte>> write_as_merl(const TableSource& source, const TableOptions& options);
Result<std::vector<std::byte>> write_as_rgl(const TableSource& source, const TableOptions& options);
Result<std::vector<std::byte>> write_as_mbsdf(const TableSource& source, const TableOptions& options);
Result<std::vector<std::byte>> write_as_csv(const TableSource& source, const TableOptions& options);

}  // namespace srbf
