// `srbf report`.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <thread>

#include "app/commands.h"
#include "app/extra_subcommands.h"
#include "app/jobs.h"
#include "base/printable.h"
#include "extras/render/app/mesh_options.h"
#include "extras/render/mesh.h"
#include "extras/report/page.h"
#include "extras/report/parts.h"
#include "srbf/file.h"

namespace srbf {
namespace {

namespace fs = std::filesystem;

struct ReportCommand {
    std::vector<std::string> files, labels;
    std::string settings, folder, note, mesh = StudyOptions{}.mesh, up = "y";
    Sweep sweep = Sweep::whole;
    int threads = 0, jobs = 0;

    int run() const;
    bool labels_are_of_files() const;
};

/// The last stages of a fit use four candidates and then one at a time, so that more than four threads are mostly idle.
constexpr int k_cores_of_a_job = 4;

/// Removes the unfinished files that a killed run has left in the folder and in those of its materials.
void remove_unfinished(const std::string& folder) {
    std::error_code none;
    std::vector<fs::path> unfinished;
    for (fs::recursive_directory_iterator at(folder, none), end; at != end && !none; at.increment(none)) {
        const std::string name = at->path().filename().string();
        if (name.starts_with(".srbf-") && name.ends_with(".tmp")) unfinished.push_back(at->path());
        if (at.depth() > 0) at.disable_recursion_pending();
    }
    for (const fs::path& path : unfinished) fs::remove(path, none);
}

/// Studies the missing materials. The number of materials at a time affects only the durations.
void study_all(std::vector<Reported>& materials, const std::vector<std::string>& folders, const StudyOptions& options) {
    std::vector<std::size_t> todo;
    for (std::size_t i = 0; i < materials.size(); ++i)
        if (materials[i].error.empty() && !(materials[i].study = load_study(folders[i]))) todo.push_back(i);
    ProgressLine line;
    Board board(std::max<std::size_t>(todo.size(), 1), line);
    in_jobs(todo.size(), options.jobs, [&](std::size_t at) {
        Reported& of = materials[todo[at]];
        auto study = make_study(of.file, folders[todo[at]], options, [&](const std::string& what, double part) {
            board.show(at, fmt::format("{} of {}, {}: {}", at + 1, todo.size(), of.name, what), part);
        });
        if (study)
            of.study = *std::move(study);
        else
            of.error = message(study.error());
        board.show(at, of.name, 1);
    });

    // While nothing else runs.
    for (std::size_t i = 0; i < materials.size(); ++i) {
        if (!materials[i].study || !materials[i].study->frames.is_null()) continue;
        line.show("frames of " + materials[i].name, double(i) / double(materials.size()));
        if (const auto timed = time_study(*materials[i].study, options); !timed)
            materials[i].frame_error = message(timed.error());
        else
            materials[i].study = load_study(materials[i].study->folder);  // as a later run will read it
    }
}

/// The names by which a label may call a file.
std::array<std::string, 3> names_of(const std::string& file) {
    return {fs::path(file).stem().string(), fs::path(file).filename().string(), file};
}

bool ReportCommand::labels_are_of_files() const {
    return std::ranges::all_of(labels, [&](const std::string& label) {
        return std::ranges::any_of(files, [name = label.substr(0, label.find('='))](const std::string& file) {
            return std::ranges::count(names_of(file), name) > 0;
        });
    });
}

/// The materials by name, with the folder of each; reports those that cannot be read.
std::vector<Reported> materials_of(const ReportCommand& command, const StudyOptions& options,
                                   std::vector<std::string>& folders) {
    std::map<std::string, std::string> label_of;
    for (const std::string& label : command.labels)
        label_of[label.substr(0, label.find('='))] = label.substr(label.find('=') + 1);
    std::map<std::string, int> count;
    std::vector<Reported> materials;
    for (const std::string& file : command.files) {
        Reported of;
        of.file = file;
        const std::string stem = fs::path(file).stem().string();
        const int same = ++count[stem];
        of.name = same > 1 ? fmt::format("{} ({})", stem, same) : stem;
        for (const std::string& key : names_of(file))
            if (const auto label = label_of.find(key); label != label_of.end()) of.label = label->second;
        const auto name = study_name(file, options);
        std::string folder = name ? (fs::path(command.folder) / *name).string() : "";
        if (!name)
            of.error = message(name.error());
        else if (std::ranges::find(folders, folder) != folders.end())
            of.error = message({file, {}, "input", "another material", "one that is in the report already"});
        folders.push_back(of.error.empty() ? std::move(folder) : "");
        materials.push_back(std::move(of));
    }
    return materials;
}

Result<Done> write_all(const ReportCommand& command, const std::vector<Reported>& materials, const Tables& tables) {
    std::vector<std::pair<std::string, std::string>> texts;
    for (const Table* table : tables.all()) texts.emplace_back(table->name + ".csv", csv(*table));
    texts.emplace_back("accuracy.md", report_markdown(tables));
    texts.emplace_back("numbers.html", numbers_html(tables));
    for (const Json* material : rows_with(tables.materials, "status", "done")) {
        const auto of = std::ranges::find(materials, field(material->at("material")), &Reported::name);
        texts.emplace_back(field(material->at("folder")) + "/index.html", material_html(tables, *material, *of->study));
    }
    texts.emplace_back("index.html", gallery_html(materials, tables, command.note));
    for (const auto& [name, text] : texts)
        if (const auto written = write_file((fs::path(command.folder) / name).string(), as_bytes(text)); !written)
            return written.error();
    return Done{};
}

void print_summary(const ReportCommand& command, const Tables& tables) {
    const View view{tables};
    fmt::print("{:<32}{:>10}{:>10}  {}\n", "material", "bytes", "ΔE_ITP", "difference");
    for (const Json* material : view.by_visible_error()) {
        const Json* fit = view.drawn(*material, "pm");
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
    const std::size_t most = std::min(std::size_t(cores / k_cores_of_a_job), files.size());
    options.jobs = jobs > 0 ? std::min(jobs, int(files.size())) : jobs_within_memory(most);
    options.threads = std::max(cores / options.jobs, 1);
    std::vector<std::string> folders;
    std::vector<Reported> materials = materials_of(*this, options, folders);
    study_all(materials, folders, options);
    const Tables tables = tables_of(materials);
    if (const auto written = write_all(*this, materials, tables); !written) return complain(written.error());
    print_summary(*this, tables);
    int status = k_done;
    for (const Reported& of : materials)
        if (!of.study) {
            fmt::print(stderr, "srbf: {}\n", of.error);
            status = k_input_error;
        }
    return status;
}

}  // namespace

void add_report(CommandLine& app, int& status) {
    const auto command = std::make_shared<ReportCommand>();
    const Subcommand sub = app.add_subcommand(
        "report", "Fit all kinds of models to materials and compare them: a page, tables, pictures, the models");
    std::vector<Option> besides;  // on which no study depends
    besides.push_back(sub.add_option("FILE", command->files, "Measurements").type_name("").required());
    besides.push_back(sub.add_option("-o,--output", command->folder,
                                     "The folder to write. Materials that are already complete there are skipped")
                          .type_name("DIR")
                          .required());
    sub.add_flag(
        "--quick", [command] { command->sweep = Sweep::quick; },
        "Fewer sizes, coarser pictures: about a minute per material on two cores");
    // For tests only: one small fit of each kind.
    sub.add_flag(
           "--least", [command] { command->sweep = Sweep::least; }, "")
        .hidden();
    add_mesh_options(sub, command->mesh, command->up);
    const Option labels =
        sub.add_option("--label", command->labels,
                       "Text beside a material's name, for example nickel=stand-in; may be repeated")
            .type_name("NAME=TEXT")
            .one_at_a_time()  // what follows the text is a file
            .check([](std::string& text) -> std::string {
                const auto at = text.find('=');
                return at == 0 || at == text.npos ? fmt::format("expected NAME=TEXT, found {}", text) : "";
            });
    besides.push_back(labels);
    besides.push_back(sub.add_option("--note", command->note, "Text at the top of the page").type_name("TEXT"));
    besides.push_back(sub.add_option("--threads", command->threads, "Total number of threads; 0: all of the machine")
                          .type_name("T")
                          .check(within(0, k_most_threads))
                          .capture_default_str());
    besides.push_back(
        sub.add_option("--jobs", command->jobs,
                       "Number of materials at a time, which share the threads; 0: one for every four cores")
            .type_name("N")
            .check(within(0, k_most_threads))
            .capture_default_str());
    sub.footer("Example:\n  srbf report materials/*.binary -o report --quick");
    sub.callback(
        [command, sub, besides, &status] {
            command->settings = sub.settings(besides);
            status = command->run();
        },
        {{{labels}, "each with the name of a FILE", [command] { return command->labels_are_of_files(); }}});
}

}  // namespace srbf
