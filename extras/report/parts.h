// Building blocks of the report's page.
#pragma once
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "extras/report/table.h"

namespace srbf {

using Rows = std::vector<const Json*>;

// ---- Numbers and words ----

enum class Shown { whole, percent, plain, seconds };
/// A number of a table and its displayed text: `<data value='FIELD'>`; – if there is none.
std::string number(const Json& value, Shown how);
/// The text of a column of a row; the row may be null.
std::string number(const Json* row, const std::string& column, Shown how);
inline Shown shown_as(const MeasureText& measure) { return measure.is_ratio ? Shown::percent : Shown::plain; }
/// A field as HTML.
std::string text_of(const Json& row, const char* column);

/// "multivariate, extended"
std::string title_of(const Json& fit);
/// The roles of what is drawn, in this order, and their names.
inline constexpr const char* k_drawn[] = {"measured", "pm", "pm2", "su", "ggx"};
std::string role_title(const std::string& role);
/// The column of the measure by which an objective is judged for that input ("table" or "samples"), held out if it is
/// one of directions; for an unknown objective that of cosine.
std::string measure_column(const std::string& objective, const Json& input);
/// True if a fit corresponds to one in Table 7.1 of Tsai 2009.
bool is_of_table(const Json& fit);
/// A verdict, in its colour.
std::string verdict_text(const Json& words);
/// The name of a material, with a link to its page.
std::string link_to(const Json& material);
std::string label_of(const Json& material);

// ---- Tables ----

/// A column, or several columns with a common name.
struct Head {
    std::string name;
    std::vector<std::string> of;
};
/// A table whose first column is a name.
std::string table(const std::vector<Head>& heads, const std::string& rows);
std::string row(const std::string& head, const std::vector<std::string>& cells, const char* kind = "");
/// The objectives whose fits are listed, in this order.
inline constexpr const char* k_listed_objectives[] = {"appearance", "raw", "cosine", "cube-root", "relative"};
/// A line that describes the rows below it.
std::string group(const std::string& text, std::size_t columns);

// ---- Pages ----

/// A page of that title, which is HTML, whose body is a template with these parts and the title.
std::string page(const std::string& title, std::string_view body,
                 std::vector<std::pair<std::string_view, std::string>> parts);

// ---- Lookups ----

/// The tables, by material.
struct View {
    const Tables& tables;

    Rows done() const;
    Rows fits(const Json& material) const;
    /// The fit with that role.
    const Json* drawn(const Json& material, const std::string& role) const;
    Rows pictures(const Json& material, const char* object) const;
    const Json* ball(const Json& material, const std::string& role) const;
    /// The completed materials, by the visible error of the default fit.
    Rows by_visible_error() const;
};

}  // namespace srbf
