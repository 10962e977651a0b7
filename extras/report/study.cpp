#include "extras/report/study.h"

#include <algorithm>
#include <filesystem>

#include "app/hash.h"
#include "base/files.h"
#include "extras/render/app/page_of.h"
#include "extras/render/app/path.h"
#include "extras/render/likeness.h"
#include "extras/render/page.h"
#include "extras/render/slices.h"
#include "measured/readers.h"
#include "srbf/file.h"

namespace SRBF_NAMESPACE {
namespace {

namespace fs = std::filesystem;

/// Version of a study's content. Increment it if the content changes without a new version of the program.
constexpr int k_edition = 9;
/// Pixels per side and paths per pixel, for each sweep.
struct PictureSize {
    int pixels, paths;
};
constexpr std::array<PictureSize, 3> k_picture_sizes{{{240, 256}, {176, 48}, {16, 1}}};
/// The elevation of the eye [rad], high enough for the ground to fill the picture.
constexpr double k_elevation = 20 * k_degree;
/// JPEG quality of pictures on the page, and of difference maps.
constexpr int k_quality = 85, k_difference_quality = 70;

/// `text` with '_' in place of characters that some file systems refuse.
std::string folder_name(std::string text) {
    for (char& c : text)
        if (!std::isalnum(static_cast<unsigned char>(c)) && c != '-' && c != '_' && c != '.') c = '_';
    return text;
}

/// The CSS colour of a role.
std::string colour_of_role(const std::string& role) { return fmt::format("var(--{})", role); }

/// The subjects that are drawn: first the measurement, then fits.
struct DrawnSubjects {
    std::vector<LoadedFile> subjects;
    std::vector<std::string> roles, ids;
};

/// Makes a study in its folder.
class StudyMaker {
  public:
    StudyMaker(std::string folder, const StudyOptions& options,
               const std::function<void(const std::string&, double)>& progress)
        : folder_(std::move(folder)), options_(options), progress_(progress) {}

    Result<Study> run(const std::string& file) {
        const Stopwatch watch;
        auto measured = load_measured(file);
        if (!measured) return measured.error();
        Study study{folder_, {}, {}, {}};
        study.times["threads"] = options_.threads;
        study.times["jobs"] = options_.jobs;
        study.times["load_seconds"] = watch.seconds();
        const bool is_scattered = std::holds_alternative<ScatteredSamples>(measured->table);
        study.material = {{"file", fs::path(file).filename().string()},
                          {"format", measured->format},
                          {"input", is_scattered ? "samples" : "table"},
                          {"isotropic", is_isotropic(*measured)},
                          {"source_bytes", measured->bytes},
                          {"version", SRBF_VERSION},
                          {"sweep", name(options_.sweep)}};
        drawn_.subjects.push_back({file, *std::move(measured)});
        drawn_.roles.emplace_back("measured");
        drawn_.ids.emplace_back("measured");
        const auto written = [&]() -> Result<Done> {
            if (const auto done = fit(study); !done) return done.error();
            if (const auto done = draw_lobes(study); !done) return done.error();
            if (const auto done = draw_pictures(study); !done) return done.error();
            return write_exports(study);
        }();
        if (!written) return written.error();
        study.times["study_seconds"] = watch.seconds();
        for (const auto& [name, json] : {std::pair("times.json", &study.times), {"material.json", &study.material}})
            if (const auto done = write_json(*json, path(name)); !done) return done.error();
        return study;
    }

  private:
    std::string path(const std::string& name) const { return (fs::path(folder_) / name).string(); }
    /// Relative durations of the stages.
    static constexpr double k_fits = 0.75, k_pictures = 1 - k_fits;

    Result<Done> fit(Study& study) {
        const auto measured = [&]() -> const Measured& { return std::get<Measured>(drawn_.subjects[0].content); };
        const std::vector<FitPlan> planned = plan(measured(), options_.sweep, options_.threads);
        Json rows = Json::array(), failures = Json::array(), seconds = Json::object();
        std::optional<Error> first_error;
        for (std::size_t i = 0; i < planned.size(); ++i) {
            progress_(planned[i].id, k_fits * double(i) / double(planned.size()));
            const FitJob file_fit{study.material["file"], planned[i].id + ".srbf", {}, {}, planned[i].request};
            auto outcome = srbf::fit(measured(), planned[i].request);
            if (!outcome) {
                Error error = outcome.error();
                error.source = file_fit.input;
                failures.push_back({{"id", planned[i].id}, {"error", message(error)}});
                if (!first_error) first_error = error;
                continue;
            }
            Model& model = outcome->model;
            Json row{{"id", planned[i].id}, {"role", planned[i].role}};
            row.update(report_of(file_fit, measured(), *outcome));
            for (const char* omitted : {"fit_seconds", "load_seconds", "threads", "path"}) row.erase(omitted);
            rows.push_back(std::move(row));
            seconds[planned[i].id] = outcome->fit_seconds;
            if (const auto saved = save_model(model, path(file_fit.output)); !saved) return saved.error();
            if (planned[i].role.empty()) continue;
            drawn_.subjects.push_back({file_fit.output, std::move(model)});
            drawn_.roles.push_back(planned[i].role);
            drawn_.ids.push_back(planned[i].id);
        }
        if (rows.empty() && first_error) return *first_error;
        study.material["fits"] = std::move(rows);
        study.material["failures"] = std::move(failures);
        study.times["fit_seconds"] = std::move(seconds);
        return Done{};
    }

