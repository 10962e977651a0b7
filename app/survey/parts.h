// What the page of a report is made of.
#pragma once
#include <string>
#include <vector>

#include "app/survey/table.h"

namespace srbf {

using Rows = std::vector<const Json*>;

// ---- Numbers and words ----

enum class Shown { whole, percent, plain, seconds };
/// A number of a table, and how a reader sees it: `<data value='FIELD'>`; – where there is none.
std::string number(const Json& value, Shown how);
/// That of a column of a row; the row may be null.
std::string number(const Json* row, const std::string& column, Shown how);
inline Shown shown_as(const MeasureText& measure) { return measure.is_ratio ? Shown::percent : Shown::plain; }
/// A field as HTML.
std::string text_of(const Json& row, const char* column);

/// "multivariate, extended"
std::string title_of(const Json& fit);
/// What is drawn, in this order, and how it is called.
inline constexpr const char* k_drawn[] = {"measured", "pm", "pm2", "su", "ggx"};
std::string role_title(const std::string& role);
/// The column of the measure that an objective is judged by, held out; of a name that none has, cosine's.
std::string measure_column(const std::string& objective);
/// Whether a fit stands in the source's Table 7.1 anew, beside all that the sweep has.
bool is_of_table(const Json& fit);
/// The word for a likeness, in its colour.
std::string word(double flip);
std::string link_to(const Json& material);
std::string label_of(const Json& material);

// ---- Tables ----

/// A column, or several of a common name.
struct Head {
    std::string name;
    std::vector<std::string> of;
};
/// A table whose first column is a name.
std::string table(const std::vector<Head>& heads, const std::string& rows);
std::string row(const std::string& head, const std::vector<std::string>& cells, const char* kind = "");
/// A line that says what the rows below have in common.
std::string group(const std::string& text, std::size_t columns);

// ---- What is looked up over and over ----

/// Where pictures lie, and which the page holds: all, or those of the ball without differences.
struct Album {
    std::string folder;  ///< of the report
    bool is_whole = true;
};
/// A picture with a link to its file, or the link alone.
std::string picture(const Album& album, const Json& material, const std::string& name, const std::string& alt);

/// The tables, by material.
struct View {
    const Tables& tables;
    Album album;

    Rows done() const;
    Rows fits(const Json& material) const;
    /// The fit that is drawn in that role.
    const Json* drawn(const Json& material, const std::string& role) const;
    Rows pictures(const Json& material, const char* object) const;
    const Json* ball(const Json& material, const std::string& role) const;
    /// Mean ꟻLIP of the ball in the default fit.
    double flip(const Json& material) const;
    /// What is done, the most alike first.
    Rows by_likeness() const;
};

/// All that is told of one material.
std::string material_section(const View& view, const Json& material, const Study& study);

}  // namespace srbf
