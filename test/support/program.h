// Runs the program as a user does: arguments in, output and exit status out.
#pragma once
#include <fcntl.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>

#include <vector>

#include "temporary_folder.h"

namespace srbf {

/// The result of a run. A status below 0 is the signal that killed the program.
struct ProgramRun {
    int status = 0;
    std::string out, err;
};

/// Starts the program with `arguments` in `folder`, with its standard output and error in these files. Returns 0 if it
/// did not start.
inline pid_t start_srbf(const TemporaryFolder& folder, const std::vector<std::string>& arguments,
                        const std::string& out, const std::string& err) {
    const std::string program = SRBF_PROGRAM;
    std::vector<char*> argv{const_cast<char*>(program.c_str())};
    for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);

    posix_spawn_file_actions_t actions;
    ::posix_spawn_file_actions_init(&actions);
    ::posix_spawn_file_actions_addchdir_np(&actions, folder.path.c_str());
    ::posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
    ::posix_spawn_file_actions_addopen(&actions, 1, out.c_str(), O_WRONLY | O_CREAT, 0600);
    ::posix_spawn_file_actions_addopen(&actions, 2, err.c_str(), O_WRONLY | O_CREAT, 0600);
    pid_t process = 0;
    const int failure = ::posix_spawn(&process, program.c_str(), &actions, nullptr, argv.data(), environ);
    ::posix_spawn_file_actions_destroy(&actions);
    EXPECT_EQ(failure, 0) << program;
    return failure == 0 ? process : 0;
}

/// Runs the program with `arguments` in `folder`. Standard output is captured, or goes to the device `out`.
inline ProgramRun run_srbf(const TemporaryFolder& folder, const std::vector<std::string>& arguments,
                           std::string out = {}) {
    const TemporaryFolder captured;
    if (out.empty()) out = captured / "out";
    const std::string err = captured / "err";
    const pid_t process = start_srbf(folder, arguments, out, err);
    if (process == 0) return {-1, {}, {}};
    int status = 0;
    EXPECT_EQ(::waitpid(process, &status, 0), process);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status),
            std::filesystem::is_regular_file(out) ? read_text(out) : "", read_text(err)};
}

/// Runs the program, and expects success.
inline ProgramRun run_ok(const TemporaryFolder& folder, const std::vector<std::string>& arguments) {
    ProgramRun result = run_srbf(folder, arguments);
    EXPECT_EQ(result.status, 0) << testing::PrintToString(arguments) << '\n' << result.err;
    return result;
}

}  // namespace srbf