    Result<Done> draw_lobes(Study& study) {
        std::vector<SliceCurve> curves;
        for (std::size_t i = 0; i < drawn_.subjects.size(); ++i)
            curves.push_back({drawn_.ids[i], colour_of_role(drawn_.roles[i]), evaluator(drawn_.subjects[i])});
        std::string csv = "id,theta_l,theta_v,luminance\n";
        for (const double theta : k_lobe_theta) {
            study.material["lobes"].push_back(
                {{"theta_l", theta},
                 {"linear", lobe_drawing(curves, theta * k_degree, LobeScale::linear)},
                 {"logarithmic", lobe_drawing(curves, theta * k_degree, LobeScale::logarithmic)}});
            for (const SliceCurve& curve : curves) {
                const LuminanceSlice slice = luminance_slice(curve.brdf, theta * k_degree);
                for (std::size_t i = 0; i < slice.degrees.size(); ++i)
                    csv += std::isfinite(slice.luminance[i])
                               ? fmt::format("{},{:g},{:.4g},{:.6g}\n", curve.name, theta, slice.degrees[i],
                                             slice.luminance[i])
                               : fmt::format("{},{:g},{:.4g},\n", curve.name, theta, slice.degrees[i]);
            }
        }
        draw_scans(study, std::span(curves).subspan(1));
        return write_file(path("lobes.csv"), as_bytes(csv));
    }

    /// Plots samples in the plane of incidence, for at most `k_max_scans` angles.
    void draw_scans(Study& study, std::span<const SliceCurve> models) {
        const auto* samples = std::get_if<ScatteredSamples>(&std::get<Measured>(drawn_.subjects[0].content).table);
        if (samples == nullptr) return;
        const std::vector<Scan> scans = scans_in_plane(*samples);
        const std::size_t step = (scans.size() + k_max_scans - 1) / k_max_scans;
        for (std::size_t i = 0; i < scans.size(); i += step)
            study.material["scans"].push_back(scan_drawing(scans[i], models));
    }

    Result<Done> draw_pictures(Study& study) {
        const auto [size, paths] = k_picture_sizes[std::size_t(options_.sweep)];
        PathCommand command;
        command.samples = paths;
        command.threads = options_.threads;
        study.material["pixels"] = size;
        study.material["paths"] = command.samples;
        std::vector<Pictured> drawings;
        for (const LoadedFile& subject : drawn_.subjects) drawings.emplace_back(&subject);
        const std::array<std::pair<const char*, std::string>, 2> objects{{{"ball", "ball"}, {"mesh", options_.mesh}}};
        for (std::size_t object = 0; object < objects.size(); ++object) {
            auto mesh = load_mesh(objects[object].second);
            if (!mesh) return mesh.error();
            const Viewpoint viewpoint{.elevation = k_elevation, .z_up = object > 0 && options_.z_up};
            const Scene scene = scene_of(*std::move(mesh), viewpoint, 1);
            const auto pictures = command.render(scene, drawings, size, size, [&](double part) {
                progress_("pictures", k_fits + k_pictures * (double(object) + part) / double(objects.size()));
            });
            if (!pictures) return pictures.error();
            const float exposure = automatic_exposure(pictures->front().rendering.radiance);
            const Image8 measured = shown(pictures->front().rendering, exposure);
            for (std::size_t i = 0; i < pictures->size(); ++i) {
                const Image8 image = shown((*pictures)[i].rendering, exposure);
                const std::string name = fmt::format("{}-{}", objects[object].first, drawn_.ids[i]);
                if (const auto done = write(image, name, k_quality); !done) return done.error();
                Json row{{"object", objects[object].first},
                         {"id", drawn_.ids[i]},
                         {"role", drawn_.roles[i]},
                         {"picture", name}};
                if (i > 0) {
                    const Likeness similarity = likeness(measured, image);
                    const std::string difference = name + ".difference";
                    const Image8 map = in_false_colours(flip_map(measured, image), size, size);
                    if (const auto done = write(map, difference, k_difference_quality); !done) return done.error();
                    row.update({{"difference", difference},
                                {"psnr", similarity.psnr},
                                {"ssim", similarity.ssim},
                                {"flip", similarity.flip}});
                }
                study.material["pictures"].push_back(std::move(row));
            }
        }
        return Done{};
    }

