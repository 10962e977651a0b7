#include "app/survey/page.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>

#include "render/chart.h"
#include "render/html.h"
#include "render/page_text.h"
#include "render/report_text.h"
#include "srbf/file.h"

namespace srbf {
namespace {

namespace fs = std::filesystem;
using Rows = std::vector<const Json*>;

// ---- Numbers ----

enum class Shown { whole, percent, plain, seconds };

/// A number of a table, and how a reader sees it.
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
Shown shown_as(const MeasureText& measure) { return measure.is_ratio ? Shown::percent : Shown::plain; }
std::string text_of(const Json& row, const char* column) { return html_escaped(field(row.at(column))); }

// ---- Words ----

std::string title_of(const Json& fit) {
    const std::string model = fit["model"];
    if (model == "su")
        return fit.value("interpolation", "") == "plain" ? "view by view, nearest samples" : "view by view";
    if (model == "ggx") return "GGX and Lambert";
    return "multivariate, " + fit["form"].get<std::string>() + (fit["axial"] == true ? "" : ", general lobes");
}
/// What is drawn, in this order.
constexpr const char* k_drawn[] = {"measured", "pm", "pm2", "su", "ggx"};
std::string role_title(const std::string& role) {
    if (role == "measured") return "measured";
    if (role == "pm") return "multivariate";
    if (role == "pm2") return "multivariate, cube-root";
    return role == "su" ? "view by view" : "GGX";
}
/// The measure that an objective minimises.
std::string measure_of(const std::string& objective) {
    if (objective == "raw") return "heldout_squared_error_ratio";
    if (objective == "cube-root") return "heldout_cube_root_error_ratio";
    return objective == "log" ? "heldout_log_rms_cosine" : "heldout_squared_error_ratio_cosine";
}
std::string link_to(const Json& material) {
    return fmt::format("<a href='#{}'>{}</a>", text_of(material, "folder"), text_of(material, "material"));
}
std::string label_of(const Json& material) {
    const std::string label = material["label"];
    return label.empty() ? "" : fmt::format(" <span class='label'>{}</span>", html_escaped(label));
}

// ---- Pictures ----

/// Which pictures the page holds: all, or those of the ball without differences.
struct Album {
    std::string folder;  ///< of the report
    bool is_whole = true;
};

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

/// Whether all pictures fit into the page.
bool fit_into_a_page(const std::vector<Surveyed>& materials) {
    std::uintmax_t bytes = 0;
    for (const Surveyed& of : materials)
        if (of.study)
            for (const auto& entry : fs::directory_iterator(of.study->folder))
                if (entry.path().extension() == ".jpg") bytes += entry.file_size();
    return bytes <= k_most_picture_bytes;
}

// ---- The page's parts ----

/// The tables, and what is looked up in them over and over.
struct View {
    const Tables& tables;
    Album album;

