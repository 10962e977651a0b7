// The kinds of files that `srbf export` writes: kinds of the core, and those that extras add.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "app/load.h"
#include "app/options.h"

namespace srbf {

/// The command line of `srbf export`.
struct ExportCommand {
    std::vector<std::string> files, with;
    std::string to, output;

    /// A file of that name beside the output.
    std::string beside(const std::string& name) const;
};

/// A kind of what is written, and what writes it and returns the exit status.
struct ExportKind {
    std::string name;
    std::function<int(const ExportCommand&)> run;
};
struct Exports {
    std::vector<ExportKind> kinds;
    std::string about;  ///< a line or more for each kind, for the help
    std::vector<Reading> readings;
};

/// The models in those files; other content is an error.
Result<std::vector<Subject>> load_models(const std::vector<std::string>& files);
/// The map in the file of the command line, whose output and `more` can be written. Errors: none, several files.
Result<Library> load_map(const ExportCommand& asked, const std::vector<std::string>& more = {});

}  // namespace srbf
