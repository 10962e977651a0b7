// A material of a report: all its results, in a folder of its own.
#pragma once
#include <functional>

#include "app/output.h"
#include "extras/render/scene.h"
#include "extras/report/plan.h"
#include "srbf/result.h"

namespace SRBF_NAMESPACE {

/// The page that compares the main fit (role "pm", see `plan`) with the measurement.
inline constexpr char k_page_file[] = "page.html";
/// Polar angles of the light in plots of lobes [degrees].
inline constexpr std::array<double, 3> k_lobe_theta{0, 45, 75};
inline constexpr std::size_t k_max_scans = 6;  ///< maximum number of scans that are drawn

/// Options of studies.
struct StudyOptions {
    Sweep sweep = Sweep::whole;
    std::string mesh = "knot";  ///< the mesh of the second picture; see `load_mesh`
    bool z_up = false;
    int threads = 1;            ///< number of threads of each fit and picture
    int jobs = 1;               ///< number of materials processed at the same time
    std::string settings = {};  ///< the options on the command line that a study depends on, for its key
};

/// A completed study, in its folder STEM-KEY:
///   material.json  results; the same in every run
///   times.json     durations
///   frames.json    frames per second; measured later, while nothing else runs
///   *.srbf *.png *.jpg lobes.csv
///   `k_page_file`
/// A folder is written under a temporary name and then renamed, so that an existing folder is complete.
struct Study {
    std::string folder;  ///< its path
    Json material, times, frames;
};

/// The name of a study's folder: the file's stem, and a hash of its content, the options, the mesh and the
/// program's version.
Result<std::string> study_name(const std::string& file, const StudyOptions& options);
/// The study in a folder; none if it is missing or incomplete.
std::optional<Study> load_study(const std::string& folder);
/// Makes a study: fits, draws and writes. `progress` receives the stage and the completed fraction. Returns an error if
/// the file cannot be read, no fit succeeded, or the folder cannot be written.
Result<Study> make_study(const std::string& file, const std::string& folder, const StudyOptions& options,
                         const std::function<void(const std::string&, double)>& progress);
/// Measures frames per second of the fitted models and writes frames.json. Returns an error if the renderer is not
/// available.
Result<Done> time_study(Study& study, const StudyOptions& options);

}  // namespace
