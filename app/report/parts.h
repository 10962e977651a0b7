// Building blocks of the report's page.
#pragma once
#include <string>
#include <vector>

#include "app/report/table.h"

namespace srbf {

using Rows = std::vector<const Json*>;

// ---- Numbers and words ----

enum class Shown { whole, percent, plain, seconds };
/// A number of a table and its displayed text: `<data value='FIELD'>`; – if there is none.
std::string number(const Json& value, Shown how);
/// The same for a column of a row; the row may be null.
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
/// Whether a fit corresponds to one in Table 7.1 of Tsai 2009.
bool is_of_table(const Json& fit);
/// The word for a similarity, in its colour.
std::string word(double flip);
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
/// A line that describes the rows below it.
std::string group(const std::string& text, std::size_t columns);

// ---- Lookups ----

/// The location of the pictures, and which of them the page embeds: all, or those of the ball without differences.
struct Album {
    std::string folder;  ///< of the report
    bool is_whole = true;
};
/// A picture with a link to its file, or only the link.
std::string picture(const Album& album, const Json& material, const std::string& name, const std::string& alt);

/// The tables, by material.
struct View {
    const Tables& tables;
    Album album;

    Rows done() const;
    Rows fits(const Json& material) const;
    /// The fit with that role.
    const Json* drawn(const Json& material, const std::string& role) const;
    Rows pictures(const Json& material, const char* object) const;
    const Json* ball(const Json& material, const std::string& role) const;
    /// Mean ꟻLIP of the ball with the default fit.
    double flip(const Json& material) const;
    /// The completed materials, most similar first.
    Rows by_likeness() const;
};

/// The section of a material.
std::string material_section(const View& view, const Json& material, const Study& study);

}  // namespace srbf
