#include "extras/report/table.h"

#include <fmt/format.h>

#include <cctype>
#include <filesystem>

#include "base/printable.h"
#include "base/text.h"
#include "errors/measures.h"
#include "errors/picture_errors.h"
#include "errors/sphere.h"
#include "fit/request_traits.h"
#include "srbf/metrics.h"

namespace SRBF_NAMESPACE {

const std::vector<MeasureText> k_measure_texts{
    {"delta_e_itp", "ΔE_ITP",
     "Visible difference of pictures of a sphere from the measurement's, mean over eight lightings; 1 is just "
     "noticeable.",
     false},
    {"heldout_squared_error_ratio_cosine", "image error",
     "Error in an image: Σ(f cosθl − f̂ cosθl)² / Σ(f cosθl)², each view weighted by its projected area.", true},
    {"heldout_squared_error_ratio", "raw error",
     "Σ(f − f̂)² / Σf² of the reflectance itself, as in Tsai 2009; dominated by grazing angles.", true},
    {"squared_error_ratio", "raw error, matrix",
     "The same ratio on the source's 1536 × 1536 pairs of directions, or at the samples themselves.", true},
    {"heldout_cube_root_error_ratio", "dark-part error",
     "The same ratio for the cube root of f, closer to perception, in which dark parts count beside the highlight.",
     true},
    {"heldout_sixth_root_error_ratio", "sixth-root error",
     "The same ratio for the sixth root of f cosθl plus a small constant, still closer to perception.", true},
    {"heldout_log_rms_cosine", "log error", "Root mean square of the differences of log(1 + f cosθl).", false},
    {"heldout_log10_rms", "decades",
     "Root mean square of the differences of log10 f, the usual error measure for scatter.", false},
    {"albedo_error", "albedo error",
     "The largest relative error of directional albedo, the fraction of light that is reflected, at 0, 30, 60 and 75°.",
     true},
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
            const auto entry = row.find(table.columns[i]);
            if (i > 0) text += ',';
            if (entry != row.end()) text += entry->is_string() ? csv_field(field(*entry)) : field(*entry);
        }
        text += '\n';
    }
    return text;
}

Rows rows_with(const Table& table, const std::string& column, const Json& value) {
    Rows rows;
    for (const Json& row : table.rows)
        if (const auto entry = row.find(column); entry != row.end() && *entry == value) rows.push_back(&row);
    return rows;
}

const Json* row_with(const Rows& rows, const std::string& column, const Json& value) {
    const auto match = std::ranges::find_if(rows, [&](const Json* row) {
        const auto entry = row->find(column);
        return entry != row->end() && *entry == value;
    });
    return match == rows.end() ? nullptr : *match;
}

const Json* fit_with_role(const Tables& tables, const Json& material, const std::string& role) {
    return row_with(rows_with(tables.fits, "material", material["material"]), "role", role);
}

Rows by_visible_error(const Tables& tables) {
    Rows rows = rows_with(tables.materials, "status", "done");
    std::ranges::stable_sort(rows, {}, [&](const Json* material) {
        const Json* fit = fit_with_role(tables, *material, "pm");
        const Json error = fit != nullptr ? fit->at("delta_e_itp") : Json();
        return error.is_number() ? error.get<double>() : std::numeric_limits<double>::infinity();
    });
    return rows;
}

