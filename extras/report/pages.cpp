#include "extras/report/pages.h"

#include <fmt/format.h>

#include "app/html.h"
#include "base/printable.h"
#include "errors/picture_errors.h"
#include "errors/sphere.h"
#include "extras/render/chart.h"
#include "fit/request_traits.h"
#include "generated/render/page_text.h"
#include "generated/report/report_text.h"
#include "observe/pair_weights.h"
#include "srbf/metrics.h"

namespace SRBF_NAMESPACE {
namespace {

// ---- Numbers and words ----

enum class NumberFormat { whole, percent, plain, seconds };
/// A number as HTML, `<data value='FIELD'>TEXT</data>` with its field in a table; "–" if it is missing.
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
/// A field as HTML.
std::string cell_html(const Json& row, const char* column) { return html_escaped(field(row.at(column))); }

/// The title of a fit: "multivariate, extended".
std::string title_of(const Json& fit) {
    const std::string model = fit["model"];
    if (model == "su")
        return fit.value("interpolation", "") == "plain" ? "view by view, nearest views" : "view by view";
    if (model == "ggx") return "GGX and Lambert";
    if (model == "openpbr") return "OpenPBR Surface";
    return "multivariate, " + fit["form"].get<std::string>() + (fit["axial"] == true ? "" : ", general lobes");
}
/// The roles of the drawn subjects, in the order of the page, and their titles.
constexpr const char* k_roles[] = {"measured", "pm", "pm2", "su", "ggx"};
std::string role_title(const std::string& role) {
    if (role == "measured") return "measured";
    if (role == "pm") return "multivariate";
    if (role == "pm2") return "multivariate, cosine";
    return role == "su" ? "view by view" : "GGX";
}
/// The column of the measure by which fits with an objective are judged, for the input "table" or "samples"; held
/// out if the measure is one over directions.
std::string measure_column(const std::string& objective, const Json& input) {
    const Objective objective_value = objective_named(objective).value_or(Objective::cosine);
    if (objective_value == Objective::appearance && input == "table") return "delta_e_itp";
    return fmt::format("heldout_{}", measure_named_for(objective_value).name);
}
NumberFormat format_of(const MeasureText& measure) {
    return measure.is_ratio ? NumberFormat::percent : NumberFormat::plain;
}
/// The name of a material as a link to its page.
std::string link_to(const Json& material) {
    return fmt::format("<a href='{}/index.html'>{}</a>", cell_html(material, "folder"),
                       cell_html(material, "material"));
}
/// True if a fit corresponds to one in Table 7.1 of Tsai 2009.
bool is_of_table(const Json& fit) {
    const std::string model = fit["model"];
    const int lobes = fit["lobes"], variates = fit["variates"];
    if (model == "pm") return (lobes == 6 && variates == 3) || (variates == 4 && (lobes == 6 || lobes == 8));
    if (model == "su") return lobes == (fit["input"] == "samples" ? 4 : 5);
    return true;
}

/// A verdict with its colour.
std::string verdict_text(const Json& words) {
    std::size_t k = 0;
    while (k + 1 < k_verdicts && words != srbf::name(Verdict(k))) ++k;
    return fmt::format("<span class='verdict v{}'>{}</span>", k, field(words));
}

// ---- Tables and pages ----

/// A column, or a group of columns with a common name.
struct Heading {
    std::string name;
    std::vector<std::string> columns = {};
};
/// A table whose first column contains names.
std::string table(const std::vector<Heading>& headings, const std::string& rows) {
    const bool is_grouped =
        std::ranges::any_of(headings, [](const Heading& heading) { return !heading.columns.empty(); });
    std::string html = "<div class='wide'><table><thead><tr>", second;
    for (std::size_t i = 0; i < headings.size(); ++i) {
        const std::size_t count = headings[i].columns.size();
        html += fmt::format("<th scope='col{}'{}{}>{}</th>", count > 0 ? "group" : "", i == 0 ? " class='name'" : "",
                            count > 0    ? fmt::format(" colspan='{}'", count)
                            : is_grouped ? " rowspan='2'"
                                         : "",
                            headings[i].name);
        for (const std::string& name : headings[i].columns) second += fmt::format("<th scope='col'>{}</th>", name);
    }
    if (is_grouped) html += "</tr><tr>" + second;
    return html + "</tr></thead><tbody>\n" + rows + "</tbody></table></div>\n";
}
std::string row(const std::string& head, const std::vector<std::string>& cells, const char* kind = "") {
    std::string html = fmt::format("<tr class='{}'><th scope='row' class='name'>{}</th>", kind, head);
    for (const std::string& cell : cells) html += fmt::format("<td>{}</td>", cell);
    return html + "</tr>\n";
}
/// A row that describes the rows below it.
std::string group(const std::string& text, std::size_t columns) {
    return fmt::format("<tr class='group'><th colspan='{}'>{}</th></tr>\n", columns, text);
}

/// A page. The title is HTML.
std::string page(const std::string& title, const std::string& body) {
    const std::pair<std::string_view, std::string> parts[] = {
        {"title", title},
        {"style", std::string(k_style_text) + k_report_style_text},
        {"body", fmt::format("<h1>{}</h1>\n{}", title, body)},
        {"generator", "Written by srbf " SRBF_VERSION "."},
        {"scripts", ""}};
    return filled(k_frame_text, parts);
}
std::string section(const std::string& title, const std::string& html) {
    return fmt::format("<h2>{}</h2>\n{}\n", title, html);
}

// ---- Lookups ----

Rows fits_of(const Tables& tables, const Json& material) {
    return rows_with(tables.fits, "material", material["material"]);
}
const Json* picture_of(const Tables& tables, const Json& material, const char* object, const char* role) {
    Rows rows = rows_with(tables.pictures, "material", material["material"]);
    std::erase_if(rows, [&](const Json* row) { return row->at("object") != object; });
    return row_with(rows, "role", role);
}

// ---- The first page ----

std::string lead_html(const Tables& tables) {
    std::string counts;
    for (std::size_t k = 0; k < k_verdicts; ++k)
        if (const auto rows = rows_with(tables.materials, "verdict", name(Verdict(k))); !rows.empty())
            counts +=
                fmt::format("{}{} for {}", counts.empty() ? "" : ", ", verdict_text(name(Verdict(k))), rows.size());
    return counts.empty() ? "" : fmt::format("<p>The difference between measurement and fit is {}.</p>\n", counts);
}

std::string failed_of(const Tables& tables) {
    std::string html;
    for (const Json* material : rows_with(tables.materials, "status", "failed"))
        html +=
            fmt::format("<li><b>{}</b>: {}</li>\n", cell_html(*material, "material"), cell_html(*material, "error"));
    if (html.empty()) return html;
    return fmt::format("<div class='wrong'>Not shown because of errors:<ul>\n{}</ul></div>\n", html);
}

std::string card_of(const Tables& tables, const Json& material) {
    const Json* fit = fit_with_role(tables, material, "pm");
    if (fit == nullptr) return {};
    std::string figures;
    for (const char* role : {"measured", "pm", "ggx"})
        if (const Json* ball = picture_of(tables, material, "ball", role))
            figures +=
                fmt::format("<figure><img src='{}/{}.jpg' alt='{}' loading='lazy'><figcaption>{}</figcaption></figure>",
                            cell_html(material, "folder"), cell_html(*ball, "picture"), role_title(role),
                            role == std::string_view("pm") ? "fitted" : role_title(role));
    const Json& error = fit->at("delta_e_itp");
    return fmt::format(
        "<article class='card' data-error='{}' data-name='{}' data-kind='{}'>\n<a href='{}/index.html'>{}</a>\n"
        "<p>{}</p>\n<p>{}{}</p>\n<p>{}, {} bytes; fitted {} bytes</p></article>\n",
        error.is_number() ? field(error) : "1e9", cell_html(material, "material"), cell_html(material, "format"),
        cell_html(material, "folder"), figures, link_to(material), verdict_text(material["verdict"]),
        error.is_number() ? ": ΔE_ITP " + number(error, NumberFormat::plain) : "", cell_html(material, "format"),
        number(&material, "source_bytes", NumberFormat::whole), number(fit, "payload_bytes", NumberFormat::whole));
}

/// The verdicts with their limits: "hardly visible up to a ΔE_ITP of 1 and a ꟻLIP of 0.03, ..."
std::string verdicts_text() {
    std::string text;
    for (std::size_t k = 0; k < k_verdict_limits.size(); ++k)
        text += fmt::format("{} up to {:g} and {:g}, ", verdict_text(name(Verdict(k))), k_verdict_limits[k].delta_e,
                            k_verdict_limits[k].flip);
    return text + verdict_text(name(Verdict::visible_at_once)) + " above";
}

/// The roles of the three models that are compared.
constexpr const char* k_compared[] = {"pm", "su", "ggx"};
const std::vector<std::string> k_compared_names{"multi­variate", "view by view", "GGX"};

std::string materials_table(const Tables& tables) {
    std::string rows;
    for (const Json* material : by_visible_error(tables)) {
        std::vector<std::string> cells;
        for (const char* role : k_compared)
            cells.push_back(number(picture_of(tables, *material, "ball", role), "flip", NumberFormat::plain));
        for (const char* column : {"heldout_squared_error_ratio_cosine", "heldout_cube_root_error_ratio"})
            for (const char* role : k_compared)
                cells.push_back(number(fit_with_role(tables, *material, role), column, NumberFormat::percent));
        const Json* fit = fit_with_role(tables, *material, "pm");
        for (const auto& [column, as] : {std::pair("albedo_error", NumberFormat::percent),
                                         {"payload_bytes", NumberFormat::whole},
                                         {"fit_seconds", NumberFormat::seconds}})
            cells.push_back(number(fit, column, as));
        for (const char* column : {"masked_samples", "clamped_samples"})
            cells.push_back(number(material, column, NumberFormat::whole));
        rows += row(link_to(*material), cells);
    }
    return table({{"material"},
                  {"ꟻLIP", k_compared_names},
                  {"image error", k_compared_names},
                  {"dark-part error", k_compared_names},
                  {"multivariate", {"albedo error", "bytes", "seconds"}},
                  {"samples", {"masked", "clamped"}}},
                 rows) +
           "<p class='note'>masked: pairs of directions that were not measured and are skipped; clamped: negative "
           "values "
           "of saturated colours, set to 0. For scattered samples, a single bright sample that the others do not "
           "predict "
           "may dominate the held-out error.</p>";
}

std::string measures_html(const Tables& tables) {
    std::string html = "<dl>\n";
    for (const MeasureText& measure : k_measure_texts)
        html += fmt::format("<dt>{}</dt> <dd>{} <small>({})</small></dd>\n", measure.title, measure.meaning,
                            measure.column);
    html +=
        "<dt>ꟻLIP</dt> <dd>The mean visibility of the difference from the measured picture, from 0 to 1 "
        "(Andersson et al. 2020).</dd>\n"
        "<dt>PSNR, SSIM</dt> <dd>Signal to error in dB, and structural similarity of the same pictures, which is 1 if "
        "they are equal.</dd>\n</dl>\n"
        "<p class='note'>Ratios are squares: an image error of 1 % is a typical deviation of a tenth of the "
        "brightness. "
        "f is the measured reflectance [1/sr], f̂ the fitted one, with numbers rounded to 16 bits as they are stored. "
        "Held out means at pairs of directions that the fit has not used; for scattered samples, cross-validated. A "
        "fit "
        "minimises its objective: <i>appearance</i> the visible error, <i>raw</i> the raw error, <i>cosine</i> the "
        "image "
        "error, <i>cube-root</i> the dark-part error. ";
    if (const Rows done = rows_with(tables.materials, "status", "done"); !done.empty())
        html += fmt::format(
            "Seconds are the wall-clock time of one fit on {} threads, with {} materials at a time. Pictures are "
            "path-traced, {} × {} pixels, {} paths each, all of one material at one exposure and with one seed. ",
            field(done[0]->at("threads")), field(done[0]->at("jobs")), field(done[0]->at("pixels")),
            field(done[0]->at("pixels")), field(done[0]->at("paths")));
    html += "Every number is in the files beside this page, as a ratio instead of per cent: ";
    for (const Table* each : tables.all()) html += fmt::format("<a href='{0}.csv'>{0}.csv</a> ", each->name);
    return html +
           "The source is Y.-T. Tsai, Parametric Representations and Tensor Approximation Algorithms for Real-Time "
           "Data-Driven Rendering, NCTU 2009, section 7.2.</p>";
}

// ---- The page of a material ----

/// A picture in the material's folder: its small form, with a link to the large one.
std::string picture(const Json& row, const char* column, const std::string& alt) {
    return fmt::format("<a href='{0}.png'><img src='{0}.jpg' alt='{1}'></a>", cell_html(row, column),
                       html_escaped(alt));
}

std::string pictures_of(const Tables& tables, const Json& material) {
    std::string html;
    for (const auto& [object, title] : {std::pair("ball", "Ball"), {"mesh", "Mesh"}}) {
        std::string figures;
        for (const char* role : k_roles) {
            const Json *drawn = picture_of(tables, material, object, role),
                       *fit = fit_with_role(tables, material, role);
            if (drawn == nullptr) continue;
            figures += fmt::format(
                "<figure>{}<figcaption><b>{}</b>{}</figcaption>", picture(*drawn, "picture", role_title(role)),
                role_title(role),
                fit == nullptr ? "" : fmt::format(", {} bytes", number(fit, "payload_bytes", NumberFormat::whole)));
            if (drawn->contains("difference"))
                figures +=
                    fmt::format("{}<figcaption>ꟻLIP {}, PSNR {} dB, SSIM {}</figcaption>",
                                picture(*drawn, "difference", role_title(role) + ", difference"),
                                number(drawn, "flip", NumberFormat::plain), number(drawn, "psnr", NumberFormat::plain),
                                number(drawn, "ssim", NumberFormat::plain));
            figures += "</figure>\n";
        }
        html += section(title, fmt::format("<div class='row'>\n{}</div>", figures));
    }
    return html +
           "<p class='note'>Below each fit, a map of the visible differences (ꟻLIP) from the measured picture: black "
           "is "
           "no difference, pale yellow the largest.</p>\n";
}

/// The rows of Tsai 2009 for the same material.
std::string source_rows(const Tables& tables, const Json& material) {
    std::string html;
    for (const Json* source : rows_with(tables.source, "material", material["source_material"])) {
        std::vector<std::string> cells;
        for (const char* column : {"lobes", "variates", "payload_bytes"})
            cells.push_back(number(source, column, NumberFormat::whole));
        for (const MeasureText& measure : k_measure_texts)
            cells.push_back(number(source, measure.column, NumberFormat::percent));
        cells.push_back(fmt::format("{} to {} min", number(source, "least_minutes", NumberFormat::whole),
                                    number(source, "most_minutes", NumberFormat::whole)));
        html += row(source->at("model") == "su" ? "Tsai 2009, view by view" : "Tsai 2009, multivariate", cells, "tsai");
    }
    return html;
}

/// The fits of the sizes of Table 7.1, by objective.
std::string errors_of(const Tables& tables, const Json& material) {
    std::vector<Heading> headings{{"model"}, {"J"}, {"N"}, {"bytes"}};
    for (const MeasureText& measure : k_measure_texts) headings.push_back({measure.title});
    headings.push_back({"seconds"});
    std::string rows = source_rows(tables, material);
    if (!rows.empty())
        rows = group("the source: objective raw, its own matrix for this material", headings.size()) + rows;
    for (const char* objective : {"appearance", "raw", "cosine", "cube-root", "relative"}) {
        std::string listed;
        const std::string minimised = measure_column(objective, material["input"]);
        Json theta;
        for (const Json* fit : fits_of(tables, material)) {
            if (fit->at("objective") != objective || !is_of_table(*fit)) continue;
            theta = fit->at("max_theta");
            std::vector<std::string> cells;
            for (const char* column : {"lobes", "variates", "payload_bytes"})
                cells.push_back(number(fit, column, NumberFormat::whole));
            for (const MeasureText& measure : k_measure_texts) {
                const std::string cell = number(fit, measure.column, format_of(measure));
                cells.push_back(measure.column == minimised ? "<b>" + cell + "</b>" : cell);
            }
            cells.push_back(number(fit, "fit_seconds", NumberFormat::seconds));
            listed += row(html_escaped(title_of(*fit)), cells);
        }
        if (listed.empty()) continue;
        rows += group(fmt::format("objective {}, directions within {}°", objective, number(theta, NumberFormat::plain)),
                      headings.size());
        rows += listed;
    }
    return table(headings, rows) +
           fmt::format("<p class='note'>All {} fits are in <a href='../fits.csv'>fits.csv</a>.{}</p>",
                       number(&material, "fits", NumberFormat::whole),
                       field(material["source_material"]).empty()
                           ? ""
                           : " Tsai 2009 resampled the same material in its own way.");
}

std::string key_of(const std::string& colour, const char* dash, const std::string& name) {
    return fmt::format(
        "<span><svg class='key' viewBox='0 0 24 8'><path d='M0 4H24' stroke-width='3' style='stroke:{}' "
        "stroke-dasharray='{}'/></svg>{}</span> ",
        colour, *dash == 0 ? "none" : dash, html_escaped(name));
}

/// A curve of a chart: a model, a form and a number of variates.
struct ChartCurve {
    const char *name, *model, *form, *colour, *dash;
    int variates;
};
constexpr ChartCurve k_curves[] = {
    {"view by view", "su", "source", "--su", "", 1},
    {"source's form, N = 2", "pm", "source", "--source", "1 3", 2},
    {"source's form, N = 3", "pm", "source", "--source", "5 3", 3},
    {"source's form, N = 4", "pm", "source", "--source", "", 4},
    {"extended, N = 2", "pm", "extended", "--extended", "1 3", 2},
    {"extended, N = 3", "pm", "extended", "--extended", "5 3", 3},
    {"extended, N = 4", "pm", "extended", "--extended", "", 4},
    {"GGX and Lambert", "ggx", "", "--ggx", "", 1},
};

std::string charts_of(const Tables& tables, const Json& material) {
    const bool is_table = material["input"] == "table";
    const std::string objective = is_table ? "raw" : "cube-root",
                      measure = measure_column(objective, material["input"]);
    const char* title = is_table ? "Raw error, held out" : "Dark-part error, held out";
    Chart over_lobes{fmt::format("{}, over the number of lobes J", title), "J", {1, 2, 3, 4, 6, 8, 12, 16}, {}},
        over_bytes{fmt::format("{}, over bytes", title), "bytes", {}, {}};
    double min_lobes = k_max_view_lobes, max_lobes = 0;
    std::string legend;
    for (const ChartCurve& curve : k_curves) {
        const std::string colour = fmt::format("var({})", curve.colour);
        const bool is_ggx = std::string_view(curve.model) == "ggx";
        ChartSeries lobes{curve.name, colour, curve.dash, {}}, bytes = lobes;
        for (const Json* fit : fits_of(tables, material)) {
            if (fit->at("model") != curve.model || fit->at("objective") != objective ||
                fit->at("variates") != curve.variates || (fit->at("model") == "pm" && fit->at("form") != curve.form) ||
                fit->value("interpolation", "") == "plain" || !fit->at(measure).is_number())
                continue;
            const double error = fit->at(measure), j = fit->at("lobes"), size = fit->at("payload_bytes");
            const std::string text = fmt::format("{}: {}", field(fit->at("id")), field(fit->at(measure)));
            lobes.points.push_back({j, error, text});
            bytes.points.push_back({size, error, text});
            if (!is_ggx) {
                min_lobes = std::min(min_lobes, j);
                max_lobes = std::max(max_lobes, j);
            }
        }
        if (lobes.points.empty()) continue;
        legend += key_of(colour, curve.dash, curve.name);
        if (!is_ggx) over_lobes.series.push_back(std::move(lobes));
        over_bytes.series.push_back(std::move(bytes));
    }
    std::erase_if(over_lobes.x_ticks, [&](double tick) { return tick < min_lobes || tick > max_lobes; });
    return fmt::format("<p class='legend'>{}</p>\n<div class='charts'>{}{}</div>", legend, chart_drawing(over_lobes),
                       chart_drawing(over_bytes));
}

std::string frames_of(const Tables& tables, const Json& material) {
    const Rows rows = rows_with(tables.frames, "material", material["material"]);
    if (rows.empty()) return fmt::format("<p>No frames were timed: {}</p>", cell_html(material, "frames_error"));
    std::string html;
    for (const Json* frames : rows) {
        const Json* fit = row_with(fits_of(tables, material), "id", frames->at("id"));
        const std::string name =
            fit == nullptr ? "a constant, for comparison"
                           : title_of(*fit) + (frames->at("drawn") == "by index texture" ? ", by index texture" : "");
        std::vector<std::string> cells{number(fit, "lobes", NumberFormat::whole),
                                       number(fit, "variates", NumberFormat::whole)};
        for (const char* column : {"data_bytes", "auxiliary_bytes", "total_bytes"})
            cells.push_back(number(frames, column, NumberFormat::whole));
        cells.push_back(number(frames, "frames_per_second", NumberFormat::plain));
        html += row(html_escaped(name), cells);
    }
    for (const Json* source : rows_with(tables.source, "material", material["source_material"])) {
        std::vector<std::string> cells;
        for (const char* column : {"lobes", "variates", "payload_bytes", "auxiliary_bytes"})
            cells.push_back(number(source, column, NumberFormat::whole));
        cells.push_back("–");
        cells.push_back(fmt::format("{} to {}", number(source, "least_frames_per_second", NumberFormat::whole),
                                    number(source, "most_frames_per_second", NumberFormat::whole)));
        html += row(fmt::format("Tsai 2009, {}, {}", source->at("model") == "su" ? "view by view" : "multivariate",
                                cell_html(*source, "renderer")),
                    cells, "tsai");
    }
    const auto first_number = [&](const char* column) { return number(rows[0], column, NumberFormat::whole); };
    return table({{"model"}, {"J"}, {"N"}, {"bytes read"}, {"auxiliary bytes"}, {"total bytes"}, {"frames per second"}},
                 html) +
           fmt::format(
               "<p class='note'>The fastest of {} frames of {} × {} pixels, three directional lights, the mesh {} ({} "
               "triangles), by {}.</p>",
               first_number("frames"), first_number("width"), first_number("height"), cell_html(*rows[0], "mesh"),
               first_number("triangles"), cell_html(*rows[0], "renderer"));
}

std::string lobes_of(const Tables& tables, const Json& material, const Study& study) {
    std::string linear, logarithmic, legend, scans;
    for (const char* role : k_roles)
        if (picture_of(tables, material, "ball", role))
            legend += key_of(fmt::format("var(--{})", role), "", role_title(role));
    for (const Json& slice : study.material.at("lobes")) {
        linear += slice["linear"].get<std::string>();
        logarithmic += slice["logarithmic"].get<std::string>();
    }
    for (const Json& scan : study.material.value("scans", Json::array())) scans += scan.get<std::string>();
    if (!scans.empty())
        scans = "<p>Samples in the plane of incidence (points) and the fits (lines):</p>\n<div class='polar'>" + scans +
                "</div>";
    return fmt::format(
        "<p>Reflected light as a function of direction, plotted as the distance from the point of incidence. The thick "
        "line is the measurement. Beyond the largest angle of its objective, only the order of magnitude of a model is "
        "constrained.</p><p class='legend'>{}</p>\n<div class='polar'>{}</div>\n<div class='polar'>{}</div>\n{}",
        legend, linear, logarithmic, scans);
}

std::string lead_html(const Tables& tables, const Json& material) {
    const Json *fit = fits_of(tables, material)[0], *default_fit = fit_with_role(tables, material, "pm"),
               error = default_fit == nullptr ? Json() : default_fit->at("delta_e_itp");
    std::string html = fmt::format(
        "<p class='lead'>The difference between measurement and fit is {}{}.</p>\n<p>{}, a file of {} bytes; {}, {} "
        "bytes. {} fits; masked {}, clamped {}.</p>\n",
        verdict_text(material["verdict"]),
        error.is_number() ? fmt::format(": ΔE_ITP {} on average, {} in the worst of eight lightings",
                                        number(error, NumberFormat::plain),
                                        number(default_fit, "worst_delta_e_itp", NumberFormat::plain))
                          : "",
        cell_html(material, "format"), number(&material, "source_bytes", NumberFormat::whole),
        material["input"] == "samples" ? number(fit, "samples", NumberFormat::whole) + " samples as RGB floats"
                                       : "as a matrix of pairs of directions in RGB floats",
        number(fit, "raw_bytes", NumberFormat::whole), number(&material, "fits", NumberFormat::whole),
        number(&material, "masked_samples", NumberFormat::whole),
        number(&material, "clamped_samples", NumberFormat::whole));
    for (const Json* failure : rows_with(tables.failures, "material", material["material"]))
        html += fmt::format("<p class='wrong'>{} failed: {}</p>\n", cell_html(*failure, "id"),
                            cell_html(*failure, "error"));
    return html;
}

std::string exports_of(const Study& study) {
    std::string html;
    for (const Json& file : study.material.at("exports"))
        html += fmt::format("<a href='{}'{}>{}</a> · ", cell_html(file, "file"),
                            file["file"] == k_page_file ? "" : " download", cell_html(file, "what"));
    return fmt::format("<p>{}<a href='.'>all models, pictures and the lobes' numbers</a></p>\n", html);
}

}  // namespace

std::string index_html(const Tables& tables) {
    std::string cards;
    for (const Json* material : by_visible_error(tables)) cards += card_of(tables, *material);
    const std::pair<std::string_view, std::string> gallery[] = {{"cards", cards}, {"verdicts", verdicts_text()}};
    return page("Measured materials and their fits",
                lead_html(tables) + failed_of(tables) + filled(k_gallery_text, gallery) +
                    section("All materials", materials_table(tables)) + section("The measures", measures_html(tables)));
}

std::string material_html(const Tables& tables, const Json& material, const Study& study) {
    return page(cell_html(material, "material"),
                lead_html(tables, material) + exports_of(study) + pictures_of(tables, material) +
                    section("Sizes, errors, seconds", errors_of(tables, material)) +
                    section("Error over lobes and bytes", charts_of(tables, material)) +
                    section("Lobes", lobes_of(tables, material, study)) +
                    section("Bytes and frames per second", frames_of(tables, material)) +
                    "<p><a href='../index.html'>All materials</a></p>\n");
}

}  // namespace
