// The pages of a report. Each number in a table, card or caption is `<data value='V'>`, where V is a field of one of
// the tables.
#pragma once
#include "extras/report/table.h"

namespace SRBF_NAMESPACE {

/// The first page: a gallery in an order that the reader chooses, and the errors of all materials in one table.
std::string index_html(const Tables& tables);
/// The page of a material: its pictures, files to download, errors and lobes.
std::string material_html(const Tables& tables, const Json& material, const Study& study);

}  // namespace
