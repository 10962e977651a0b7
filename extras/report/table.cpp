#include "extras/report/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>

#include "base/printable.h"
#include "base/text.h"
#include "errors/sphere.h"
#include "srbf/metrics.h"

namespace srbf {

const std::vector<MeasureText> k_measure_texts{
    {"delta_e_itp", "ΔE_ITP",
     "How different pictures of a sphere look beside the measurement's, of which 1 is just noticeable: the mean over "
     "eight "
     "lightings.",
     false},
    {"heldout_squared_error_ratio_cosine", "image error",
     "What reaches an image: Σ(f cosθl − f̂ cosθl)² / Σ(f cosθl)², each view weighted by the area that it sees.", true},
    {"heldout_squared_error_ratio", "raw error",
     "Σ(f − f̂)² / Σf² of the reflectance itself, as in Tsai 2009; dominated by grazing angles.", true},
    {"squared_error_ratio", "raw error, matrix",
     "The same on the source's 1536 × 1536 pairs of directions, or at the samples themselves.", true},
    {"heldout_cube_root_error_ratio", "dark-part error",
     "The same ratio of the cube root of f, nearer to the eye, which sees the dark parts beside the highlight.", true},
    {"heldout_sixth_root_error_ratio", "sixth-root error",
     "The same of the sixth root of f cosθl with a small constant added, nearer still to the eye.", true},
    {"heldout_log_rms_cosine", "log error", "Root mean square of the differences of log(1 + f cosθl).", false},
    {"heldout_log10_rms", "decades", "Root mean square of the differences of log10 f, as scatter is judged.", false},
    {"albedo_error", "albedo error",
     "The largest relative error of the share of light that comes back at all, from 0, 30, 60 and 75°.", true},
};

std::string field(const Json& value) {
    if (value.is_null()) return {};
    if (value.is_string()) return value.get<std::string>();
    return value.dump();
}

std::string csv(const Table& table) {
    std::string text = fmt::format("{}\n", fmt::join(table.columns, ","));
    for (const Json& row : table.rows) {
        for (std::size_t i = 0; i < table.columns.size(); ++i) {
            const auto at = row.find(table.columns[i]);
            if (i > 0) text += ',';
            if (at != row.end()) text += at->is_string() ? csv_field(field(*at)) : field(*at);
        }
        text += '\n';
    }
    return text;
}

std::vector<const Json*> rows_with(const Table& table, const std::string& column, const Json& value) {
    std::vector<const Json*> rows;
    for (const Json& row : table.rows)
        if (const auto at = row.find(column); at != row.end() && *at == value) rows.push_back(&row);
    return rows;
}

const Json* row_with(const std::vector<const Json*>& rows, const std::string& column, const Json& value) {
    const auto found = std::ranges::find_if(rows, [&](const Json* row) {
        const auto at = row->find(column);
        return at != row->end() && *at == value;
    });
    return found == rows.end() ? nullptr : *found;
}

namespace {

/// Columns for a set of measures, for both sets and for albedo.
std::vector<std::string> measure_columns(const std::string& prefix) {
    std::vector<std::string> columns;
    for (const char* set : {"", "heldout_"})
        for (const MeasureName& m : k_measures) columns.push_back(prefix + set + m.name);
    columns.push_back(prefix + "albedo_error");
    return columns;
}

/// The measures of pictures in a fit's report; fits to samples have none.
constexpr std::array<const char*, 5> k_picture_columns{"delta_e_itp", "worst_delta_e_itp", "flip", "psnr", "rms"};

/// Tables 7.1 and 7.2 of Tsai 2009, for the materials whose measurements are available; the raw data are 1536 × 1536
/// RGB floats. Minutes and frames per second are the ranges over all its materials.
struct SourceRow {
    const char *material, *model;
    int lobes, variates;
    std::uint64_t payload_bytes;
    double squared_error_ratio;
};
constexpr std::array<SourceRow, 6> k_source{{
    {"blue-metallic-paint", "su", 5, 1, 92160, 0.0036},
    {"blue-metallic-paint", "pm", 6, 3, 156, 0.0034},
    {"krylon-blue", "su", 4, 1, 73728, 0.0101},
    {"krylon-blue", "pm", 8, 4, 256, 0.0102},
    {"nickel", "su", 5, 1, 92160, 0.0051},
    {"nickel", "pm", 6, 3, 156, 0.0044},
}};
constexpr std::uint64_t k_source_raw_bytes = std::uint64_t(1536) * 1536 * 3 * 4, k_source_auxiliary_bytes = 1585152;

/// The material of Tsai 2009 that a file holds, by its name; "": none. A labelled file is what its label says.
std::string source_material(const Reported& of) {
    std::string name;
    for (const char c : std::filesystem::path(of.file).stem().string())
        if (std::isalnum(static_cast<unsigned char>(c))) name += char(std::tolower(static_cast<unsigned char>(c)));
    if (name == "krylonblue" || name == "krylonbluergb") return "krylon-blue";
    if (!of.label.empty() || !of.study || of.study->material["format"] != "MERL") return {};
    if (name == "bluemetallicpaint") return "blue-metallic-paint";
    return name == "nickel" ? name : "";
}

/// Describes the difference of the default fit: by its pictures of a sphere, or where it has none by that of the ball.
std::string_view verdict_of(const Study& study) {
    PictureErrors errors;
    for (const Json& fit : study.material.at("fits"))
        if (const Json* of = judged_pictures(fit); fit["role"] == "pm" && of != nullptr)
            return errors.delta_e = of->at("delta_e_itp"), errors.flip = of->at("flip"), words(verdict(errors));
    for (const Json& picture : study.material.at("pictures"))
        if (picture["object"] == "ball" && picture["role"] == "pm") errors.flip = picture["flip"];
    return words(verdict(errors));
}

void add_material(Tables& tables, const Reported& of) {
    Json row{{"material", of.name}, {"label", of.label}, {"file", std::filesystem::path(of.file).filename().string()}};
    if (!of.study) {
        row.update({{"status", "failed"}, {"error", of.error}});
        tables.materials.rows.push_back(std::move(row));
        return;
    }
    const Study& study = *of.study;
    for (const char* key : {"format", "input", "isotropic", "source_bytes", "sweep", "version", "pixels", "paths"})
        row[key] = study.material.at(key);
    row["folder"] = std::filesystem::path(study.folder).filename().string();
    row["status"] = "done";
    row["source_material"] = source_material(of);
    row["verdict"] = verdict_of(study);
    const Json &fits = study.material.at("fits"), &failures = study.material.at("failures");
    row["masked_samples"] = fits[0]["masked_samples"], row["clamped_samples"] = fits[0]["clamped_samples"];
    row["fits"] = fits.size(), row["failed_fits"] = failures.size();
    for (const char* key : {"threads", "jobs", "load_seconds", "study_seconds"}) row[key] = study.times.at(key);
    row["frames_error"] = of.frame_error;
    tables.materials.rows.push_back(std::move(row));

    for (const Json& fit : fits) {
        Json full{{"material", of.name}, {"input", study.material.at("input")}};
        full.update(fit);
        full["fit_seconds"] = study.times.at("fit_seconds").at(fit.at("id").get<std::string>());
        full["threads"] = study.times.at("threads");
        const Json* pictures = judged_pictures(fit);
        for (const char* column : k_picture_columns) full[column] = pictures == nullptr ? Json() : pictures->at(column);
        tables.fits.rows.push_back(std::move(full));
    }
    const auto add_all = [&](Table& table, const Json& rows) {
        for (const Json& one : rows) {
            Json full{{"material", of.name}};
            full.update(one);
            table.rows.push_back(std::move(full));
        }
    };
    add_all(tables.failures, failures);
    add_all(tables.pictures, study.material.at("pictures"));
    if (study.frames.is_null()) return;
    for (Json one : study.frames.at("rows")) {
        for (const char* key : {"renderer", "mesh", "triangles", "width", "height", "frames"})
            one[key] = study.frames.at(key);
        add_all(tables.frames, Json::array({one}));
    }
}

/// For each kind of fit that several materials have, each measure.
void add_statistics(Tables& tables) {
    std::vector<std::pair<std::string, std::vector<const Json*>>> kinds;
    for (const Json& fit : tables.fits.rows) {
        const std::string kind = fit["input"].get<std::string>() + " " + fit["id"].get<std::string>();
        auto at = std::ranges::find(kinds, kind, [](const auto& one) { return one.first; });
        if (at == kinds.end()) at = kinds.insert(kinds.end(), {kind, {}});
        at->second.push_back(&fit);
    }
    std::vector<std::string> measures = measure_columns("");
    measures.insert(measures.end(), k_picture_columns.begin(), k_picture_columns.end());
    measures.emplace_back("fit_seconds");
    for (const auto& [kind, fits] : kinds)
        for (const std::string& measure : measures) {
            std::vector<std::pair<double, const Json*>> values;
            for (const Json* fit : fits)
                if (const Json& value = fit->at(measure); value.is_number()) values.emplace_back(value, fit);
            if (values.empty()) continue;
            std::ranges::stable_sort(values, {}, [](const auto& one) { return one.first; });
            double sum = 0;
            for (const auto& [value, fit] : values) sum += value;
            const auto ranked = [&](double quantile) {  // linear between the values
                const double at = quantile * double(values.size() - 1), part = at - std::floor(at);
                const double below = values[std::size_t(at)].first;
                return part > 0 ? below + part * (values[std::size_t(at) + 1].first - below) : below;
            };
            Json row;
            for (const char* key :
                 {"input", "id", "model", "form", "lobes", "variates", "objective", "max_theta", "payload_bytes"})
                row[key] = fits[0]->at(key);
            row.update({{"measure", measure},
                        {"materials", values.size()},
                        {"mean", sum / double(values.size())},
                        {"median", ranked(0.5)},
                        {"percentile_95", ranked(0.95)},
                        {"worst", ranked(1)},
                        {"worst_material", values.back().second->at("material")}});
            tables.statistics.rows.push_back(std::move(row));
        }
}

/// Constants of the pages' text.
std::vector<Json> constants() {
    std::vector<Json> rows{{{"name", "matrix_directions"}, {"value", k_matrix_directions}},
                           {{"name", "heldout_pairs"}, {"value", k_heldout_pairs}},
                           {{"name", "folds"}, {"value", k_folds}}};
    for (const double theta : k_albedo_theta) rows.push_back({{"name", "albedo_theta"}, {"value", theta}});
    for (const double theta : k_lobe_theta) rows.push_back({{"name", "lobe_theta"}, {"value", theta}});
    return rows;
}

/// The words of a text.
std::vector<std::string> columns_of(std::string_view text) {
    std::vector<std::string> columns;
    while (!(text = trimmed(text)).empty()) columns.emplace_back(next_word(text));
    return columns;
}

std::vector<std::string> fit_columns() {
    std::vector<std::string> columns = columns_of(
        "material input id role model form lobes variates axial interpolation index objective max_theta raw_bytes "
        "payload_bytes auxiliary_bytes fit_seconds threads stop_reason masked_samples clamped_samples empty_directions "
        "samples folds directions seed");
    for (const char* prefix : {"", "unrounded_"})
        for (const std::string& column : measure_columns(prefix)) columns.push_back(column);
    columns.insert(columns.end(), k_picture_columns.begin(), k_picture_columns.end());
    return columns;
}

std::vector<Json> source_rows() {
    std::vector<Json> rows;
    for (const SourceRow& row : k_source) {
        const bool is_su = std::string_view(row.model) == "su";
        rows.push_back({{"material", row.material},
                        {"model", row.model},
                        {"lobes", row.lobes},
                        {"variates", row.variates},
                        {"raw_bytes", k_source_raw_bytes},
                        {"payload_bytes", row.payload_bytes},
                        {"auxiliary_bytes", is_su ? k_source_auxiliary_bytes : 0},
                        {"squared_error_ratio", row.squared_error_ratio},
                        {"least_minutes", is_su ? 8 : 10},
                        {"most_minutes", is_su ? 11 : 19},
                        {"least_frames_per_second", is_su ? 112 : 271},
                        {"most_frames_per_second", is_su ? 142 : 672},
                        {"renderer", "GeForce 9800 GX2"}});
    }
    return rows;
}

/// Numbers of materials by what became of them and by verdict.
std::vector<Json> summary_of(const Table& materials) {
    std::vector<Json> rows;
    const auto count = [&](const char* column, std::string_view value) {
        rows.push_back({{"what", value}, {"materials", rows_with(materials, column, value).size()}});
    };
    for (const char* status : {"done", "failed"}) count("status", status);
    for (std::size_t k = 0; k < k_verdicts; ++k) count("verdict", words(Verdict(k)));
    return rows;
}

}  // namespace

Tables tables_of(const std::vector<Reported>& materials) {
    Tables tables;
    tables.constants = {"constants", columns_of("name value"), constants()};
    tables.summary = {"summary", columns_of("what materials"), {}};
    tables.materials = {"materials",
                        columns_of("material label verdict file format input isotropic source_bytes status error "
                                   "source_material masked_samples clamped_samples fits failed_fits pixels paths "
                                   "load_seconds study_seconds threads jobs frames_error sweep version folder"),
                        {}};
    tables.fits = {"fits", fit_columns(), {}};
    tables.failures = {"failures", columns_of("material id error"), {}};
    tables.statistics = {"statistics",
                         columns_of("input id model form lobes variates objective max_theta payload_bytes measure "
                                    "materials mean median percentile_95 worst worst_material"),
                         {}};
    tables.pictures = {"pictures", columns_of("material object id role psnr ssim flip picture difference"), {}};
    tables.frames = {"frames",
                     columns_of("material id drawn data_bytes auxiliary_bytes total_bytes frames_per_second "
                                "milliseconds cpu_milliseconds renderer mesh triangles width height frames"),
                     {}};
    tables.source = {"source",
                     columns_of("material model lobes variates raw_bytes payload_bytes auxiliary_bytes "
                                "squared_error_ratio least_minutes most_minutes least_frames_per_second "
                                "most_frames_per_second renderer"),
                     source_rows()};
    for (const Reported& of : materials) add_material(tables, of);
    add_statistics(tables);
    tables.summary.rows = summary_of(tables.materials);
    return tables;
}

}  // namespace srbf
