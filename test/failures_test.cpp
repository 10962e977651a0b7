// One system call or allocation of the program fails. The program then prints one line and ends with status 1, or
// succeeds anyway. Each of its files has its old content or its complete new content.
#include <signal.h>
#include <sys/resource.h>
#include <sys/syscall.h>

#include <chrono>
#include <thread>

#include "app/hash.h"
#include "command.h"

namespace srbf::failures_test {
namespace {

namespace fs = std::filesystem;

/// A run of the program and the files that it writes.
struct Task {
    Arguments arguments;
    std::vector<std::string> outputs;
};

/// What a failure does, if it is not the number of an error.
constexpr int k_kill = 0, k_stop = -1;

struct Failure {
    std::string call;
    long index = -1;     ///< index of the call that fails; −1: none
    int error = k_kill;  ///< the number of the error, `k_kill` or `k_stop`
};

std::string text(const Failure& failure) {
    return fmt::format("{} {} fails with {}", failure.call, failure.index, failure.error);
}

std::string hash_of(const std::string& bytes) { return srbf::hash_of(std::as_bytes(std::span(bytes))); }

class Failures : public ProgramTest {
  protected:
    void SetUp() override {
        write_text(folder / "a.binary", small_merl());
        write_text(
            folder / "b.binary",
            as_text(merl_file({9, 6, 8}, [](int h, int d, int, int c) { return 0.2 + 0.01 * h * d + 0.1 * c; })));
        run_ok(folder, k_quick_fit + Arguments{"a.binary", "-o", "m.srbf"});
    }

    /// Calls `start` while the given call is set to fail. The number of calls is written to the file `count`.
    template <typename Start>
    static auto with_failure(const Failure& failure, const std::string& count, const Start& start) {
        ::setenv("LD_PRELOAD", SRBF_FAILING_CALLS, 1);
        ::setenv("SRBF_FAIL_CALL", failure.call.c_str(), 1);
        ::setenv("SRBF_FAIL_AT", std::to_string(failure.index).c_str(), 1);
        ::setenv("SRBF_FAIL_ERROR", std::to_string(failure.error).c_str(), 1);
        ::setenv("SRBF_FAIL_COUNT", count.c_str(), 1);
        const auto result = start();
        ::unsetenv("LD_PRELOAD");
        return result;
    }
    /// Runs the task with a failure. `calls` becomes the number of calls of that kind, if the program ended normally.
    ProgramRun run_with(const Task& task, const Failure& failure, std::optional<long>& calls) {
        const TemporaryFolder count_folder;
        const std::string count = count_folder / "count";
        const ProgramRun result = with_failure(failure, count, [&] { return run_srbf(folder, task.arguments); });
        const std::string number = read_text(count);
        calls = number.empty() ? std::nullopt : std::optional(std::stol(number));
        return result;
    }

    void write_old(const Task& task) {
        for (const std::string& name : task.outputs) {
            fs::create_directories((folder / name).parent_path());
            write_text(folder / name, "old");
        }
    }
    /// The outputs of a run without failures.
    std::map<std::string, std::string> complete_outputs(const Task& task) {
        write_old(task);
        run_ok(folder, task.arguments);
        std::map<std::string, std::string> outputs;
        for (const std::string& name : task.outputs) outputs[name] = read_text(folder / name);
        return outputs;
    }
    /// True if a file has its old or its complete content. A report contains durations; it is complete if it is
    /// JSON and names its model.
    bool is_old_or_complete(const std::string& name, const std::string& expected) {
        const std::string content = read_text(folder / name);
        if (content == "old" || content == expected) return true;
        return name.ends_with(".json") && is_report(name, name.substr(0, name.size() - 5) + ".srbf");
    }
    /// True if the report is complete and belongs to the model.
    bool is_report(const std::string& name, const std::string& model) {
        const Json report = Json::parse(read_text(folder / name), nullptr, false);
        return report.is_object() && report.value("model_hash", "") == hash_of(read_text(folder / model));
    }
    std::set<std::string> files() const {
        std::set<std::string> names;
        for (const auto& entry : fs::recursive_directory_iterator(folder.path))
            names.insert(fs::relative(entry.path(), folder.path).string());
        return names;
    }

