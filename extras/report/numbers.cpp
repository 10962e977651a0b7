// The page of numbers: all materials and statistics.
#include "extras/report/page.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/printable.h"
#include "extras/report/parts.h"
#include "fit/request_traits.h"
#include "report/report_text.h"

namespace SRBF_NAMESPACE {
namespace {

/// The roles of the three models that are compared.
constexpr const char* k_compared[] = {"pm", "su", "ggx"};
const std::vector<std::string> k_compared_names{"multi­variate", "view by view", "GGX"};

std::string materials_table(const View& view) {
    std::string rows;
    for (const Json* material : view.by_visible_error()) {
        std::vector<std::string> cells;
        for (const char* role : k_compared)
            cells.push_back(number(view.ball(*material, role), "flip", NumberFormat::plain));
        for (const char* column : {"heldout_squared_error_ratio_cosine", "heldout_cube_root_error_ratio"})
            for (const char* role : k_compared)
                cells.push_back(number(view.fit_with_role(*material, role), column, NumberFormat::percent));
        const Json* fit = view.fit_with_role(*material, "pm");
        cells.push_back(number(fit, "albedo_error", NumberFormat::percent));
        cells.push_back(number(fit, "payload_bytes", NumberFormat::whole));
        cells.push_back(number(fit, "fit_seconds", NumberFormat::seconds));
        cells.push_back(number(material, "masked_samples", NumberFormat::whole));
        cells.push_back(number(material, "clamped_samples", NumberFormat::whole));
        rows += row(link_to(*material) + label_of(*material), cells);
    }
    return table({{"material", {}},
                  {"ꟻLIP", k_compared_names},
                  {"image error", k_compared_names},
                  {"dark-part error", k_compared_names},
                  {"multivariate", {"albedo error", "bytes", "seconds"}},
                  {"samples", {"masked", "clamped"}}},
                 rows) +
           "<p class='note'>masked: pairs of directions in a fit that were not measured and are skipped; clamped: "
           "negative "
           "values of saturated colours, set to 0. For scattered samples, a single bright sample that the others do "
           "not "
           "predict may dominate the held-out error.</p>";
}

/// Statistics of a measure over materials.
constexpr const char* k_spread[] = {"mean", "median", "percentile_95", "worst"};
const std::vector<std::string> k_spread_names{"mean", "median", "95 % below", "worst"};

const char* input_title(const std::string& input) { return input == "table" ? "Tables" : "Scattered samples"; }

/// The statistics of the fits with this id, a row per measure.
Rows statistics_of(const View& view, const std::string& input, const std::string& id) {
    Rows rows = rows_with(view.tables.statistics, "id", id);
    std::erase_if(rows, [&](const Json* row) { return row->at("input") != input || row->at("materials") < 2; });
    return rows;
}

/// Statistics of the compared models over all materials of a kind, a row per measure.
std::string compared_statistics(const View& view, const std::string& input) {
    std::vector<Rows> models;
    for (const char* role : k_compared) {
        const Json* fit = row_with(rows_with(view.tables.fits, "input", input), "role", role);
        models.push_back(fit == nullptr ? Rows() : statistics_of(view, input, fit->at("id")));
    }
    std::string rows;
    for (const MeasureText& measure : k_measure_texts) {
        std::vector<std::string> cells;
        for (const Rows& model : models)
            for (const char* statistic : k_spread)
                cells.push_back(number(row_with(model, "measure", measure.column), statistic, format_of(measure)));
        rows += row(measure.title, cells);
    }
    if (models[0].empty()) return {};
    std::vector<Head> heads{{"error", {}}};
    for (const std::string& name : k_compared_names) heads.push_back({name, k_spread_names});
    return fmt::format("<h3>{}: {} materials</h3>\n", input_title(input),
                       number(models[0][0], "materials", NumberFormat::whole)) +
           table(heads, rows);
}

/// Statistics of all kinds of fits with one objective, over all materials of a kind.
std::string all_statistics(const View& view, const std::string& input, const std::string& objective) {
    std::vector<std::string> ids;
    for (const Json& row : view.tables.statistics.rows)
        if (row["input"] == input && row["objective"] == objective && is_of_table(row) &&
            std::ranges::find(ids, row["id"].get<std::string>()) == ids.end())
            ids.push_back(row["id"]);
    std::string rows, theta;
    for (const std::string& id : ids) {
        const Rows statistics = statistics_of(view, input, id);
        if (statistics.empty()) continue;
        std::vector<std::string> cells{number(statistics[0], "lobes", NumberFormat::whole),
                                       number(statistics[0], "variates", NumberFormat::whole),
                                       number(statistics[0], "payload_bytes", NumberFormat::whole)};
        for (const MeasureText& measure : k_measure_texts)
            for (const char* statistic : k_spread) {
                const std::string cell =
                    number(row_with(statistics, "measure", measure.column), statistic, format_of(measure));
                cells.push_back(measure.column == measure_column(objective, input) ? "<b>" + cell + "</b>" : cell);
            }
        theta = number(statistics[0], "max_theta", NumberFormat::plain);
        rows += row(html_escaped(title_of(*row_with(rows_with(view.tables.fits, "input", input), "id", id))), cells);
    }
    if (rows.empty()) return rows;
    std::vector<Head> heads{{"model", {}}, {"J", {}}, {"N", {}}, {"bytes", {}}};
    for (const MeasureText& measure : k_measure_texts) heads.push_back({measure.title, k_spread_names});
    return fmt::format(
        "<details><summary>{}: all models fitted with the objective {}, directions within {}°</summary>{}</details>\n",
        input_title(input), objective, theta, table(heads, rows));
}

std::string statistics_html(const View& view) {
    std::string html;
    for (const char* input : {"table", "samples"}) {
        html += compared_statistics(view, input);
        for (const char* objective : k_listed_objectives) html += all_statistics(view, input, objective);
    }
    return html.empty() ? "<p>There is only one material of each kind.</p>" : html;
}

std::string measures_html() {
    std::string html = "<dl>\n";
    for (const MeasureText& measure : k_measure_texts)
        html += fmt::format("<dt>{}</dt> <dd>{} <small>({})</small></dd>\n", measure.title, measure.meaning,
                            measure.column);
    html +=
        "<dt>ꟻLIP</dt> <dd>The mean visibility of the difference from the measured picture, from 0 to 1 "
        "(Andersson et al. 2020).</dd>\n"
        "<dt>PSNR, SSIM</dt> <dd>Signal to error in dB, and structural similarity of the same pictures, which is 1 if "
        "they are "
        "equal.</dd>\n";
    return html +
           "</dl>\n<p class='note'>Ratios are squares: an image error of 1 % is a typical deviation of a tenth of the "
           "brightness. "
           "f is the measured reflectance [1/sr], f̂ the fitted one, with numbers rounded to 16 bits as they are "
           "stored. Held "
           "out means at 200,000 pairs of directions that the fit has not used; for scattered samples, 5-fold "
           "cross-validated. The "
           "matrix of a view-by-view model consists of its own sampled views.</p>";
}

std::string method_html(const View& view) {
    const Rows done = view.done();
    std::string html;
    if (!done.empty()) {
        const Json& material = *done[0];
        html += fmt::format(
            "<p>Seconds are the wall-clock time of one fit on {} threads, without reading the file; for scattered "
            "samples they include the fits of cross-validation. Materials processed at the same time: {}. "
            "Pictures are path-traced, {} × {} pixels, {} paths each, under the bundled studio environment, all of one "
            "material at one exposure and "
            "with one seed; frames were timed after all fits, one material at a time.</p>\n",
            number(&material, "threads", NumberFormat::whole), number(&material, "jobs", NumberFormat::whole),
            number(&material, "pixels", NumberFormat::whole), number(&material, "pixels", NumberFormat::whole),
            number(&material, "paths", NumberFormat::whole));
    }
    html += "<p>Every number on this page is in the files beside it, as a ratio instead of per cent: ";
    for (const Table* table : view.tables.all()) html += fmt::format("<a href='{0}.csv'>{0}.csv</a> ", table->name);
    return html +
           "and accuracy.md. The source is Y.-T. Tsai, Parametric Representations and Tensor Approximation Algorithms "
           "for "
           "Real-Time Data-Driven Rendering, NCTU 2009, section 7.2.</p>";
}

}  // namespace

std::string numbers_html(const Tables& tables) {
    const View view{tables};
    const Json& directions = *rows_with(tables.constants, "name", "matrix_directions")[0];
    return page("The numbers of all materials", k_numbers_text,
                {{"directions", number(&directions, "value", NumberFormat::whole)},
                 {"default_fit", "the default fit (of scattered samples: eight lobes)"},
                 {"all", materials_table(view)},
                 {"spread", statistics_html(view)},
                 {"measures", measures_html()},
                 {"made", method_html(view)}});
}

}  // namespace srbf
