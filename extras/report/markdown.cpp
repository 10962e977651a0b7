// The tables of a report as Markdown, for docs/accuracy.md.
#include <fmt/format.h>

#include <algorithm>

#include "base/printable.h"
#include "extras/report/page.h"
#include "extras/report/parts.h"

namespace SRBF_NAMESPACE {
namespace {

/// A measure in the tables of docs/accuracy.md.
struct Column {
    const char *title, *measure;
    double scale;
};
constexpr Column k_columns[] = {{"f, %", "squared_error_ratio", 100}, {"f cosθl, %", "squared_error_ratio_cosine", 100},
                                {"RMS of log", "log_rms_cosine", 1},  {"cube root, %", "cube_root_error_ratio", 100},
                                {"albedo, %", "albedo_error", 100},   {"ΔE_ITP", "delta_e_itp", 1}};

std::string scaled(const Json& value, double scale) {
    return value.is_number() ? fmt::format("{:.3g}", scale * value.get<double>()) : "–";
}
std::string heldout(const Column& column) {
    const std::string measure = column.measure;
    return measure == "albedo_error" || measure == "delta_e_itp" ? measure : "heldout_" + measure;
}
std::string head(std::initializer_list<std::string> first) {
    std::string text = "|", line = "|";
    for (const std::string& title : first) text += fmt::format(" {} |", title), line += "---|";
    for (const Column& column : k_columns) text += fmt::format(" {} |", column.title), line += "---|";
    return text + "\n" + line + "\n";
}

/// The forms that docs/accuracy.md compares.
constexpr const char* k_compared_forms[] = {"source-8x4", "horizon-8x4", "extended-6x4", "extended-8x4",
                                            "extended-12x4"};

std::string over_materials(const Tables& tables, const std::string& objective) {
    std::string text;
    for (const std::string kind : k_compared_forms) {
        auto rows = rows_with(tables.statistics, "id", "pm-" + kind + "-" + objective);
        std::erase_if(rows, [](const Json* row) { return row->at("input") != "table"; });
        if (rows.empty()) continue;
        const Json& first = *rows[0];
        text += fmt::format("\n### Form {}, J = {}, N = {}, {} bytes\n\n", field(first["form"]), field(first["lobes"]),
                            field(first["variates"]), field(first["payload_bytes"]));
        text += head({field(first["materials"]) + " materials"});
        for (const auto& [title, column] :
             {std::pair("mean", "mean"), {"median", "median"}, {"95 % of them", "percentile_95"}, {"worst", "worst"}}) {
            text += fmt::format("| {} |", title);
            for (const Column& measure_column : k_columns) {
                const Json* row = row_with(rows, "measure", heldout(measure_column));
                text += fmt::format(" {} |", row == nullptr ? "–" : scaled(row->at(column), measure_column.scale));
            }
            text += "\n";
        }
    }
    return text;
}

/// A row for each material and each of the fits `ids`: held-out errors for tables, "at the samples → held out" for
/// samples.
std::string each_material(const Tables& tables, const std::string& input, const std::vector<std::string>& ids) {
    std::string text = "\n" + head({"material", "model", "bytes"});
    for (const Json* material : rows_with(tables.materials, "input", input)) {
        const auto fits = rows_with(tables.fits, "material", material->at("material"));
        std::string name = in_markdown(field(material->at("material")));
        for (const std::string& id : ids) {
            const Json* fit = row_with(fits, "id", id);
            if (fit == nullptr) continue;
            text += fmt::format("| {} | {} | {} |", std::exchange(name, ""), id, field(fit->at("payload_bytes")));
            for (const Column& measure_column : k_columns) {
                const std::string heldout_error = scaled(fit->at(heldout(measure_column)), measure_column.scale);
                text += input == "table" || heldout(measure_column) == measure_column.measure
                            ? fmt::format(" {} |", heldout_error)
                            : fmt::format(" {} → {} |", scaled(fit->at(measure_column.measure), measure_column.scale),
                                          heldout_error);
            }
            text += "\n";
        }
    }
    return text;
}

std::string over_lobes(const Tables& tables) {
    std::string text;
    const auto errors = [](const Json* fit) {
        return fit == nullptr ? std::string(" – | – | – |")
                              : fmt::format(" {} | {} % | {} % |", field(fit->at("payload_bytes")),
                                            scaled(fit->at("squared_error_ratio"), 100),
                                            scaled(fit->at("heldout_squared_error_ratio"), 100));
    };
    for (const Json* material : rows_with(tables.materials, "input", "table")) {
        const auto fits = rows_with(tables.fits, "material", material->at("material"));
        text += fmt::format(
            "\n### {}\n\n| J | SU bytes | matrix | held out | PM source, bytes | matrix | held out | PM extended, "
            "bytes | matrix | held out |\n|---|---|---|---|---|---|---|---|---|---|\n",
            in_markdown(field(material->at("material"))));
        for (int lobes = 1; lobes <= k_most_view_lobes; ++lobes) {
            const Json *su = row_with(fits, "id", fmt::format("su-{}-raw", lobes)),
                       *source = row_with(fits, "id", fmt::format("pm-source-{}x4-raw", lobes)),
                       *extended = row_with(fits, "id", fmt::format("pm-extended-{}x4-raw", lobes));
            if (su != nullptr || source != nullptr || extended != nullptr)
                text += fmt::format("| {} |{}{}{}\n", lobes, errors(su), errors(source), errors(extended));
        }
    }
    return text;
}

std::string pictures(const Tables& tables) {
    std::string text =
        "\n| measurement | multivariate | multivariate, cosine | view by view | 2 GGX |\n|---|---|---|---|---|\n";
    const View view{tables};
    for (const Json* material : view.done()) {
        text += fmt::format("| {} |", in_markdown(field(material->at("material"))));
        for (const char* role : {"pm", "pm2", "su", "ggx"}) {
            const Json* picture_row = view.ball(*material, role);
            text += picture_row == nullptr || !picture_row->at("psnr").is_number()
                        ? std::string(" – |")
                        : fmt::format(" {:.1f}, {:.3f}, {:.3f} |", picture_row->at("psnr").get<double>(),
                                      picture_row->at("ssim").get<double>(), picture_row->at("flip").get<double>());
        }
        text += "\n";
    }
    return text;
}

}  // namespace

std::string report_markdown(const Tables& tables) {
    std::string text = "# Accuracy\n\nWritten by `srbf report`. Errors are held out unless stated otherwise.\n";
    for (const std::string objective : {"appearance", "raw", "cosine"})
        text += fmt::format("\n## Objective {}\n{}", objective, over_materials(tables, objective));
    for (const std::string objective : {"appearance", "raw", "cosine"}) {
        const auto id = [&](const char* model) { return fmt::format("{}-{}", model, objective); };
        text += fmt::format("\n## Each material, objective {}\n", objective) +
                each_material(tables, "table",
                              {id("pm-extended-8x4"), id("pm-extended-6x4"), id("pm-horizon-8x4"), id("pm-source-8x4"),
                               id("su-5"), id("ggx-1"), id("ggx-2"), id("openpbr")});
    }
    text += "\n## Scattered samples, at the samples → held out\n" +
            each_material(tables, "samples",
                          {"pm-extended-8x4-appearance", "pm-extended-6x4-cube-root", "pm-source-8x4-cube-root",
                           "pm-source-8x4-raw", "su-4-cube-root", "su-4-raw", "ggx-1-cube-root", "ggx-2-appearance",
                           "openpbr-appearance"});
    text += "\n## Over the number of lobes, objective raw, PM of N = 4\n" + over_lobes(tables);
    text += "\n## In pictures: PSNR [dB], SSIM, ꟻLIP\n" + pictures(tables);
    return text;
}

}  // namespace srbf