    /// Returns true if the task succeeded. Expects in any case that files are old or complete.
    bool try_failure(const Task& task, const Failure& failure, const std::map<std::string, std::string>& expected,
                     std::optional<long>& calls) {
        SCOPED_TRACE(fmt::format("{}: {}", fmt::join(task.arguments, " "), text(failure)));
        write_old(task);
        const auto files_before = files();
        const ProgramRun result = run_with(task, failure, calls);
        EXPECT_TRUE(result.status == 0 || result.status == 1) << result.status << " " << result.err;
        if (result.status == 1) {
            EXPECT_ONE_LINE(result.err, "srbf: ");
        }
        for (const auto& [name, content] : expected) {
            EXPECT_TRUE(is_old_or_complete(name, content)) << name;
            if (result.status == 0) {
                EXPECT_NE(read_text(folder / name), "old") << name;
            }
        }
        EXPECT_EQ(files(), files_before);
        return result.status == 0;
    }

    /// Makes each system call fail in turn.
    void try_system_calls(const Task& task, const std::vector<std::string>& kinds, const std::vector<int>& errors) {
        const auto expected = complete_outputs(task);
        for (const std::string& call : kinds)
            for (const int error : errors)
                for (long index = 0;; ++index) {
                    std::optional<long> calls;
                    const bool succeeded = try_failure(task, {call, index, error}, expected, calls);
                    ASSERT_TRUE(calls);
                    if (*calls <= index) break;  // the call was not reached
                    // Calls interrupted by a signal are repeated.
                    const bool is_repeated = call != "rename" && call != "mmap";
                    EXPECT_TRUE(succeeded || error != EINTR || !is_repeated) << call << " " << index;
                    if (HasFailure()) return;
                }
    }
    /// Makes the first allocations fail, and some random ones.
    void try_allocations(const Task& task, long first, long random_ones) {
        const auto expected = complete_outputs(task);
        std::optional<long> total;
        try_failure(task, {"malloc", -1, ENOMEM}, expected, total);
        ASSERT_TRUE(total && *total > first);
        std::mt19937_64 random(1);
        for (long i = 0; i < first + random_ones; ++i) {
            std::optional<long> calls;
            const long index = i < first ? i : long(random() % std::uint64_t(*total));
            try_failure(task, {"malloc", index, ENOMEM}, expected, calls);
            if (HasFailure()) return;
        }
    }

