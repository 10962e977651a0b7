// One material of a report: all that is found out about it, kept in a folder of its own.
#pragma once
#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/report.h"
#include "app/survey/plan.h"
#include "render/scene.h"
#include "srbf/result.h"

namespace srbf {

/// Light of the lobes that are drawn [degrees].
inline constexpr std::array<double, 3> k_lobe_theta{0, 45, 75};

/// How materials are studied; but for the threads a part of a study's key.
struct StudyOptions {
    Sweep sweep = Sweep::whole;
    std::string mesh = "knot";  ///< of the second picture, as `load_mesh` takes it
    bool z_up = false;
    int threads = 1;  ///< of each fit and picture
    int jobs = 1;     ///< materials that are studied at a time
};

/// A finished study, in its folder STEM-KEY:
///   material.json  what was found; the same in every run
///   times.json     what the clock said
///   frames.json    frames a second; made later, while nothing else runs
///   *.srbf *.png *.jpg lobes.csv
/// A folder is filled beside its place and renamed, so that one that is there is whole.
struct Study {
    std::string folder;  ///< its path
    Json material, times, frames;
};

/// The name of the folder: the file's stem, and a hash of its content, the options, the mesh and the program's version.
Result<std::string> study_name(const std::string& file, const StudyOptions& options);
/// The study in that folder, if there is one.
std::optional<Study> load_study(const std::string& folder);
/// Fits, draws and writes. `progress` is told what is going on and which part is done. Errors: those of the file; no fit succeeded; the folder
/// cannot be written.
Result<Study> make_study(const std::string& file, const std::string& folder, const StudyOptions& options,
                         const std::function<void(const std::string&, double)>& progress);
/// Times frames of what was fitted and writes frames.json. Errors: no such renderer.
Result<Done> time_study(Study& study, const StudyOptions& options);

}  // namespace srbf
