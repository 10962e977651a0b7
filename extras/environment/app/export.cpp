// Adds to `srbf export` environments that are filtered for its code.
#include "app/export.h"

#include <cstdio>

#include "app/commands.h"
#include "app/output.h"
#include "base/printable.h"
#include "extras/environment/app/filtered_environment.h"
#include "extras/render/app/path.h"
#include "generated/app/extra_exports.h"
#include "srbf/file.h"

namespace SRBF_NAMESPACE {
namespace {

int filter_environment(const ExportCommand& command) {
    const auto& files = command.files;
    if (files.size() != 1)
        return complain(
            {command.output, {}, "inputs", "one environment", std::to_string(files.size()), ErrorCode::argument});
    if (const auto writable = check_outputs(files, {command.output}); !writable) return complain(writable.error());
    const auto environment = load_light(files[0]);
    if (!environment) return complain(environment.error());
    if (!*environment) return complain({files[0], {}, "input", "an environment", "none", ErrorCode::argument});
    ProgressLine line;
    const FilteredEnvironment filtered(**environment, FilteredEnvironment::k_usual_size, 0,
                                       [&](double part) { line.show("filtering", part); });
    line.clear();
    const CubeFile file = to_dds(filtered);
    if (file.clamped > 0)
        fmt::print(stderr, "srbf: {}: {} texels are brighter than 65504, the largest 16-bit float, and are set to it\n",
                   printable(command.output), grouped(file.clamped));
    return status_of(write_file(command.output, file.bytes));
}

}  // namespace

void add_environment_exports(const Subcommand&, const ExportCommand&, Exports& exports) {
    exports.kinds.push_back({"dds", filter_environment});
    exports.about +=
        "\ndds: an environment (.hdr, .exr or studio), which is MODEL here, filtered for NAME_environment, a cube\n"
        "map of 16-bit floats";
}

}  // namespace
