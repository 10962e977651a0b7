// The report as an HTML page, and its tables as Markdown.
#pragma once
#include <string>
#include <vector>

#include "app/report/table.h"

namespace srbf {

/// The page, HTML in UTF-8, self-contained and without scripts; its links lead to the models and pictures in its
/// folder. Each number of its tables and captions is `<data value='V'>` with a field V of one of the tables. Pictures
/// are embedded up to `k_most_picture_bytes`, those of the ball first.
std::string report_html(const std::vector<Reported>& materials, const Tables& tables, const std::string& note);
inline constexpr std::size_t k_most_picture_bytes = 2200000;

/// Tables for a document: each form over all materials, each material, the baseline, view-by-view models over J.
std::string report_markdown(const Tables& tables);

}  // namespace srbf
