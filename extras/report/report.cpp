// `srbf report`.
#include <unistd.h>

#include <map>
#include <memory>
#include <thread>

#include "app/commands.h"
#include "app/jobs.h"
#include "base/printable.h"
#include "errors/picture_errors.h"
#include "extras/render/app/mesh_options.h"
#include "extras/render/mesh.h"
#include "extras/report/pages.h"
#include "generated/app/extra_subcommands.h"
#include "srbf/file.h"

namespace SRBF_NAMESPACE {
namespace {

namespace fs = std::filesystem;

struct ReportCommand {
    std::vector<std::string> files;
    std::string settings, folder, mesh = StudyOptions{}.mesh, up = "y";
    Sweep sweep = Sweep::whole;
    int threads = 0, jobs = 0;

    int run() const;
};

/// The last stages of a fit use four candidates and then one at a time, so more than four threads would be mostly
/// idle.
constexpr int k_cores_per_job = 4;

/// Removes unfinished files that a killed run has left in the folder and in the folders of its materials.
void remove_unfinished(const std::string& folder) {
    std::error_code none;
    std::vector<fs::path> unfinished;
    for (fs::recursive_directory_iterator entry(folder, none), end; entry != end && !none; entry.increment(none)) {
        const std::string name = entry->path().filename().string();
        if (name.starts_with(".srbf-") && name.ends_with(".tmp")) unfinished.push_back(entry->path());
        if (entry.depth() > 0) entry.disable_recursion_pending();
    }
    for (const fs::path& path : unfinished) fs::remove(path, none);
}

/// Studies the materials that are missing. The number of concurrent materials affects only durations.
void study_all(std::vector<MaterialEntry>& materials, const std::vector<std::string>& folders,
               const StudyOptions& options) {
    std::vector<std::size_t> missing;
    for (std::size_t i = 0; i < materials.size(); ++i)
        if (materials[i].error.empty() && !(materials[i].study = load_study(folders[i]))) missing.push_back(i);
    ProgressLine line;
    JobProgress shown(std::max<std::size_t>(missing.size(), 1), line);
    in_jobs(missing.size(), options.jobs, [&](std::size_t index) {
        MaterialEntry& material = materials[missing[index]];
        auto study =
            make_study(material.file, folders[missing[index]], options, [&](const std::string& stage, double part) {
                shown.show(index, fmt::format("{} of {}, {}: {}", index + 1, missing.size(), material.name, stage),
                           part);
            });
        if (study)
            material.study = *std::move(study);
        else
            material.error = message(study.error());
        shown.show(index, material.name, 1);
    });

    // Frames are timed while nothing else runs.
    for (std::size_t i = 0; i < materials.size(); ++i) {
        if (!materials[i].study || !materials[i].study->frames.is_null()) continue;
        line.show("frames of " + materials[i].name, double(i) / double(materials.size()));
        if (const auto timed = time_study(*materials[i].study, options); !timed)
            materials[i].frame_error = message(timed.error());
        else
            materials[i].study = load_study(materials[i].study->folder);  // the same as a later run reads
    }
}

/// The materials with their names and folders. A material that cannot be read has an error.
std::vector<MaterialEntry> materials_of(const ReportCommand& command, const StudyOptions& options,
                                        std::vector<std::string>& folders) {
    std::map<std::string, int> count;
    std::vector<MaterialEntry> materials;
    for (const std::string& file : command.files) {
        MaterialEntry material;
        material.file = file;
        const std::string stem = fs::path(file).stem().string();
        const int occurrences = ++count[stem];
        material.name = occurrences > 1 ? fmt::format("{} ({})", stem, occurrences) : stem;
        const auto name = study_name(file, options);
        std::string folder = name ? (fs::path(command.folder) / *name).string() : "";
        if (!name)
            material.error = message(name.error());
        else if (std::ranges::find(folders, folder) != folders.end())
            material.error = message({file, {}, "input", "a material that is not yet in the report", "the same again"});
        folders.push_back(material.error.empty() ? std::move(folder) : "");
        materials.push_back(std::move(material));
    }
    return materials;
}

Result<Done> write_all(const ReportCommand& command, const std::vector<MaterialEntry>& materials,
                       const Tables& tables) {
    std::vector<std::pair<std::string, std::string>> texts;
    for (const Table* table : tables.all()) texts.emplace_back(table->name + ".csv", csv(*table));
    for (const Json* material : rows_with(tables.materials, "status", "done")) {
        const auto material_entry = std::ranges::find(materials, field(material->at("material")), &MaterialEntry::name);
        texts.emplace_back(field(material->at("folder")) + "/index.html",
                           material_html(tables, *material, *material_entry->study));
    }
    texts.emplace_back("index.html", index_html(tables));
    for (const auto& [name, text] : texts)
        if (const auto written = write_file((fs::path(command.folder) / name).string(), as_bytes(text)); !written)
            return written.error();
    return Done{};
}

void print_summary(const ReportCommand& command, const Tables& tables) {
    fmt::print("{:<32}{:>10}{:>10}  {}\n", "material", "bytes", "ΔE_ITP", "difference");
    for (const Json* material : by_visible_error(tables)) {
        const Json* fit = fit_with_role(tables, *material, "pm");
        if (fit == nullptr) continue;
        const Json& error = fit->at("delta_e_itp");
        fmt::print(
            "{:<32}{:>10}{:>10}  {}\n", printable(field(material->at("material"))), fit->at("payload_bytes").get<int>(),
            error.is_number() ? fmt::format("{:.3g}", error.get<double>()) : "-", field(material->at("verdict")));
    }
    fmt::print("\n  page      {}\n", printable((fs::path(command.folder) / "index.html").string()));
}

int ReportCommand::run() const {
    if (const auto made = make_folder(folder); !made) return complain(made.error());
    if (const auto loaded = load_mesh(mesh); !loaded) return complain(loaded.error());
    remove_unfinished(folder);

    const int cores = threads > 0 ? threads : int(std::max(std::thread::hardware_concurrency(), 1u));
    StudyOptions options{sweep, mesh, up == "z", cores, 1, settings};
    const std::size_t max_jobs = std::min(std::size_t(cores / k_cores_per_job), files.size());
    options.jobs = jobs > 0 ? std::min(jobs, int(files.size())) : jobs_within_memory(max_jobs);
    options.threads = std::max(cores / options.jobs, 1);
    std::vector<std::string> folders;
    std::vector<MaterialEntry> materials = materials_of(*this, options, folders);
    study_all(materials, folders, options);
    const Tables tables = tables_of(materials);
    if (const auto written = write_all(*this, materials, tables); !written) return complain(written.error());
    print_summary(*this, tables);
    int status = k_done;
    for (const MaterialEntry& material : materials)
        if (!material.study) {
            fmt::print(stderr, "srbf: {}\n", material.error);
            status = k_input_error;
        }
    return status;
}

}  // namespace

void add_report(CommandLine& app, int& status) {
    const auto command = std::make_shared<ReportCommand>();
    const Subcommand sub = app.add_subcommand(
        "report", "Fit all kinds of models to materials and compare them: a page, tables, pictures, the models");
    std::vector<Option> besides;  // options that no study depends on
    besides.push_back(sub.add_option("FILE", command->files, "Measurements").type_name("").required());
    besides.push_back(sub.add_option("-o,--output", command->folder,
                                     "The folder to write. Materials that are already complete there are skipped")
                          .type_name("DIR")
                          .required());
    sub.add_flag(
        "--quick", [command] { command->sweep = Sweep::quick; },
        "Fewer sizes, coarser pictures: about a minute per material on two cores");
    // Tests take one small fit of each kind.
    sub.add_flag(
           "--least", [command] { command->sweep = Sweep::least; }, "")
        .hidden();
    add_mesh_options(sub, command->mesh, command->up);
    besides.push_back(sub.add_option("--threads", command->threads, "Total number of threads; 0: all of the machine")
                          .type_name("T")
                          .check(within(0, k_max_threads))
                          .capture_default_str());
    besides.push_back(
        sub.add_option("--jobs", command->jobs,
                       "Number of materials at a time, which share the threads; 0: one for every four cores")
            .type_name("N")
            .check(within(0, k_max_threads))
            .capture_default_str());
    sub.footer("Example:\n  srbf report materials/*.binary -o report --quick");
    sub.callback([command, sub, besides, &status] {
        command->settings = sub.settings(besides);
        status = command->run();
    });
}

}  // namespace
