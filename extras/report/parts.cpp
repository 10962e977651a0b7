#include "extras/report/parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "app/html.h"
#include "base/printable.h"
#include "errors/picture_errors.h"
#include "errors/sphere.h"
#include "observe/objectives.h"
#include "render/page_text.h"
#include "report/report_text.h"

namespace SRBF_NAMESPACE {

std::string number(const Json& value, NumberFormat format) {
    if (!value.is_number()) return "–";
    const double x = value;
    const std::string text = format == NumberFormat::whole     ? grouped(value.get<std::uint64_t>())
                             : format == NumberFormat::percent ? percent(x)
                             : format == NumberFormat::seconds ? fmt::format("{:.2f} s", x)
                                                               : fmt::format("{:.3g}", x);
    return fmt::format("<data value='{}'>{}</data>", field(value), text);
}
std::string number(const Json* row, const std::string& column, NumberFormat format) {
    if (row == nullptr) return "–";
    const auto entry = row->find(column);
    return entry == row->end() ? "–" : number(*entry, format);
}
std::string text_of(const Json& row, const char* column) { return html_escaped(field(row.at(column))); }

std::string title_of(const Json& fit) {
    const std::string model = fit["model"];
    if (model == "su")
        return fit.value("interpolation", "") == "plain" ? "view by view, nearest views" : "view by view";
    if (model == "ggx") return "GGX and Lambert";
    if (model == "openpbr") return "OpenPBR Surface";
    return "multivariate, " + fit["form"].get<std::string>() + (fit["axial"] == true ? "" : ", general lobes");
}
std::string role_title(const std::string& role) {
    if (role == "measured") return "measured";
    if (role == "pm") return "multivariate";
    if (role == "pm2") return "multivariate, cosine";
    return role == "su" ? "view by view" : "GGX";
}
std::string measure_column(const std::string& objective, const Json& input) {
    const Objective objective_value = objective_named(objective).value_or(Objective::cosine);
    if (objective_value == Objective::appearance && input == "table") return "delta_e_itp";
    return fmt::format("heldout_{}", measure_named_for(objective_value).name);
}
std::string link_to(const Json& material) {
    return fmt::format("<a href='{}/index.html'>{}</a>", text_of(material, "folder"), text_of(material, "material"));
}
std::string label_of(const Json& material) {
    const std::string label = material["label"];
    return label.empty() ? "" : fmt::format(" <span class='label'>{}</span>", html_escaped(label));
}

bool is_of_table(const Json& fit) {
    const std::string model = fit["model"];
    const int lobes = fit["lobes"], variates = fit["variates"];
    if (model == "pm") return (lobes == 6 && variates == 3) || (variates == 4 && (lobes == 6 || lobes == 8));
    if (model == "su") return lobes == (fit["input"] == "samples" ? 4 : 5);
    return true;
}

std::string verdict_text(const Json& words) {
    std::size_t k = 0;
    while (k + 1 < k_verdicts && words != srbf::words(Verdict(k))) ++k;
    return fmt::format("<span class='verdict v{}'>{}</span>", k, field(words));
}

std::string table(const std::vector<Head>& heads, const std::string& rows) {
    const bool is_grouped = std::ranges::any_of(heads, [](const Head& head) { return !head.columns.empty(); });
    std::string html = "<div class='wide'><table><thead><tr>", second;
    for (std::size_t i = 0; i < heads.size(); ++i) {
        const std::size_t count = heads[i].columns.size();
        html += fmt::format("<th scope='col{}'{}{}>{}</th>", count > 0 ? "group" : "", i == 0 ? " class='name'" : "",
                            count > 0    ? fmt::format(" colspan='{}'", count)
                            : is_grouped ? " rowspan='2'"
                                         : "",
                            heads[i].name);
        for (const std::string& name : heads[i].columns) second += fmt::format("<th scope='col'>{}</th>", name);
    }
    if (is_grouped) html += "</tr><tr>" + second;
    return html + "</tr></thead><tbody>\n" + rows + "</tbody></table></div>\n";
}
std::string row(const std::string& head, const std::vector<std::string>& cells, const char* kind) {
    std::string html = fmt::format("<tr class='{}'><th scope='row' class='name'>{}</th>", kind, head);
    for (const std::string& cell : cells) html += fmt::format("<td>{}</td>", cell);
    return html + "</tr>\n";
}
std::string group(const std::string& text, std::size_t columns) {
    return fmt::format("<tr class='group'><th colspan='{}'>{}</th></tr>\n", columns, text);
}

std::string page(const std::string& title, std::string_view body,
                 std::vector<std::pair<std::string_view, std::string>> parts) {
    parts.emplace_back("title", title);
    const std::pair<std::string_view, std::string> whole[] = {{"title", title},
                                                              {"style", k_style_text},
                                                              {"report_style", k_report_style_text},
                                                              {"body", filled(body, parts)},
                                                              {"generator", "Written by srbf " SRBF_VERSION "."}};
    return filled(k_report_page_text, whole);
}

Rows View::done() const { return rows_with(tables.materials, "status", "done"); }
Rows View::fits(const Json& material) const { return rows_with(tables.fits, "material", material["material"]); }
const Json* View::fit_with_role(const Json& material, const std::string& role) const {
    return row_with(fits(material), "role", role);
}

Rows View::pictures(const Json& material, const char* object) const {
    Rows rows = rows_with(tables.pictures, "material", material["material"]);
    std::erase_if(rows, [&](const Json* row) { return row->at("object") != object; });
    return rows;
}

const Json* View::ball(const Json& material, const std::string& role) const {
    return row_with(pictures(material, "ball"), "role", role);
}

Rows View::by_visible_error() const {
    Rows rows = done();
    std::ranges::stable_sort(rows, {}, [&](const Json* material) {
        const Json* fit = fit_with_role(*material, "pm");
        const Json error = fit != nullptr ? fit->at("delta_e_itp") : Json();
        return error.is_number() ? error.get<double>() : std::numeric_limits<double>::infinity();
    });
    return rows;
}

}  // namespace srbf
