// The pages of a report, and its tables as Markdown. Each number in a table, card or caption is `<data value='V'>`,
// where V is a field of one of the tables.
#pragma once
#include <string>
#include <vector>

#include "extras/report/table.h"

namespace SRBF_NAMESPACE {

/// All materials, measured and fitted, in an order that the reader chooses: index.html.
std::string gallery_html(const std::vector<MaterialEntry>& materials, const Tables& tables, const std::string& note);
/// The page of a material: its pictures, files to download, errors and lobes: index.html in its folder.
std::string material_html(const Tables& tables, const Json& material, const Study& study);
/// The errors of all materials in one table, and their statistics: numbers.html.
std::string numbers_html(const Tables& tables);

/// The tables of docs/accuracy.md: each form over all materials, each material, the baseline, view-by-view models
/// over J.
std::string report_markdown(const Tables& tables);

}  // namespace srbf
