// The page of a material.
#include <fmt/format.h>

#include <algorithm>

#include "base/printable.h"
#include "errors/picture_errors.h"
#include "extras/render/chart.h"
#include "extras/report/page.h"
#include "extras/report/parts.h"
#include "report/report_text.h"

namespace SRBF_NAMESPACE {
namespace {

/// A picture in the material's folder: its small form, with a link to the large one.
std::string picture(const Json& row, const char* column, const std::string& alt) {
    return fmt::format("<a href='{0}.png'><img src='{0}.jpg' alt='{1}'></a>", text_of(row, column), html_escaped(alt));
}

std::string pictures_of(const View& view, const Json& material) {
    std::string html;
    for (const auto& [object, title] : {std::pair("ball", "Ball"), {"mesh", "Mesh"}}) {
        std::string figures;
        for (const char* role : k_roles) {
            const Json* picture_row = row_with(view.pictures(material, object), "role", role);
            if (picture_row == nullptr) continue;
            const Json* fit = view.fit_with_role(material, role);
            figures += fmt::format(
                "<figure>{}<figcaption><b>{}</b>{}</figcaption>", picture(*picture_row, "picture", role_title(role)),
                html_escaped(role_title(role)),
                fit == nullptr ? "" : fmt::format(", {} bytes", number(fit, "payload_bytes", NumberFormat::whole)));
            if (picture_row->contains("difference"))
                figures += fmt::format("{}<figcaption>ꟻLIP {}, PSNR {} dB, SSIM {}</figcaption>",
                                       picture(*picture_row, "difference", role_title(role) + ", difference"),
                                       number(picture_row, "flip", NumberFormat::plain),
                                       number(picture_row, "psnr", NumberFormat::plain),
                                       number(picture_row, "ssim", NumberFormat::plain));
            figures += "</figure>\n";
        }
        html += fmt::format("<h2>{}</h2>\n<div class='row'>\n{}</div>\n", title, figures);
    }
    return html +
           "<p class='note'>Below each fit, a map of the visible differences (ꟻLIP) from the measured picture: black "
           "is no "
           "difference, pale yellow the largest.</p>\n";
}

std::vector<std::string> fit_cells(const Json& fit) {
    std::vector<std::string> cells{number(&fit, "lobes", NumberFormat::whole),
                                   number(&fit, "variates", NumberFormat::whole),
                                   number(&fit, "payload_bytes", NumberFormat::whole)};
    const std::string minimised = measure_column(fit["objective"], fit["input"]);
    for (const MeasureText& measure : k_measure_texts) {
        const std::string cell = number(&fit, measure.column, format_of(measure));
        cells.push_back(measure.column == minimised ? "<b>" + cell + "</b>" : cell);
    }
    cells.push_back(number(&fit, "fit_seconds", NumberFormat::seconds));
    return cells;
}

/// The rows of Tsai 2009 for the same material, below a line that names the objective.
std::string source_rows(const View& view, const Json& material, std::size_t columns) {
    std::string html;
    for (const Json* source_row : rows_with(view.tables.source, "material", material["source_material"])) {
        std::vector<std::string> cells{number(source_row, "lobes", NumberFormat::whole),
                                       number(source_row, "variates", NumberFormat::whole),
                                       number(source_row, "payload_bytes", NumberFormat::whole)};
        for (const MeasureText& measure : k_measure_texts)
            cells.push_back(std::string_view(measure.column) == "squared_error_ratio"
                                ? number(source_row, measure.column, NumberFormat::percent)
                                : "–");
        cells.push_back(fmt::format("{} to {} min", number(source_row, "least_minutes", NumberFormat::whole),
                                    number(source_row, "most_minutes", NumberFormat::whole)));
        html +=
            row(source_row->at("model") == "su" ? "Tsai 2009, view by view" : "Tsai 2009, multivariate", cells, "tsai");
    }
    return html.empty() ? html : group("the source: objective raw, its own matrix for this material", columns) + html;
}

/// The largest number of fits that the page lists. All fits of the full sweep would be half of the page.
constexpr int k_most_listed = 40;

std::string errors_of(const View& view, const Json& material, bool whole) {
    std::vector<Head> heads{{"model", {}}, {"J", {}}, {"N", {}}, {"bytes", {}}};
    for (const MeasureText& measure : k_measure_texts) {
        const bool at_samples =
            std::string_view(measure.column) == "squared_error_ratio" && material["input"] == "samples";
        heads.push_back({at_samples ? "raw error, at the samples" : measure.title, {}});
    }
    heads.push_back({"seconds", {}});
    std::string rows = whole ? "" : source_rows(view, material, heads.size());
    for (const char* objective : k_listed_objectives) {
        std::string rows_of_objective;
        Json theta;
        for (const Json* fit : view.fits(material)) {
            if (fit->at("objective") != objective || !(whole || is_of_table(*fit))) continue;
            theta = fit->at("max_theta");
            rows_of_objective += row(html_escaped(title_of(*fit)), fit_cells(*fit));
        }
        if (rows_of_objective.empty()) continue;
        rows += group(fmt::format("objective {}, directions within {}°", objective, number(theta, NumberFormat::plain)),
                      heads.size());
        rows += rows_of_objective;
    }
    return table(heads, rows);
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
    {"horizon, N = 2", "pm", "horizon", "--horizon", "1 3", 2},
    {"horizon, N = 3", "pm", "horizon", "--horizon", "5 3", 3},
    {"horizon, N = 4", "pm", "horizon", "--horizon", "", 4},
    {"extended, N = 2", "pm", "extended", "--extended", "1 3", 2},
    {"extended, N = 3", "pm", "extended", "--extended", "5 3", 3},
    {"extended, N = 4", "pm", "extended", "--extended", "", 4},
};

/// The fits on a curve.
Rows fits_on_curve(const View& view, const Json& material, const ChartCurve& curve, const std::string& objective) {
    Rows rows = view.fits(material);
    std::erase_if(rows, [&](const Json* fit) {
        return fit->at("model") != curve.model || fit->at("objective") != objective ||
               fit->at("variates") != curve.variates || (fit->at("model") == "pm" && fit->at("form") != curve.form) ||
               fit->value("interpolation", "") == "plain";
    });
    return rows;
}

std::string charts_of(const View& view, const Json& material) {
    const bool is_table = material["input"] == "table";
    const std::string objective = is_table ? "raw" : "cube-root",
                      measure = measure_column(objective, material["input"]);
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
    for (const ChartCurve& curve : k_curves)
        add(curve.name, curve.colour, curve.dash, fits_on_curve(view, material, curve, objective));
    add("GGX and Lambert", "--ggx", "", fits_on_curve(view, material, {"", "ggx", "", "", "", 1}, objective));
    std::erase_if(over_lobes.x_ticks, [&](double tick) { return tick < least_lobes || tick > most_lobes; });
    return fmt::format("<p class='legend'>{}</p>\n<div class='charts'>{}{}</div>\n", legend, chart_drawing(over_lobes),
                       chart_drawing(over_bytes));
}

std::string frames_of(const View& view, const Json& material) {
    const Rows rows = rows_with(view.tables.frames, "material", material["material"]);
    if (rows.empty()) return fmt::format("<p>No frames were timed: {}</p>\n", text_of(material, "frames_error"));
    std::string html;
    const Rows fits = view.fits(material);
    for (const Json* frame_row : rows) {
        const Json* fit = row_with(fits, "id", frame_row->at("id"));
        const std::string name =
            fit == nullptr
                ? "a constant, for comparison"
                : title_of(*fit) + (frame_row->at("drawn") == "by index texture" ? ", by index texture" : "");
        html += row(html_escaped(name),
                    {number(fit, "lobes", NumberFormat::whole), number(fit, "variates", NumberFormat::whole),
                     number(frame_row, "data_bytes", NumberFormat::whole),
                     number(frame_row, "auxiliary_bytes", NumberFormat::whole),
                     number(frame_row, "total_bytes", NumberFormat::whole),
                     number(frame_row, "frames_per_second", NumberFormat::plain)});
    }
    for (const Json* source_row : rows_with(view.tables.source, "material", material["source_material"]))
        html +=
            row(fmt::format("Tsai 2009, {}, {}", source_row->at("model") == "su" ? "view by view" : "multivariate",
                            text_of(*source_row, "renderer")),
                {number(source_row, "lobes", NumberFormat::whole), number(source_row, "variates", NumberFormat::whole),
                 number(source_row, "payload_bytes", NumberFormat::whole),
                 number(source_row, "auxiliary_bytes", NumberFormat::whole), "–",
                 fmt::format("{} to {}", number(source_row, "least_frames_per_second", NumberFormat::whole),
                             number(source_row, "most_frames_per_second", NumberFormat::whole))},
                "tsai");
    const Json& first = *rows[0];
    return table({{"model", {}},
                  {"J", {}},
                  {"N", {}},
                  {"bytes read", {}},
                  {"auxiliary bytes", {}},
                  {"total bytes", {}},
                  {"frames per second", {}}},
                 html) +
           fmt::format(
               "<p class='note'>The fastest of {} frames of {} × {} pixels, three directional lights, the mesh {} ({} "
               "triangles), by {}.</p>\n",
               number(&first, "frames", NumberFormat::whole), number(&first, "width", NumberFormat::whole),
               number(&first, "height", NumberFormat::whole), text_of(first, "mesh"),
               number(&first, "triangles", NumberFormat::whole), text_of(first, "renderer"));
}

std::string scans_of(const Study& study) {
    if (!study.material.contains("scans")) return {};
    std::string drawings;
    for (const Json& scan : study.material.at("scans")) drawings += scan.get<std::string>();
    return fmt::format(
        "<h3>Scans</h3>\n<p>Samples in the plane of incidence (points) and the fits (lines).</p>\n<div "
        "class='polar'>{}</div>\n",
        drawings);
}

std::string lobes_of(const View& view, const Json& material, const Study& study) {
    std::string linear, logarithmic, legend;
    for (const char* role : k_roles) {
        if (view.ball(material, role) == nullptr) continue;
        legend += fmt::format(
            "<span><svg class='key' viewBox='0 0 24 8'><path d='M0 4H24' stroke-width='3' "
            "style='stroke:var(--{})'/></svg>{}</span> ",
            role, html_escaped(role_title(role)));
    }
    for (const Json& slice : study.material.at("lobes"))
        linear += slice["linear"].get<std::string>(), logarithmic += slice["logarithmic"].get<std::string>();
    return fmt::format(
        "<p>Reflected light as a function of direction, plotted as the distance from the point of incidence. The thick "
        "line is the "
        "measurement. "
        "Beyond the largest angle of its objective, only the order of magnitude of a model is constrained.</p><p "
        "class='legend'>{}</p>\n<div class='polar'>{}</div>\n<div class='polar'>{}</div>\n{}",
        legend, linear, logarithmic, scans_of(study));
}

std::string lead_of(const View& view, const Json& material) {
    const Json* fit = view.fits(material)[0];
    const Json *default_fit = view.fit_with_role(material, "pm"),
               error = default_fit == nullptr ? Json() : default_fit->at("delta_e_itp");
    return fmt::format(
        "<p class='lead'>The difference between measurement and fit is {}{}.</p>\n<p>{}, a file of {} bytes; {}, {} "
        "bytes. {} fits; masked {}, clamped {}.</p>",
        verdict_text(material["verdict"]),
        error.is_number() ? fmt::format(": ΔE_ITP {} on average, {} in the worst of eight lightings",
                                        number(error, NumberFormat::plain),
                                        number(default_fit, "worst_delta_e_itp", NumberFormat::plain))
                          : "",
        text_of(material, "format"), number(&material, "source_bytes", NumberFormat::whole),
        material["input"] == "samples" ? number(fit, "samples", NumberFormat::whole) + " samples as RGB floats"
                                       : "as a matrix of pairs of directions in RGB floats",
        number(fit, "raw_bytes", NumberFormat::whole), number(&material, "fits", NumberFormat::whole),
        number(&material, "masked_samples", NumberFormat::whole),
        number(&material, "clamped_samples", NumberFormat::whole));
}

std::string failures_of(const View& view, const Json& material) {
    std::string html;
    for (const Json* failure : rows_with(view.tables.failures, "material", material["material"]))
        html +=
            fmt::format("<p class='wrong'>{} failed: {}</p>\n", text_of(*failure, "id"), text_of(*failure, "error"));
    return html;
}

std::string exports_of(const Study& study) {
    std::string html = "<ul class='exports'>\n";
    for (const Json& export_row : study.material.at("exports"))
        html += fmt::format("<li><a href='{}'{}>{}</a></li>\n", text_of(export_row, "file"),
                            export_row["file"] == k_page_file ? "" : " download", text_of(export_row, "what"));
    return html +
           "</ul>\n<p class='note'>Each of these is made from the default fit. The other models are in <a "
           "href='.'>this "
           "folder</a>, with the pictures and the lobes' numbers.</p>";
}

std::string errors_with_note(const View& view, const Json& material) {
    std::string html = errors_of(view, material, false);
    if (!field(material["source_material"]).empty())
        html += material["input"] == "samples"
                    ? "<p class='note'>Tsai 2009 resampled the samples to a matrix of 1536 × 1536 pairs; its error is "
                      "against that interpolation. The errors here are at the samples themselves, and held out.</p>\n"
                    : "<p class='note'>Tsai 2009 fitted the same material, resampled in its own way.</p>\n";
    return html;
}

std::string all_fits_of(const View& view, const Json& material) {
    const std::string fits = number(&material, "fits", NumberFormat::whole);
    if (material["fits"] > k_most_listed)
        return fmt::format("<p>All {} fits are in <a href='../fits.csv'>fits.csv</a>.</p>\n", fits);
    return fmt::format("<details><summary>All {} fits</summary>{}</details>\n", fits, errors_of(view, material, true));
}

}  // namespace

std::string material_html(const Tables& tables, const Json& material, const Study& study) {
    const View view{tables};
    return page(text_of(material, "material"), k_material_page_text,
                {{"label", label_of(material)},
                 {"lead", lead_of(view, material)},
                 {"failures", failures_of(view, material)},
                 {"exports", exports_of(study)},
                 {"pictures", pictures_of(view, material)},
                 {"errors", errors_with_note(view, material)},
                 {"charts", charts_of(view, material)},
                 {"lobes", lobes_of(view, material, study)},
                 {"frames", frames_of(view, material)},
                 {"all", all_fits_of(view, material)}});
}

}  // namespace srbf