namespace {

/// The columns of all measures over both sets of pairs, and of the albedo error.
std::vector<std::string> measure_columns() {
    std::vector<std::string> columns;
    for_measures({}, [&](const std::string& name, double) { columns.push_back(name); });
    return columns;
}

/// The columns of picture errors in a fit's report. Fits to samples have none.
constexpr std::array<const char*, 5> k_picture_columns{"delta_e_itp", "worst_delta_e_itp", "flip", "psnr", "rms"};

/// Tables 7.1 and 7.2 of Tsai 2009, for materials whose measurements are available. The raw data are 1536 × 1536
/// RGB floats. Minutes and frames per second are ranges over all its materials.
std::vector<Json> source_rows() {
    std::vector<Json> rows;
    const auto add = [&](const char* material, const char* model, int lobes, int variates, int bytes, double error) {
        const bool is_su = std::string_view(model) == "su";
        rows.push_back({{"material", material},
                        {"model", model},
                        {"lobes", lobes},
                        {"variates", variates},
                        {"raw_bytes", std::uint64_t(1536) * 1536 * 3 * 4},
                        {"payload_bytes", bytes},
                        {"auxiliary_bytes", is_su ? 1585152 : 0},
                        {"squared_error_ratio", error},
                        {"least_minutes", is_su ? 8 : 10},
                        {"most_minutes", is_su ? 11 : 19},
                        {"least_frames_per_second", is_su ? 112 : 271},
                        {"most_frames_per_second", is_su ? 142 : 672},
                        {"renderer", "GeForce 9800 GX2"}});
    };
    add("blue-metallic-paint", "su", 5, 1, 92160, 0.0036);
    add("blue-metallic-paint", "pm", 6, 3, 156, 0.0034);
    add("krylon-blue", "su", 4, 1, 73728, 0.0101);
    add("krylon-blue", "pm", 8, 4, 256, 0.0102);
    add("nickel", "su", 5, 1, 92160, 0.0051);
    add("nickel", "pm", 6, 3, 156, 0.0044);
    return rows;
}

/// The material of Tsai 2009 in a file, determined from its name; "": none.
std::string source_material(const MaterialEntry& entry) {
    std::string name;
    for (const char c : std::filesystem::path(entry.file).stem().string())
        if (std::isalnum(static_cast<unsigned char>(c))) name += char(std::tolower(static_cast<unsigned char>(c)));
    if (name == "krylonblue" || name == "krylonbluergb") return "krylon-blue";
    if (entry.study->material["format"] != "MERL") return {};
    if (name == "bluemetallicpaint") return "blue-metallic-paint";
    return name == "nickel" ? name : "";
}

/// The verdict on the main fit (role "pm"), from its pictures of a sphere or, if it has none, from the picture of the
/// ball.
std::string_view verdict_of(const Study& study) {
    PictureErrors errors;
    for (const Json& fit : study.material.at("fits"))
        if (const Json* picture_errors = judged_pictures(fit); fit["role"] == "pm" && picture_errors != nullptr)
            return errors.delta_e = picture_errors->at("delta_e_itp"), errors.flip = picture_errors->at("flip"),
                   name(verdict(errors));
    for (const Json& picture : study.material.at("pictures"))
        if (picture["object"] == "ball" && picture["role"] == "pm") errors.flip = picture["flip"];
    return name(verdict(errors));
}

void add_material(Tables& tables, const MaterialEntry& entry) {
    Json row{{"material", entry.name}, {"file", std::filesystem::path(entry.file).filename().string()}};
    if (!entry.study) {
        row.update({{"status", "failed"}, {"error", entry.error}});
        tables.materials.rows.push_back(std::move(row));
        return;
    }
    const Study& study = *entry.study;
    for (const char* key : {"format", "input", "isotropic", "source_bytes", "sweep", "version", "pixels", "paths"})
        row[key] = study.material.at(key);
    row["folder"] = std::filesystem::path(study.folder).filename().string();
    row["status"] = "done";
    row["source_material"] = source_material(entry);
    row["verdict"] = verdict_of(study);
    const Json &fits = study.material.at("fits"), &failures = study.material.at("failures");
    row["masked_samples"] = fits[0]["masked_samples"];
    row["clamped_samples"] = fits[0]["clamped_samples"];
    row["fits"] = fits.size();
    row["failed_fits"] = failures.size();
    for (const char* key : {"threads", "jobs", "load_seconds", "study_seconds"}) row[key] = study.times.at(key);
    row["frames_error"] = entry.frame_error;
    tables.materials.rows.push_back(std::move(row));

    for (const Json& fit : fits) {
        Json full{{"material", entry.name}, {"input", study.material.at("input")}};
        full.update(fit);
        full["fit_seconds"] = study.times.at("fit_seconds").at(fit.at("id").get<std::string>());
        full["threads"] = study.times.at("threads");
        const Json* pictures = judged_pictures(fit);
        for (const char* column : k_picture_columns) full[column] = pictures == nullptr ? Json() : pictures->at(column);
        tables.fits.rows.push_back(std::move(full));
    }
    const auto add_all = [&](Table& table, const Json& rows) {
        for (const Json& item : rows) {
            Json full{{"material", entry.name}};
            full.update(item);
            table.rows.push_back(std::move(full));
        }
    };
    add_all(tables.failures, failures);
    add_all(tables.pictures, study.material.at("pictures"));
    if (study.frames.is_null()) return;
    for (Json frame_row : study.frames.at("rows")) {
        for (const char* key : {"renderer", "mesh", "triangles", "width", "height", "frames"})
            frame_row[key] = study.frames.at(key);
        add_all(tables.frames, Json::array({frame_row}));
    }
}

/// The words of a text, as names of columns.
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
    for (const std::string& column : measure_columns()) columns.push_back(column);
    columns.insert(columns.end(), k_picture_columns.begin(), k_picture_columns.end());
    return columns;
}

}  // namespace

Tables tables_of(const std::vector<MaterialEntry>& materials) {
    Tables tables;
    tables.materials = {"materials",
                        columns_of("material verdict file format input isotropic source_bytes status error "
                                   "source_material masked_samples clamped_samples fits failed_fits pixels paths "
                                   "load_seconds study_seconds threads jobs frames_error sweep version folder"),
                        {}};
    tables.fits = {"fits", fit_columns(), {}};
    tables.failures = {"failures", columns_of("material id error"), {}};
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
    for (const MaterialEntry& entry : materials) add_material(tables, entry);
    return tables;
}

}  // namespace
