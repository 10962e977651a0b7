// The numbers of a report over all materials, as a page.
#include "extras/report/page.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/printable.h"
#include "extras/report/parts.h"
#include "report/report_text.h"

namespace srbf {
namespace {

/// The three models of the comparisons.
constexpr const char* k_compared[] = {"pm", "su", "ggx"};
const std::vector<std::string> k_compared_names{"multi­variate", "view by view", "GGX"};

std::string all_of(const View& view) {
    std::string rows;
    for (const Json* material : view.by_visible_error()) {
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
           "<p class='note'>masked: pairs of directions in a fit that were not measured, and are skipped; clamped: "
           "negative "
           "values of saturated colours, set to 0. Scattered samples: a single bright sample that the others do not "
           "predict may dominate the held-out error.</p>";
}

/// Statistics of a measure over materials.
constexpr const char* k_spread[] = {"mean", "median", "percentile_95", "worst"};
const std::vector<std::string> k_spread_names{"mean", "median", "95 % below", "worst"};

const char* input_title(const std::string& input) { return input == "table" ? "Tables" : "Scattered samples"; }

/// The statistics of the fits with that id, a row per measure.
Rows statistics_of(const View& view, const std::string& input, const std::string& id) {
    Rows rows = rows_with(view.tables.statistics, "id", id);
    std::erase_if(rows, [&](const Json* row) { return row->at("input") != input || row->at("materials") < 2; });
    return rows;
}

/// The compared models over all materials of a kind, a row per measure.
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

/// Fits of all kinds with one objective over all materials of a kind.
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
                cells.push_back(measure.column == measure_column(objective, input) ? "<b>" + cell + "</b>" : cell);
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
        for (const char* objective : k_listed_objectives) html += spread_of_all(view, input, objective);
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

std::string numbers_html(const Tables& tables) {
    const View view{tables};
    const Json& directions = *rows_with(tables.constants, "name", "matrix_directions")[0];
    return page("The numbers of all materials", k_numbers_text,
                {{"directions", number(&directions, "value", Shown::whole)},
                 {"default_fit", "the default fit (of scattered samples: eight lobes)"},
                 {"all", all_of(view)},
                 {"spread", spread_of(view)},
                 {"measures", measures_of()},
                 {"made", made_of(view)}});
}

}  // namespace srbf
