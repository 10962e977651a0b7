#include "app/report/parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>

#include "render/html.h"
#include "srbf/file.h"

namespace srbf {

namespace fs = std::filesystem;

std::string number(const Json& value, Shown how) {
    if (!value.is_number()) return "–";
    const double x = value;
    const std::string text = how == Shown::whole     ? grouped(value.get<std::uint64_t>())
                             : how == Shown::percent ? percent(x)
                             : how == Shown::seconds ? fmt::format("{:.2f} s", x)
                                                     : fmt::format("{:.3g}", x);
    return fmt::format("<data value='{}'>{}</data>", field(value), text);
}
std::string number(const Json* row, const std::string& column, Shown how) {
    if (row == nullptr) return "–";
    const auto at = row->find(column);
    return at == row->end() ? "–" : number(*at, how);
}
std::string text_of(const Json& row, const char* column) { return html_escaped(field(row.at(column))); }

std::string title_of(const Json& fit) {
    const std::string model = fit["model"];
    if (model == "su")
        return fit.value("interpolation", "") == "plain" ? "view by view, nearest samples" : "view by view";
    if (model == "ggx") return "GGX and Lambert";
    if (model == "pbr") return "surface of OpenPBR";
    return "multivariate, " + fit["form"].get<std::string>() + (fit["axial"] == true ? "" : ", general lobes");
}
std::string role_title(const std::string& role) {
    if (role == "measured") return "measured";
    if (role == "pm") return "multivariate";
    if (role == "pm2") return "multivariate, cosine";
    return role == "su" ? "view by view" : "GGX";
}
std::string measure_column(const std::string& objective, const Json& input) {
    const Objective named = objective_named(objective).value_or(Objective::cosine);
    if (named == Objective::appearance && input == "table") return "delta_e_itp";
    return fmt::format("heldout_{}", measure_named_for(named).name);
}
std::string link_to(const Json& material) {
    return fmt::format("<a href='#{}'>{}</a>", text_of(material, "folder"), text_of(material, "material"));
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

std::string word(double flip) {
    return fmt::format("<span class='{}'>{}</span>", likeness_word(flip), likeness_word(flip));
}

std::string table(const std::vector<Head>& heads, const std::string& rows) {
    const bool is_grouped = std::ranges::any_of(heads, [](const Head& head) { return !head.of.empty(); });
    std::string html = "<div class='wide'><table><thead><tr>", second;
    for (std::size_t i = 0; i < heads.size(); ++i) {
        const std::size_t columns = heads[i].of.size();
        html += fmt::format("<th scope='col{}'{}{}>{}</th>", columns > 0 ? "group" : "", i == 0 ? " class='name'" : "",
                            columns > 0  ? fmt::format(" colspan='{}'", columns)
                            : is_grouped ? " rowspan='2'"
                                         : "",
                            heads[i].name);
        for (const std::string& name : heads[i].of) second += fmt::format("<th scope='col'>{}</th>", name);
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

std::string picture(const Album& album, const Json& material, const std::string& name, const std::string& alt) {
    const fs::path folder = fs::path(field(material["folder"]));
    const std::string file = html_escaped((folder / (name + ".png")).generic_string());
    const bool is_held = album.is_whole || (name.starts_with("ball-") && !name.ends_with(".difference"));
    const auto bytes = is_held ? read_file((fs::path(album.folder) / folder / (name + ".jpg")).string())
                               : Result<std::vector<std::byte>>(std::vector<std::byte>());
    if (!bytes || bytes->empty()) return fmt::format("<a href='{}'>{}.png</a>", file, html_escaped(name));
    return fmt::format("<a href='{}'><img src='data:image/jpeg;base64,{}' alt='{}'></a>", file, base64(*bytes),
                       html_escaped(alt));
}

Rows View::done() const { return rows_with(tables.materials, "status", "done"); }
Rows View::fits(const Json& material) const { return rows_with(tables.fits, "material", material["material"]); }
const Json* View::drawn(const Json& material, const std::string& role) const {
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

double View::flip(const Json& material) const {
    const Json* of = ball(material, "pm");
    return of != nullptr ? of->at("flip").get<double>() : std::numeric_limits<double>::infinity();
}

Rows View::by_likeness() const {
    Rows rows = done();
    std::ranges::stable_sort(rows, {}, [&](const Json* material) { return flip(*material); });
    return rows;
}

}  // namespace srbf