    const Task convert_{{"convert", "a.binary", "-o", "x.csv", "--directions", "3"}, {"x.csv"}};
    const Task export_{{"export", "m.srbf", "--to", "glsl", "-o", "x.glsl"}, {"x.glsl"}};
    const Task fit_{k_quick_fit + Arguments{"a.binary", "-o", "x.srbf", "--json", "x.json"}, {"x.srbf", "x.json"}};
    const Task many_{k_quick_fit + Arguments{"a.binary", "b.binary", "--resume", "-o", "models"},
                     {"models/a.srbf", "models/a.json", "models/b.srbf", "models/b.json"}};
    const std::vector<std::string> writing_{"write", "fsync", "rename"};
};

TEST_F(Failures, SystemCallsLeaveFilesOldOrComplete) {
    try_system_calls(convert_, {"open", "read", "write", "fsync", "rename", "close", "mmap"}, {EINTR});
    try_system_calls(export_, writing_, {ENOSPC});
    try_system_calls(fit_, writing_, {ENOSPC});
}

TEST_F(Failures, AllocationsLeaveFilesOldOrComplete) {
    for (const Task& task : {convert_, export_}) try_allocations(task, 3, 5);
    try_allocations(fit_, 1, 3);
}

TEST_F(Failures, KilledRunsResume) {
    const auto expected = complete_outputs(many_);
    for (const std::string call : {"write", "fsync", "rename"})
        for (long index = 0;; index += 29) {
            SCOPED_TRACE(text({call, index, k_kill}));
            fs::remove_all(folder / "models");
            std::optional<long> calls;
            run_with(many_, {call, index, k_kill}, calls);
            run_ok(folder, many_.arguments);
            for (const auto& [name, content] : expected)
                if (name.ends_with(".srbf")) {
                    EXPECT_EQ(read_text(folder / name), content) << name;
                }
            EXPECT_CONTAINS(run_srbf(folder, many_.arguments).out, "2 kept");
            if (calls) break;  // the run was not killed
        }
}

/// Concurrent runs that write the same two files leave a matching pair: the second waits until the first has
/// renamed both.
TEST_F(Failures, ConcurrentRunsLeaveAMatchingPair) {
    const std::string k_flock = std::to_string(SYS_flock) + " ";
    const TemporaryFolder captured;
    write_text(folder / "c.binary", as_text(merl_file({9, 6, 8}, [](int h, int, int, int) { return 1.0 + h; })));
    const auto start_fit = [&](const std::string& input) {
        return start_srbf(folder, k_quick_fit + Arguments{input, "-o", "same.srbf", "--json", "same.json"},
                          captured / input, captured / "err");
    };
    // The first run stops between the two renames. The second may end before the first continues, or wait for it.
    const pid_t first = with_failure({"rename", 1, k_stop}, captured / "count", [&] { return start_fit("a.binary"); });
    int status = 0;
    ASSERT_EQ(::waitpid(first, &status, WUNTRACED), first);
    ASSERT_TRUE(WIFSTOPPED(status));
    const pid_t second = start_fit("b.binary");
    pid_t ended = 0;
    const auto waits = [&] { return read_text(fmt::format("/proc/{}/syscall", second)).starts_with(k_flock); };
    for (int i = 0; i < 1000 && ended == 0 && !waits(); ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
        ended = ::waitpid(second, &status, WNOHANG);
    }
    ::kill(first, SIGCONT);
    EXPECT_EQ(::waitpid(first, &status, 0), first);
    if (ended == 0) {
        EXPECT_EQ(::waitpid(second, &status, 0), second);
    }
    EXPECT_TRUE(is_report("same.json", "same.srbf"));
    std::vector<pid_t> processes;
    for (const char* input : {"a.binary", "b.binary", "c.binary"}) processes.push_back(start_fit(input));
    for (const pid_t process : processes) {
        EXPECT_EQ(::waitpid(process, &status, 0), process);
        EXPECT_EQ(status, 0);
    }
    EXPECT_TRUE(is_report("same.json", "same.srbf"));
}

/// A report next to another model is not accepted as the report of that model.
TEST_F(Failures, AReportBelongsToItsModel) {
    const Arguments start = k_quick_fit + Arguments{"--resume", "-o", "models"};
    run_ok(folder, start + Arguments{"a.binary"});
    run_ok(folder, start + Arguments{"b.binary"});
    const std::string model = read_text(folder / "models/a.srbf");
    EXPECT_CONTAINS(run_srbf(folder, start + Arguments{"a.binary"}).out, "1 kept");
    fs::copy(folder / "models/b.srbf", folder / "models/a.srbf", fs::copy_options::overwrite_existing);
    EXPECT_CONTAINS(run_srbf(folder, start + Arguments{"a.binary"}).out, "0 kept");
    EXPECT_EQ(read_text(folder / "models/a.srbf"), model);
    const Json report = Json::parse(read_text(folder / "models/a.json"), nullptr, false);
    EXPECT_EQ(report.value("model_hash", ""), hash_of(model));
}

/// The program inherits a limit on the file size [bytes]. A program that ignores the signal is not killed.
TEST_F(Failures, FilesBeyondTheLimitGiveOneLineOfError) {
    rlimit previous;
    ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &previous), 0);
    const auto previous_handler = ::signal(SIGXFSZ, SIG_DFL);
    for (const Arguments& arguments : {Arguments{"convert", "a.binary", "-o", "x.csv"},
                                       {"convert", "m.srbf", "-o", "x.binary"},
                                       {"render", "m.srbf", "-o", "x.exr", "--size", "16x16", "--spp", "1"},
                                       {"export", "m.srbf", "--to", "glsl", "-o", "x.glsl"},
                                       k_quick_fit + Arguments{"a.binary", "b.binary", "-o", "models"},
                                       {"completion", "bash"}}) {
        if (!is_built(arguments)) continue;
        SCOPED_TRACE(fmt::format("{}", fmt::join(arguments, " ")));
        const auto files_before = files();
        const rlimit low{512, previous.rlim_max};
        ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &low), 0);
        const ProgramRun result = run_srbf(folder, arguments);
        ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &previous), 0);
        EXPECT_EQ(result.status, 1) << result.err;
        EXPECT_TRUE(result.err.starts_with("srbf: ")) << result.err;
        fs::remove_all(folder / "models");
        EXPECT_EQ(files(), files_before);
    }
    ::signal(SIGXFSZ, previous_handler);
}

}  // namespace
}  // namespace srbf::failures_test
