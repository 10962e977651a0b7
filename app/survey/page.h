// A report as a page, and its tables as Markdown.
#pragma once
#include <string>
#include <vector>

#include "app/survey/table.h"

namespace srbf {

/// The page, HTML in UTF-8, whole without any other file; its links lead to models and pictures beside it. Needs no script. Each number of its tables
/// and captions is `<data value='V'>`, V a field of one of the tables. Pictures are embedded as far as `k_most_picture_bytes` go, those of
/// the ball first.
std::string survey_html(const std::vector<Surveyed>& materials, const Tables& tables, const std::string& note);
inline constexpr std::size_t k_most_picture_bytes = 2200000;

/// Tables for a document: each form over all materials, each material, the baseline, view by view over J.
std::string survey_markdown(const Tables& tables);

}  // namespace srbf
