// Facts of the kinds of files that `srbf export` writes.
#pragma once
#include "app/commands.h"
#include "app/surface_files.h"
#include "code/offered_code.h"

namespace srbf {

/// The help of an option of `srbf export`; empty if no extra adds it.
inline OptionHelp export_option(std::string_view name) {
    int status = 0;
    CommandLine app("srbf", "", "", "");
    add_subcommands(app, status);
    for (const SubcommandHelp& sub : app.help().subcommands)
        for (const OptionHelp& option : sub.options)
            if (sub.name == "export" && option.names.back() == name) return option;
    return {};
}
inline std::vector<std::string> export_kinds() { return export_option("--to").choices; }

inline bool is_of_maps(std::string_view kind) { return kind == "ktx2" || kind == "exr"; }
inline bool is_of_environments(std::string_view kind) { return kind == "dds"; }
inline bool is_of_surfaces(std::string_view kind) {
    return std::ranges::count(surface_files(), kind, &SurfaceFile::name) > 0;
}
/// True for pages, and for materials of other programs: these take seconds.
inline bool is_slow_export(std::string_view kind) {
    return !code_language_named(kind) && !is_of_maps(kind) && !is_of_environments(kind) && !is_of_surfaces(kind);
}
/// Options for a tenth of the time, if the help of --terms says that it is of this kind: "KIND, KIND: ...".
inline std::vector<std::string> quick_options(const std::string& kind) {
    const std::string about = export_option("--terms").about, kinds = ", " + about.substr(0, about.find(':')) + ",";
    return kinds.find(", " + kind + ",") == kinds.npos ? std::vector<std::string>()
                                                       : std::vector<std::string>{"--terms", "1"};
}

}  // namespace srbf
