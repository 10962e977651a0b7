// The page of a material.
#include <fmt/format.h>

#include <algorithm>

#include "base/printable.h"
#include "extras/render/chart.h"
#include "extras/report/page.h"
#include "extras/report/parts.h"
#include "report/report_text.h"

namespace srbf {
namespace {

/// A picture of the material's folder, in its small form with a link to the whole one.
std::string picture(const Json& row, const char* column, const std::string& alt) {
    return fmt::format("<a href='{0}.png'><img src='{0}.jpg' alt='{1}'></a>", text_of(row, column), html_escaped(alt));
}

std::string pictures_of(const View& view, const Json& material) {
    std::string html;
    for (const auto& [object, what] : {std::pair("ball", "Ball"), {"mesh", "Mesh"}}) {
        std::string figures;
        for (const char* role : k_drawn) {
            const Json* of = row_with(view.pictures(material, object), "role", role);
            if (of == nullptr) continue;
            const Json* fit = view.drawn(material, role);
            figures += fmt::format(
                "<figure>{}<figcaption><b>{}</b>{}</figcaption>", picture(*of, "picture", role_title(role)),
                html_escaped(role_title(role)),
                fit == nullptr ? "" : fmt::format(", {} bytes", number(fit, "payload_bytes", Shown::whole)));
            if (of->contains("difference"))
                figures += fmt::format("{}<figcaption>ꟻLIP {}, PSNR {} dB, SSIM {}</figcaption>",
                                       picture(*of, "difference", role_title(role) + ", difference"),
                                       number(of, "flip", Shown::plain), number(of, "psnr", Shown::plain),
                                       number(of, "ssim", Shown::plain));
            figures += "</figure>\n";
        }
        html += fmt::format("<h2>{}</h2>\n<div class='row'>\n{}</div>\n", what, figures);
    }
    return html +
           "<p class='note'>Under each fit: where it differs visibly from the measured picture (ꟻLIP), from black, not "
           "at all, to "
           "pale yellow.</p>\n";
}

std::vector<std::string> fit_cells(const Json& fit) {
    std::vector<std::string> cells{number(&fit, "lobes", Shown::whole), number(&fit, "variates", Shown::whole),
                                   number(&fit, "payload_bytes", Shown::whole)};
    const std::string minimised = measure_column(fit["objective"], fit["input"]);
    for (const MeasureText& measure : k_measure_texts) {
        const std::string cell = number(&fit, measure.column, shown_as(measure));
        cells.push_back(measure.column == minimised ? "<b>" + cell + "</b>" : cell);
    }
    cells.push_back(number(&fit, "fit_seconds", Shown::seconds));
    return cells;
}

/// The rows of Tsai 2009 for the same material, after a line that names the objective.
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

/// The fits that the page lists; with all fits of the full sweep they would be half of the page.
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

/// The curves of a chart: a model, a form, a number of variates.
struct ModelLine {
    const char *name, *model, *form, *colour, *dash;
    int variates;
};
constexpr ModelLine k_lines[] = {
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

/// The fits of a curve with the objective of the charts.
Rows of_line(const View& view, const Json& material, const ModelLine& line, const std::string& objective) {
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
    for (const ModelLine& line : k_lines)
        add(line.name, line.colour, line.dash, of_line(view, material, line, objective));
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

std::string scans_of(const Study& study) {
    if (!study.material.contains("scans")) return {};
    std::string drawings;
    for (const Json& scan : study.material.at("scans")) drawings += scan.get<std::string>();
    return fmt::format(
        "<h3>Scans</h3>\n<p>Samples in the plane of incidence, as points, and the fits.</p>\n<div "
        "class='polar'>{}</div>\n",
        drawings);
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
        "<p>Reflected light by direction, as the distance from the point of incidence. The thick line is the "
        "measurement. "
        "Beyond the largest angle of its objective a model is only constrained to the order of magnitude.</p><p "
        "class='legend'>{}</p>\n<div class='polar'>{}</div>\n<div class='polar'>{}</div>\n{}",
        legend, linear, logarithmic, scans_of(study));
}

std::string lead_of(const View& view, const Json& material) {
    const Json* fit = view.fits(material)[0];
    const Json *drawn = view.drawn(material, "pm"), error = drawn == nullptr ? Json() : drawn->at("delta_e_itp");
    return fmt::format(
        "<p class='lead'>The difference between measurement and fit is {}{}.</p>\n<p>{}, a file of {} bytes; {}, {} "
        "bytes. {} fits; masked {}, clamped {}.</p>",
        verdict_text(material["verdict"]),
        error.is_number() ? fmt::format(": ΔE_ITP {} on average, {} in the worst of eight lightings",
                                        number(error, Shown::plain), number(drawn, "worst_delta_e_itp", Shown::plain))
                          : "",
        text_of(material, "format"), number(&material, "source_bytes", Shown::whole),
        material["input"] == "samples" ? number(fit, "samples", Shown::whole) + " samples as RGB floats"
                                       : "as a matrix of pairs of directions in RGB floats",
        number(fit, "raw_bytes", Shown::whole), number(&material, "fits", Shown::whole),
        number(&material, "masked_samples", Shown::whole), number(&material, "clamped_samples", Shown::whole));
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
    for (const Json& of : study.material.at("exports"))
        html += fmt::format("<li><a href='{}'{}>{}</a></li>\n", text_of(of, "file"),
                            of["file"] == k_page_file ? "" : " download", text_of(of, "what"));
    return html +
           "</ul>\n<p class='note'>Each is of the default fit. The other models are in <a href='.'>this "
           "folder</a>, with the pictures and the lobes' numbers.</p>";
}

std::string errors_with_note(const View& view, const Json& material) {
    std::string html = errors_of(view, material, false);
    if (!field(material["source_material"]).empty())
        html += material["input"] == "samples"
                    ? "<p class='note'>Tsai 2009 resampled the samples to a matrix of 1536 × 1536 pairs; its error is "
                      "against that interpolation. Ours are at the samples themselves, and held out.</p>\n"
                    : "<p class='note'>Tsai 2009 fitted the same material, resampled in its own way.</p>\n";
    return html;
}

std::string all_fits_of(const View& view, const Json& material) {
    const std::string fits = number(&material, "fits", Shown::whole);
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