    Rows done() const { return rows_with(tables.materials, "status", "done"); }
    Rows fits(const Json& material) const { return rows_with(tables.fits, "material", material["material"]); }
    /// The fit that is drawn in that role.
    const Json* drawn(const Json& material, const std::string& role) const {
        return row_with(fits(material), "role", role);
    }
    Rows pictures(const Json& material, const char* object) const {
        Rows rows = rows_with(tables.pictures, "material", material["material"]);
        std::erase_if(rows, [&](const Json* row) { return row->at("object") != object; });
        return rows;
    }
    const Json* ball(const Json& material, const std::string& role) const {
        return row_with(pictures(material, "ball"), "role", role);
    }
    double flip(const Json& material) const {
        const Json* of = ball(material, "pm");
        return of != nullptr ? of->at("flip").get<double>() : std::numeric_limits<double>::infinity();
    }
    Rows by_likeness() const {
        Rows rows = done();
        std::ranges::stable_sort(rows, {}, [&](const Json* material) { return flip(*material); });
        return rows;
    }
};

std::string word(double flip) {
    return fmt::format("<span class='{}'>{}</span>", likeness_word(flip), likeness_word(flip));
}

std::string lead_of(const View& view, const std::string& note) {
    std::string html;
    if (!note.empty()) html += fmt::format("<p class='wrong'>{}</p>\n", html_escaped(note));
    const auto count = [&](const char* what) {
        return number(rows_with(view.tables.summary, "what", what)[0], "materials", Shown::whole);
    };
    const Rows done = view.done();
    html += "<p class='lead'>";
    if (done.size() == 1)
        html += fmt::format("The fit looks {}.", word(view.flip(*done[0])));
    else
        html += fmt::format("{} materials; the fit looks {} for {}, {} for {} and {} for {}.", count("done"), word(0),
                            count("alike"), word(k_close), count("close"), word(1), count("differs"));
    // Of the default fits of tables, which are of one size.
    const auto statistics = rows_with(view.tables.statistics, "id", "pm-extended-8x4-cosine");
    if (const Json* of = row_with(statistics, "measure", "heldout_squared_error_ratio_cosine")) {
        const Json* fit = rows_with(view.tables.fits, "id", of->at("id"))[0];
        html += fmt::format(
            " The default fit takes {} bytes where the raw data take {}. The median of its image error is {}, the "
            "worst {} ({}).",
            number(of, "payload_bytes", Shown::whole), number(fit, "raw_bytes", Shown::whole),
            number(of, "median", Shown::percent), number(of, "worst", Shown::percent), text_of(*of, "worst_material"));
    }
    return html + "</p>";
}

std::string failed_of(const View& view) {
    std::string html;
    for (const Json* material : rows_with(view.tables.materials, "status", "failed"))
        html += fmt::format("<li><b>{}</b>{}: {}</li>\n", text_of(*material, "material"), label_of(*material),
                            text_of(*material, "error"));
    if (html.empty()) return html;
    return fmt::format(
        "<div class='wrong' id='failed'>Not in this report, for something is wrong with:<ul>\n{}</ul></div>", html);
}

std::string card_of(const View& view, const Json& material) {
    const Json *measured = view.ball(material, "measured"), *ball = view.ball(material, "pm"),
               *other = view.ball(material, "pm2"), *fit = view.drawn(material, "pm");
    if (measured == nullptr || ball == nullptr || fit == nullptr) return {};
    const std::string name = field(material["material"]);
    const auto minimised = std::ranges::find(k_measure_texts, measure_of(fit->at("objective")),
                                             [](const MeasureText& measure) { return std::string(measure.column); });
    return fmt::format(
        "<article class='card'><div class='pair'>{}{}<small>measured</small><small>{} "
        "bytes</small></div>\n<p>{}{}</p>\n"
        "<p>{}, ꟻLIP {}{}</p>\n<p>{} {}</p></article>\n",
        picture(view.album, material, field(measured->at("picture")), name + ", measured"),
        picture(view.album, material, field(ball->at("picture")), name + ", fitted"),
        number(fit, "payload_bytes", Shown::whole), link_to(material), label_of(material), word(view.flip(material)),
        number(ball, "flip", Shown::plain),
        other == nullptr ? "" : fmt::format("; {} by cube-root", number(other, "flip", Shown::plain)), minimised->title,
        number(fit, minimised->column, shown_as(*minimised)));
}

/// A column, or several of a common name.
struct Head {
    std::string name;
    std::vector<std::string> of;
};
/// A table whose first column is a name.
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
std::string row(const std::string& head, const std::vector<std::string>& cells, const char* kind = "") {
    std::string html = fmt::format("<tr class='{}'><th scope='row' class='name'>{}</th>", kind, head);
    for (const std::string& cell : cells) html += fmt::format("<td>{}</td>", cell);
    return html + "</tr>\n";
}
std::string group(const std::string& text, std::size_t columns) {
    return fmt::format("<tr class='group'><th colspan='{}'>{}</th></tr>\n", columns, text);
}

/// The three models that are compared throughout.
constexpr const char* k_compared[] = {"pm", "su", "ggx"};
const std::vector<std::string> k_compared_names{"multi­variate", "view by view", "GGX"};

std::string all_of(const View& view) {
    std::string rows;
    for (const Json* material : view.by_likeness()) {
        std::vector<std::string> cells;
        for (const char* role : k_compared) cells.push_back(number(view.ball(*material, role), "flip", Shown::plain));
        for (const char* column : {"heldout_squared_error_ratio_cosine", "heldout_cube_root_error_ratio"})
            for (const char* role : k_compared)
                cells.push_back(number(view.drawn(*material, role), column, Shown::percent));
        const Json* fit = view.drawn(*material, "pm");
        cells.push_back(number(fit, "albedo_error", Shown::percent));
        cells.push_back(number(fit, "payload_bytes", Shown::whole));
        cells.push_back(number(fit, "fit_seconds", Shown::seconds));
        cells.push_back(number(material, "masked_samples", Shown::whole));
        cells.push_back(number(material, "clamped_samples", Shown::whole));
        rows += row(link_to(*material) + label_of(*material), cells);
    }
    return table({{"material", {}},
                  {"ꟻLIP", k_compared_names},
                  {"image error", k_compared_names},
                  {"dark-part error", k_compared_names},
                  {"multivariate", {"albedo error", "bytes", "seconds"}},
                  {"samples", {"masked", "clamped"}}},
                 rows) +
           "<p class='note'>masked: pairs of directions that a fit looked at and that were not measured, left out; "
           "clamped: "
           "negative values of saturated colours, set to 0.</p>";
}

/// Whether a fit stands in the source's Table 7.1 anew, beside all that the sweep has.
bool is_of_table(const Json& fit) {
    const std::string model = fit["model"];
    const int lobes = fit["lobes"], variates = fit["variates"];
    if (model == "pm") return (lobes == 6 && variates == 3) || (variates == 4 && (lobes == 6 || lobes == 8));
    if (model == "su") return lobes == (fit["input"] == "samples" ? 4 : 5);
    return true;
}

/// What is told of a measure's values over materials.
constexpr const char* k_spread[] = {"mean", "median", "percentile_95", "worst"};
const std::vector<std::string> k_spread_names{"mean", "median", "95 % below", "worst"};

const char* input_title(const std::string& input) { return input == "table" ? "Tables" : "Scattered samples"; }

/// The statistics of the fits with that id, a row for each measure.
Rows statistics_of(const View& view, const std::string& input, const std::string& id) {
    Rows rows = rows_with(view.tables.statistics, "id", id);
    std::erase_if(rows, [&](const Json* row) { return row->at("input") != input || row->at("materials") < 2; });
    return rows;
}

/// The models that are compared, over all materials of a kind: each measure a row.
std::string spread_of_compared(const View& view, const std::string& input) {
    std::vector<Rows> models;
    for (const char* role : k_compared) {
        const Json* fit = row_with(rows_with(view.tables.fits, "input", input), "role", role);
        models.push_back(fit == nullptr ? Rows() : statistics_of(view, input, fit->at("id")));
    }
    std::string rows;
    for (const MeasureText& measure : k_measure_texts) {
        std::vector<std::string> cells;
        for (const Rows& model : models)
            for (const char* what : k_spread)
                cells.push_back(number(row_with(model, "measure", measure.column), what, shown_as(measure)));
        rows += row(measure.title, cells);
    }
    if (models[0].empty()) return {};
    std::vector<Head> heads{{"error", {}}};
    for (const std::string& name : k_compared_names) heads.push_back({name, k_spread_names});
    return fmt::format("<h3>{}: {} materials</h3>\n", input_title(input),
                       number(models[0][0], "materials", Shown::whole)) +
           table(heads, rows);
}

/// Fits of all kinds of one objective over all materials of a kind.
std::string spread_of_all(const View& view, const std::string& input, const std::string& objective) {
    std::vector<std::string> ids;
    for (const Json& of : view.tables.statistics.rows)
        if (of["input"] == input && of["objective"] == objective && is_of_table(of) &&
            std::ranges::find(ids, of["id"].get<std::string>()) == ids.end())
            ids.push_back(of["id"]);
    std::string rows, theta;
    for (const std::string& id : ids) {
        const Rows statistics = statistics_of(view, input, id);
        if (statistics.empty()) continue;
        std::vector<std::string> cells{number(statistics[0], "lobes", Shown::whole),
                                       number(statistics[0], "variates", Shown::whole),
                                       number(statistics[0], "payload_bytes", Shown::whole)};
        for (const MeasureText& measure : k_measure_texts)
            for (const char* what : k_spread) {
                const std::string cell =
                    number(row_with(statistics, "measure", measure.column), what, shown_as(measure));
                cells.push_back(measure.column == measure_of(objective) ? "<b>" + cell + "</b>" : cell);
            }
        theta = number(statistics[0], "max_theta", Shown::plain);
        rows += row(html_escaped(title_of(*row_with(rows_with(view.tables.fits, "input", input), "id", id))), cells);
    }
    if (rows.empty()) return rows;
    std::vector<Head> heads{{"model", {}}, {"J", {}}, {"N", {}}, {"bytes", {}}};
    for (const MeasureText& measure : k_measure_texts) heads.push_back({measure.title, k_spread_names});
    return fmt::format(
        "<details><summary>{}: all models fitted with the objective {}, directions within {}°</summary>{}</details>\n",
        input_title(input), objective, theta, table(heads, rows));
}

std::string spread_of(const View& view) {
    std::string html;
    for (const char* input : {"table", "samples"}) {
        html += spread_of_compared(view, input);
        for (const char* objective : {"raw", "cosine", "cube-root"}) html += spread_of_all(view, input, objective);
    }
    return html.empty() ? "<p>There is but one material of a kind.</p>" : html;
}

std::string measures_of() {
    std::string html = "<dl>\n";
    for (const MeasureText& measure : k_measure_texts)
        html += fmt::format("<dt>{}</dt> <dd>{} <small>({})</small></dd>\n", measure.title, measure.meaning,
                            measure.column);
    html +=
        "<dt>ꟻLIP</dt> <dd>The mean over a picture of how visible the difference to the measured one is, from 0 to 1 "
        "(Andersson et al. 2020).</dd>\n"
        "<dt>PSNR, SSIM</dt> <dd>Of the same pictures: signal over error in dB, and structural similarity, 1 where "
        "they are "
        "equal.</dd>\n";
    return html +
           "</dl>\n<p class='note'>Ratios are squares: an image error of 1 % is a typical deviation of a tenth of what "
           "is bright. "
           "f is the measured reflectance [1/sr], f̂ the fitted one, with its numbers rounded to 16 bits as they are "
           "stored. Held "
           "out means at 200,000 pairs of directions that the fit has not seen; of scattered samples, 5-fold "
           "cross-validated. The "
           "matrix of a view-by-view model is its own sampled views.</p>";
}

// ---- One material ----

std::string pictures_of(const View& view, const Json& material) {
    std::string html;
    for (const auto& [object, what] : {std::pair("ball", "Ball"), {"mesh", "Mesh"}}) {
        std::string figures;
        for (const char* role : k_drawn) {
            const Json* of = row_with(view.pictures(material, object), "role", role);
            if (of == nullptr) continue;
            const Json* fit = view.drawn(material, role);
            figures += fmt::format(
                "<figure>{}<figcaption><b>{}</b>{}</figcaption>",
                picture(view.album, material, field(of->at("picture")), role_title(role)),
                html_escaped(role_title(role)),
                fit == nullptr ? "" : fmt::format(", {} bytes", number(fit, "payload_bytes", Shown::whole)));
            if (of->contains("difference"))
                figures += fmt::format(
                    "{}<figcaption>ꟻLIP {}, PSNR {} dB, SSIM {}</figcaption>",
                    picture(view.album, material, field(of->at("difference")), role_title(role) + ", difference"),
                    number(of, "flip", Shown::plain), number(of, "psnr", Shown::plain),
                    number(of, "ssim", Shown::plain));
            figures += "</figure>\n";
        }
        html += fmt::format("<h3>{}</h3>\n<div class='row'>\n{}</div>\n", what, figures);
    }
    return html +
           "<p class='note'>Under each fit: where it differs visibly from the measured picture (ꟻLIP), from black, not "
           "at all, to "
           "pale yellow.</p>\n";
}

std::vector<std::string> fit_cells(const Json& fit) {
    std::vector<std::string> cells{number(&fit, "lobes", Shown::whole), number(&fit, "variates", Shown::whole),
                                   number(&fit, "payload_bytes", Shown::whole)};
    const std::string minimised = measure_of(fit["objective"]);
    for (const MeasureText& measure : k_measure_texts) {
        const std::string cell = number(&fit, measure.column, shown_as(measure));
        cells.push_back(measure.column == minimised ? "<b>" + cell + "</b>" : cell);
    }
    cells.push_back(number(&fit, "fit_seconds", Shown::seconds));
    return cells;
}

/// The source's rows of its own material, after a line that says what was minimised.
std::string source_rows(const View& view, const Json& material, std::size_t columns) {
    std::string html;
    for (const Json* of : rows_with(view.tables.source, "material", material["source_material"])) {
        std::vector<std::string> cells{number(of, "lobes", Shown::whole), number(of, "variates", Shown::whole),
                                       number(of, "payload_bytes", Shown::whole)};
        for (const MeasureText& measure : k_measure_texts)
            cells.push_back(std::string_view(measure.column) == "squared_error_ratio"
                                ? number(of, measure.column, Shown::percent)
                                : "–");
        cells.push_back(fmt::format("{} to {} min", number(of, "least_minutes", Shown::whole),
                                    number(of, "most_minutes", Shown::whole)));
        html += row(of->at("model") == "su" ? "Tsai 2009, view by view" : "Tsai 2009, multivariate", cells, "tsai");
    }
    return html.empty() ? html : group("the source: objective raw, its own matrix of this material", columns) + html;
}

std::string errors_of(const View& view, const Json& material, bool whole) {
    std::vector<Head> heads{{"model", {}}, {"J", {}}, {"N", {}}, {"bytes", {}}};
    for (const MeasureText& measure : k_measure_texts) {
        const bool at_samples =
            std::string_view(measure.column) == "squared_error_ratio" && material["input"] == "samples";
        heads.push_back({at_samples ? "raw error, at the samples" : measure.title, {}});
    }
    heads.push_back({"seconds", {}});
    std::string rows = whole ? "" : source_rows(view, material, heads.size());
    for (const char* objective : {"raw", "cosine", "cube-root"}) {
        std::string of_objective;
        Json theta;
        for (const Json* fit : view.fits(material)) {
            if (fit->at("objective") != objective || !(whole || is_of_table(*fit))) continue;
            theta = fit->at("max_theta");
            of_objective += row(html_escaped(title_of(*fit)), fit_cells(*fit));
        }
        if (of_objective.empty()) continue;
        rows += group(fmt::format("objective {}, directions within {}°", objective, number(theta, Shown::plain)),
                      heads.size());
        rows += of_objective;
    }
    return table(heads, rows);
}

/// What a chart's lines are: a model, a form, a number of variates.
struct Line {
    const char *name, *model, *form, *colour, *dash;
    int variates;
};
constexpr Line k_lines[] = {
    {"view by view", "su", "source", "--su", "", 1},
    {"source's form, N = 2", "pm", "source", "--source", "1 3", 2},
    {"source's form, N = 3", "pm", "source", "--source", "5 3", 3},
    {"source's form, N = 4", "pm", "source", "--source", "", 4},
    {"horizon, N = 2", "pm", "horizon", "--horizon", "1 3", 2},
    {"horizon, N = 3", "pm", "horizon", "--horizon", "5 3", 3},
    {"horizon, N = 4", "pm", "horizon", "--horizon", "", 4},
    {"extended, N = 2", "pm", "extended", "--extended", "1 3", 2},
    {"extended, N = 3", "pm", "extended", "--extended", "5 3", 3},
    {"extended, N = 4", "pm", "extended", "--extended", "", 4},
};

/// The fits of a line, with the objective that the charts are of.
Rows of_line(const View& view, const Json& material, const Line& line, const std::string& objective) {
    Rows rows = view.fits(material);
    std::erase_if(rows, [&](const Json* fit) {
        return fit->at("model") != line.model || fit->at("objective") != objective ||
               fit->at("variates") != line.variates || (fit->at("model") == "pm" && fit->at("form") != line.form) ||
               fit->value("interpolation", "") == "plain";
    });
    return rows;
}

std::string charts_of(const View& view, const Json& material) {
    const bool is_table = material["input"] == "table";
    const std::string objective = is_table ? "raw" : "cube-root", measure = measure_of(objective);
    const char* title = is_table ? "Raw error, held out" : "Dark-part error, held out";
    Chart over_lobes{fmt::format("{}, over the number of lobes J", title), "J", {1, 2, 3, 4, 6, 8, 12, 16}, {}},
        over_bytes{fmt::format("{}, over bytes", title), "bytes", {}, {}};
    double least_lobes = k_most_view_lobes, most_lobes = 0;
    std::string legend;
    const auto add = [&](const std::string& name, const char* colour, const char* dash, const Rows& rows) {
        const std::string css = fmt::format("var({})", colour);
        ChartSeries lobes{name, css, dash, true, {}}, bytes{name, css, dash, true, {}};
        for (const Json* fit : rows) {
            if (!fit->at(measure).is_number()) continue;
            const double error = fit->at(measure), j = fit->at("lobes"), size = fit->at("payload_bytes");
            const std::string text = fmt::format("{}: {}", field(fit->at("id")), field(fit->at(measure)));
            lobes.points.push_back({j, error, text});
            bytes.points.push_back({size, error, text});
            if (fit->at("model") != "ggx") least_lobes = std::min(least_lobes, j), most_lobes = std::max(most_lobes, j);
        }
        if (lobes.points.empty()) return;
        legend += fmt::format(
            "<span><svg class='key' viewBox='0 0 24 8'><path d='M0 4H24' stroke-width='2.5' "
            "style='stroke:{}' stroke-dasharray='{}'/></svg>{}</span> ",
            css, std::string_view(dash).empty() ? "none" : dash, html_escaped(name));
        if (rows[0]->at("model") != "ggx") over_lobes.series.push_back(std::move(lobes));
        over_bytes.series.push_back(std::move(bytes));
    };
    for (const Line& line : k_lines) add(line.name, line.colour, line.dash, of_line(view, material, line, objective));
    add("GGX and Lambert", "--ggx", "", of_line(view, material, {"", "ggx", "", "", "", 1}, objective));
    std::erase_if(over_lobes.x_ticks, [&](double tick) { return tick < least_lobes || tick > most_lobes; });
    return fmt::format("<p class='legend'>{}</p>\n<div class='charts'>{}{}</div>\n", legend, chart_drawing(over_lobes),
                       chart_drawing(over_bytes));
}

std::string frames_of(const View& view, const Json& material) {
    const Rows rows = rows_with(view.tables.frames, "material", material["material"]);
    if (rows.empty()) return fmt::format("<p>No frames were timed: {}</p>\n", text_of(material, "frames_error"));
    std::string html;
    const Rows fits = view.fits(material);
    for (const Json* of : rows) {
        const Json* fit = row_with(fits, "id", of->at("id"));
        const std::string name =
            fit == nullptr ? "a constant, for comparison"
                           : title_of(*fit) + (of->at("drawn") == "by index texture" ? ", by index texture" : "");
        html += row(html_escaped(name),
                    {number(fit, "lobes", Shown::whole), number(fit, "variates", Shown::whole),
                     number(of, "data_bytes", Shown::whole), number(of, "auxiliary_bytes", Shown::whole),
                     number(of, "total_bytes", Shown::whole), number(of, "frames_per_second", Shown::plain)});
    }
    for (const Json* of : rows_with(view.tables.source, "material", material["source_material"]))
        html += row(fmt::format("Tsai 2009, {}, {}", of->at("model") == "su" ? "view by view" : "multivariate",
                                text_of(*of, "renderer")),
                    {number(of, "lobes", Shown::whole), number(of, "variates", Shown::whole),
                     number(of, "payload_bytes", Shown::whole), number(of, "auxiliary_bytes", Shown::whole), "–",
                     fmt::format("{} to {}", number(of, "least_frames_per_second", Shown::whole),
                                 number(of, "most_frames_per_second", Shown::whole))},
                    "tsai");
    const Json& first = *rows[0];
    return table({{"model", {}},
                  {"J", {}},
                  {"N", {}},
                  {"bytes looked up", {}},
                  {"auxiliary bytes", {}},
                  {"bytes in all", {}},
                  {"frames a second", {}}},
                 html) +
           fmt::format(
               "<p class='note'>The fastest of {} frames of {} × {} pixels, three directional lights, the mesh {} ({} "
               "triangles), by {}.</p>\n",
               number(&first, "frames", Shown::whole), number(&first, "width", Shown::whole),
               number(&first, "height", Shown::whole), text_of(first, "mesh"),
               number(&first, "triangles", Shown::whole), text_of(first, "renderer"));
}

std::string lobes_of(const View& view, const Json& material, const Study& study) {
    std::string linear, logarithmic, legend;
    for (const char* role : k_drawn) {
        if (view.ball(material, role) == nullptr) continue;
        legend += fmt::format(
            "<span><svg class='key' viewBox='0 0 24 8'><path d='M0 4H24' stroke-width='3' "
            "style='stroke:var(--{})'/></svg>{}</span> ",
            role, html_escaped(role_title(role)));
    }
    for (const Json& of : study.material.at("lobes"))
        linear += of["linear"].get<std::string>(), logarithmic += of["logarithmic"].get<std::string>();
    return fmt::format(
        "<p>How bright the surface is from each side, as the distance from the point that the light falls on; the "
        "thick line is "
        "measured.</p><p class='legend'>{}</p>\n<div class='polar'>{}</div>\n<div class='polar'>{}</div>\n",
        legend, linear, logarithmic);
}

std::string material_of(const View& view, const Json& material, const Study& study) {
    std::string html = fmt::format("<section id='{}'>\n<h2>{}{} <a class='back' href='#contents'>contents</a></h2>\n",
                                   text_of(material, "folder"), text_of(material, "material"), label_of(material));
    const Json* fit = view.fits(material)[0];
    html += fmt::format(
        "<p>{}, a file of {} bytes; {}, {} bytes. {} fits; masked {}, clamped {}. Models, pictures and the lobes' "
        "numbers are "
        "in <a href='{}/'>{}</a>.</p>\n",
        text_of(material, "format"), number(&material, "source_bytes", Shown::whole),
        material["input"] == "samples" ? number(fit, "samples", Shown::whole) + " samples as RGB floats"
                                       : "the source's raw data, 1536 × 1536 pairs of directions as RGB floats",
        number(fit, "raw_bytes", Shown::whole), number(&material, "fits", Shown::whole),
        number(&material, "masked_samples", Shown::whole), number(&material, "clamped_samples", Shown::whole),
        text_of(material, "folder"), text_of(material, "folder"));
    for (const Json* failure : rows_with(view.tables.failures, "material", material["material"]))
        html +=
            fmt::format("<p class='wrong'>{} failed: {}</p>\n", text_of(*failure, "id"), text_of(*failure, "error"));
    html += pictures_of(view, material);
    html += "<h3>Sizes, errors, seconds</h3>\n" + errors_of(view, material, false);
    if (!field(material["source_material"]).empty())
        html += material["input"] == "samples"
                    ? "<p class='note'>Tsai 2009 resampled the samples to a matrix of 1536 × 1536 pairs; its error is "
                      "against that "
                      "interpolation. Ours are at the samples themselves, and held out.</p>\n"
                    : "<p class='note'>Tsai 2009 fitted the same material, resampled in its own way.</p>\n";
    html += "<h3>Error over lobes and bytes</h3>\n" + charts_of(view, material);
    html += "<h3>Lobes</h3>\n" + lobes_of(view, material, study);
    html += "<h3>Bytes and frames a second</h3>\n" + frames_of(view, material);
    html += fmt::format("<details><summary>All {} fits</summary>{}</details>\n",
                        number(&material, "fits", Shown::whole), errors_of(view, material, true));
    return html + "</section>\n";
}

std::string made_of(const View& view) {
    const Rows done = view.done();
    std::string html;
    if (!done.empty()) {
        const Json& of = *done[0];
        html += fmt::format(
            "<p>Seconds are wall-clock time of one fit on {} threads, reading the file not included, of scattered "
            "samples with all the fits of cross-validation; materials at work at a time: {}. "
            "Pictures are path-traced, {} × {} pixels, {} paths each, under the bundled studio light, all of one "
            "material at one exposure and "
            "with one seed; frames were timed after all fits, one material at a time.</p>\n",
            number(&of, "threads", Shown::whole), number(&of, "jobs", Shown::whole),
            number(&of, "pixels", Shown::whole), number(&of, "pixels", Shown::whole),
            number(&of, "paths", Shown::whole));
    }
    html += "<p>Every number of this page is in the files beside it, as ratios, not per cent: ";
    for (const Table* table : view.tables.all()) html += fmt::format("<a href='{0}.csv'>{0}.csv</a> ", table->name);
    return html +
           "and accuracy.md. The source is Y.-T. Tsai, Parametric Representations and Tensor Approximation Algorithms "
           "for "
           "Real-Time Data-Driven Rendering, NCTU 2009, section 7.2.</p>";
}

}  // namespace

std::string survey_html(const std::vector<Surveyed>& materials, const Tables& tables, const std::string& note) {
    View view{tables, {"", fit_into_a_page(materials)}};
    std::string cards, sections, links;
    for (const Surveyed& of : materials)
        if (of.study) view.album.folder = fs::path(of.study->folder).parent_path().string();
    for (const Json* material : view.by_likeness()) {
        cards += card_of(view, *material);
        if (!links.empty()) links += ", ";
        links += link_to(*material);
        const auto of = std::ranges::find(materials, field(material->at("material")), &Surveyed::name);
        sections += material_of(view, *material, *of->study);
    }
    const std::string title =
        materials.size() == 1 ? materials[0].name + ": measured and fitted" : "Measured materials and their fits";
    const std::pair<std::string_view, std::string> parts[] = {
        {"title", html_escaped(title)},
        {"style", k_style_text},
        {"report_style", k_report_style_text},
        {"lead", lead_of(view, note)},
        {"failed", failed_of(view)},
        {"default_fit", "the default fit (of scattered samples: six lobes, objective cube-root)"},
        {"cards", cards},
        {"links", links},
        {"all", all_of(view)},
        {"spread", spread_of(view)},
        {"measures", measures_of()},
        {"materials", sections},
        {"made", made_of(view)},
        {"generator",
         "Written by srbf " SRBF_VERSION ". This page is one file; its links lead to what lies beside it."},
    };
    return filled(k_report_text, parts);
}

}  // namespace srbf
