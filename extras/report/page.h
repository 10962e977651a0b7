// The pages of a report, and its tables as Markdown. Each number of a table, card or caption is `<data value='V'>` with
// a field V of one of the tables.
#pragma once
#include <string>
#include <vector>

#include "extras/report/table.h"

namespace srbf {

/// All materials, measured and fitted, in an order that the reader chooses: index.html.
std::string gallery_html(const std::vector<Reported>& materials, const Tables& tables, const std::string& note);
/// A material of the tables: its pictures, files to take away, errors, lobes: index.html in its folder.
std::string material_html(const Tables& tables, const Json& material, const Study& study);
/// The errors of all materials in one table, and their statistics: numbers.html.
std::string numbers_html(const Tables& tables);

/// Tables for a document: each form over all materials, each material, the baseline, view-by-view models over J.
std::string report_markdown(const Tables& tables);

}  // namespace srbf
