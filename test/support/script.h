// Scripts of Python that tests run.
#pragma once
#include <fmt/format.h>
#include <sys/wait.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "temporary_folder.h"

namespace srbf {

struct ScriptRun {
    int status = -1;   ///< −1 if a signal ended it
    std::string text;  ///< its output and errors
};

/// Runs a script of this project, by its path in the clone.
inline ScriptRun run_script(const std::string& script, const std::vector<std::string>& arguments) {
    const TemporaryFolder folder;
    const std::string output = (folder / "output").string();
    std::string command =
        fmt::format("PYTHONDONTWRITEBYTECODE=1 PYTHONPATH='{0}/test' python3 '{0}/{1}'", SRBF_SOURCE_DIR, script);
    for (const std::string& argument : arguments) command += fmt::format(" '{}'", argument);
    const int status = std::system((command + " > '" + output + "' 2>&1").c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_text(output)};
}

/// Skips a test whose script lacks what it needs, or Python itself.
#define SKIP_IF_UNAVAILABLE(run) \
    if ((run).status == 77 || (run).status == 127) GTEST_SKIP() << (run).text

}  // namespace srbf
