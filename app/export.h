// The kinds of files that `srbf export` writes, from the core and from extras.
#pragma once
#include "app/load.h"
#include "app/options.h"

namespace srbf {

/// The command line of `srbf export`.
struct ExportCommand {
    std::vector<std::string> files, with;
    std::string to, output;
    std::string coefficients;  ///< half or byte, those in the texture of a map; empty: half

    /// The path of a file beside the output.
    std::string beside(const std::string& name) const;
};

/// A kind of file, and the function that writes it and returns the exit status.
struct ExportKind {
    std::string name;
    std::function<int(const ExportCommand&)> run;
};
struct Exports {
    std::vector<ExportKind> kinds;
    std::string about;  ///< a line or more for each kind, for the help
    std::vector<AllowedWhen> allowed;
};

/// Loads the models in the files, or the map that is the only one, and checks that it can be written as layers.
using ModelsOrMap = std::variant<std::vector<LoadedFile>, TexelMap>;
Result<ModelsOrMap> load_models_or_map(const std::vector<std::string>& files);
/// Loads models; a map is an error.
Result<std::vector<LoadedFile>> load_models(const std::vector<std::string>& files);
/// Loads the map that the command line names; models are an error. Checks that the output can be written.
Result<TexelMap> load_map(const ExportCommand& command);

}  // namespace srbf
