// Building blocks of the report's pages.
#pragma once
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "extras/report/table.h"

namespace SRBF_NAMESPACE {

using Rows = std::vector<const Json*>;

// ---- Numbers and words ----

enum class NumberFormat { whole, percent, plain, seconds };
/// A number as HTML, `<data value='FIELD'>TEXT</data>` with its field in a table; "–" if it is missing.
std::string number(const Json& value, NumberFormat format);
/// The number in a column of a row; the row may be null.
std::string number(const Json* row, const std::string& column, NumberFormat format);
inline NumberFormat format_of(const MeasureText& measure) {
    return measure.is_ratio ? NumberFormat::percent : NumberFormat::plain;
}
/// A field as HTML.
std::string text_of(const Json& row, const char* column);

/// "multivariate, extended"
std::string title_of(const Json& fit);
/// The roles of the drawn subjects, in the order of the page, and their titles.
inline constexpr const char* k_roles[] = {"measured", "pm", "pm2", "su", "ggx"};
std::string role_title(const std::string& role);
/// The column of the measure by which fits with an objective are judged, for the input "table" or "samples"; held
/// out if the measure is one over directions. An unknown objective counts as cosine.
std::string measure_column(const std::string& objective, const Json& input);
/// True if a fit corresponds to one in Table 7.1 of Tsai 2009.
bool is_of_table(const Json& fit);
/// A verdict as HTML, with its colour.
std::string verdict_text(const Json& words);
/// The name of a material as a link to its page.
std::string link_to(const Json& material);
std::string label_of(const Json& material);

// ---- Tables ----

/// A column, or a group of columns with a common name.
struct Head {
    std::string name;
    std::vector<std::string> columns;  ///< empty: a single column
};
/// A table whose first column contains names.
std::string table(const std::vector<Head>& heads, const std::string& rows);
std::string row(const std::string& head, const std::vector<std::string>& cells, const char* kind = "");
/// The objectives whose fits are listed, in the order of the page.
inline constexpr const char* k_listed_objectives[] = {"appearance", "raw", "cosine", "cube-root", "relative"};
/// A row that describes the rows below it.
std::string group(const std::string& text, std::size_t columns);

// ---- Pages ----

/// A page. The title is HTML; the body is a template that is filled with these parts and the title.
std::string page(const std::string& title, std::string_view body,
                 std::vector<std::pair<std::string_view, std::string>> parts);

// ---- Lookups ----

/// Look-ups in the tables, by material.
struct View {
    const Tables& tables;

    Rows done() const;
    Rows fits(const Json& material) const;
    /// The fit with this role.
    const Json* fit_with_role(const Json& material, const std::string& role) const;
    Rows pictures(const Json& material, const char* object) const;
    const Json* ball(const Json& material, const std::string& role) const;
    /// The completed materials, sorted by the visible error of the default fit.
    Rows by_visible_error() const;
};

}  // namespace srbf