    /// Lists the main fit (role "pm"), and writes a page that compares it and GGX with the measurement.
    Result<Done> write_exports(Study& study) {
        Json& exports = study.material["exports"] = Json::array();
        const auto subject_of = [&](std::string_view role) -> const LoadedFile* {
            const auto role_entry = std::ranges::find(drawn_.roles, role);
            return role_entry == drawn_.roles.end() ? nullptr
                                                    : &drawn_.subjects[std::size_t(role_entry - drawn_.roles.begin())];
        };
        const LoadedFile *fit = subject_of("pm"), *ggx = subject_of("ggx");
        if (fit == nullptr) return Done{};
        exports.push_back({{"file", fit->path}, {"what", "the model"}});
        if (is_two_sided(drawn_.subjects[0].content)) return Done{};
        std::vector<LoadedFile> models{{"fitted", fit->content}};
        if (ggx != nullptr) models.push_back({"GGX", ggx->content});
        exports.push_back({{"file", k_page_file}, {"what", "a page with both, to turn and to light"}});
        return write_file(path(k_page_file), as_bytes(page_html(page_of(models, &drawn_.subjects[0]))));
    }

    /// Writes a picture as PNG, and as JPEG for the page.
    Result<Done> write(const Image8& image, const std::string& name, int quality) const {
        if (const auto done = write_png(image, path(name + ".png")); !done) return done.error();
        return write_file(path(name + ".jpg"), jpeg(image, quality));
    }

    std::string folder_;
    const StudyOptions& options_;
    const std::function<void(const std::string&, double)>& progress_;
    DrawnSubjects drawn_;
};

}  // namespace

Result<std::string> study_name(const std::string& file, const StudyOptions& options) {
    const auto bytes = read_input(file);
    if (!bytes) {
        // FILE#NAME, an item in a file, is a model.
        const auto part = load_file(file);
        return part ? Error{file, {}, "input", "a measurement", "a fitted model", ErrorCode::wrong_kind} : part.error();
    }
    ResultKey key("study", fmt::format("{}\n{}", k_edition, options.settings));
    key.add(fs::path(file).filename().string());
    key.add(*bytes);
    if (std::ranges::find(k_built_in_meshes, options.mesh) == k_built_in_meshes.end()) {
        const auto mesh = read_file(options.mesh);
        if (!mesh) return mesh.error();
        key.add(*mesh);
    }
    return fmt::format("{}-{}", folder_name(fs::path(file).stem().string()), key.text());
}

std::optional<Study> load_study(const std::string& folder) {
    auto material = read_json((fs::path(folder) / "material.json").string()),
         times = read_json((fs::path(folder) / "times.json").string());
    if (!material || !times) return {};
    const auto fits = material->find("fits");
    if (fits == material->end() || !fits->is_array()) return {};
    for (const Json& fit : *fits)
        if (!is_report_of(fit, (fs::path(folder) / (fit.value("id", "") + ".srbf")).string())) return {};
    return Study{folder, *std::move(material), *std::move(times),
                 read_json((fs::path(folder) / "frames.json").string()).value_or(Json())};
}

Result<Study> make_study(const std::string& file, const std::string& folder, const StudyOptions& options,
                         const std::function<void(const std::string&, double)>& progress) {
    const fs::path whole = folder, unfinished = whole.parent_path() / ("." + whole.filename().string());
    std::error_code code;
    fs::remove_all(unfinished, code);  // an interrupted run may have left it
    fs::remove_all(whole, code);
    if (fs::create_directory(unfinished, code); code)
        return Error{unfinished.string(), {}, "cannot be made", "a folder", code.message()};
    auto study = within_memory(file, [&] { return StudyMaker(unfinished.string(), options, progress).run(file); });
    if (!study) {
        fs::remove_all(unfinished, code);
        return study;
    }
    if (const auto renamed = rename_path(unfinished.string(), whole.string()); !renamed) return renamed.error();
    // Reading the study back makes the result independent of which run created it.
    auto study_read = load_study(folder);
    if (!study_read) return Error{whole.string(), {}, "cannot be read", "the study that was written", "none"};
    return *std::move(study_read);
}

}  // namespace
