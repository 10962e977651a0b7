// One system call or allocation of the program fails: it ends with one line and status 1, or does its work all the same, and
// each of its files holds what it held before or all of what it should hold. SRBF_FAILURES=all tries every one of them.
#include <signal.h>
#include <sys/resource.h>
#include <sys/syscall.h>

#include <chrono>
#include <set>
#include <thread>

#include "app/hash.h"
#include "command.h"

namespace srbf::failures_test {
namespace {

namespace fs = std::filesystem;

/// What a run of the program should have written.
struct Task {
    Arguments arguments;
    std::vector<std::string> outputs;
};

struct Failure {
    std::string call;
    long at = -1;  ///< −1: none
    int error = 0;
};

std::string text(const Failure& of) { return fmt::format("{} {} fails with {}", of.call, of.at, of.error); }

std::string hash_of(const std::string& bytes) { return srbf::hash_of(std::as_bytes(std::span(bytes))); }

bool tries_all() {
    const char* const wanted = std::getenv("SRBF_FAILURES");
    return wanted && wanted == std::string("all");
}

class Failures : public CommandLine {
  protected:
    void SetUp() override {
        write(folder / "a.binary", small_merl());
        write(folder / "b.binary",
              text_of(merl_file({9, 6, 8}, [](int h, int d, int, int c) { return 0.2 + 0.01 * h * d + 0.1 * c; })));
        const ProgramRun fitted = run(folder, k_quick_fit + Arguments{"a.binary", "-o", "m.srbf"});
        ASSERT_EQ(fitted.status, 0) << fitted.err;
    }

    /// What is started meanwhile has such a call; the number of calls is written to the file `count`.
    template <typename Start>
    static auto failing(const Failure& failure, const std::string& count, const Start& start) {
        ::setenv("LD_PRELOAD", SRBF_FAILING_CALLS, 1);
        ::setenv("SRBF_FAIL_CALL", failure.call.c_str(), 1);
        ::setenv("SRBF_FAIL_AT", std::to_string(failure.at).c_str(), 1);
        ::setenv("SRBF_FAIL_ERROR", std::to_string(failure.error).c_str(), 1);
        ::setenv("SRBF_FAIL_COUNT", count.c_str(), 1);
        const auto started = start();
        ::unsetenv("LD_PRELOAD");
        return started;
    }
    /// Runs the task in which a call fails; `calls`: how many of its kind there were, if the program ended by itself.
    ProgramRun run_with(const Task& task, const Failure& failure, std::optional<long>& calls) {
        const TemporaryFolder counted;
        const std::string count = counted / "count";
        const ProgramRun ended = failing(failure, count, [&] { return run(folder, task.arguments); });
        const std::string number = contents(count);
        calls = number.empty() ? std::nullopt : std::optional(std::stol(number));
        return ended;
    }

    void write_old(const Task& task) {
        for (const std::string& name : task.outputs) {
            fs::create_directories((folder / name).parent_path());
            write(folder / name, "old");
        }
    }
    /// The outputs of a run in which nothing fails.
    std::map<std::string, std::string> whole(const Task& task) {
        write_old(task);
        const ProgramRun done = run(folder, task.arguments);
        EXPECT_EQ(done.status, 0) << done.err;
        std::map<std::string, std::string> all;
        for (const std::string& name : task.outputs) all[name] = contents(folder / name);
        return all;
    }
    /// True if a file is old or whole. A report, which holds durations, is whole if it is JSON that names its model.
    bool is_old_or_whole(const std::string& name, const std::string& expected) {
        const std::string found = contents(folder / name);
        if (found == "old" || found == expected) return true;
        return name.ends_with(".json") && is_report(name, name.substr(0, name.size() - 5) + ".srbf");
    }
    /// Whether the report is whole and that of the model.
    bool is_report(const std::string& name, const std::string& model) {
        const Json report = Json::parse(contents(folder / name), nullptr, false);
        return report.is_object() && report.value("model_hash", "") == hash_of(contents(folder / model));
    }
    std::set<std::string> files() const {
        std::set<std::string> names;
        for (const auto& entry : fs::recursive_directory_iterator(folder.path))
            names.insert(fs::relative(entry.path(), folder.path).string());
        return names;
    }

    /// Whether the task was done; in any case what is promised of a failure holds.
    bool try_failure(const Task& task, const Failure& failure, const std::map<std::string, std::string>& expected,
                     std::optional<long>& calls) {
        SCOPED_TRACE(fmt::format("{}: {}", fmt::join(task.arguments, " "), text(failure)));
        write_old(task);
        const auto before = files();
        const ProgramRun ended = run_with(task, failure, calls);
        EXPECT_TRUE(ended.status == 0 || ended.status == 1) << ended.status << " " << ended.err;
        if (ended.status == 1) {
            EXPECT_TRUE(ended.err.starts_with("srbf: ")) << ended.err;
            EXPECT_EQ(ended.err.find('\n'), ended.err.size() - 1) << ended.err;
        }
        for (const auto& [name, content] : expected) {
            EXPECT_TRUE(is_old_or_whole(name, content)) << name;
            if (ended.status == 0) {
                EXPECT_NE(contents(folder / name), "old") << name;
            }
        }
        EXPECT_EQ(files(), before);
        return ended.status == 0;
    }

    /// Each system call in turn.
    void try_system_calls(const Task& task, const std::vector<std::string>& kinds, const std::vector<int>& errors) {
        const auto expected = whole(task);
        for (const std::string& call : kinds)
            for (const int error : errors)
                for (long at = 0;; ++at) {
                    std::optional<long> calls;
                    const bool done = try_failure(task, {call, at, error}, expected, calls);
                    ASSERT_TRUE(calls);
                    if (*calls <= at) break;  // it was not reached
                    // What a signal interrupts is repeated.
                    const bool is_repeated = call != "rename" && call != "mmap";
                    EXPECT_TRUE(done || error != EINTR || !is_repeated) << call << " " << at;
                    if (HasFailure()) return;
                }
    }
    /// The first allocations and some at random.
    void try_allocations(const Task& task, long first, long random_ones) {
        const auto expected = whole(task);
        std::optional<long> count;
        try_failure(task, {"malloc", -1, ENOMEM}, expected, count);
        ASSERT_TRUE(count && *count > first);
        std::mt19937_64 random(1);
        for (long i = 0; i < first + random_ones; ++i) {
            std::optional<long> calls;
            const long at = i < first ? i : long(random() % std::uint64_t(*count));
            try_failure(task, {"malloc", at, ENOMEM}, expected, calls);
            if (HasFailure()) return;
        }
    }

    const Task convert_{{"convert", "a.binary", "-o", "x.csv", "--directions", "3"}, {"x.csv"}};
    const Task export_{{"export", "m.srbf", "--to", "glsl", "-o", "x.glsl"}, {"x.glsl"}};
    const Task fit_{k_quick_fit + Arguments{"a.binary", "-o", "x.srbf", "--json", "x.json"}, {"x.srbf", "x.json"}};
    const Task many_{k_quick_fit + Arguments{"a.binary", "b.binary", "--resume", "-o", "models"},
                     {"models/a.srbf", "models/a.json", "models/b.srbf", "models/b.json"}};
    const Task report_{{"report", "a.binary", "-o", "r", "--least", "--threads", "1"}, {}};
    const std::vector<std::string> every_call_{"open", "read", "write", "fsync", "rename", "close", "mmap"};
    const std::vector<int> every_error_{EIO, ENOSPC, EINTR, EXDEV};
    const std::vector<std::string> writing_{"write", "fsync", "rename"};
};

TEST_F(Failures, SystemCallsLeaveFilesOldOrWhole) {
    if (tries_all()) {
        for (const Task& task : {convert_, export_, fit_, many_}) try_system_calls(task, every_call_, every_error_);
        return;
    }
    try_system_calls(convert_, every_call_, {EINTR});
    try_system_calls(export_, writing_, {ENOSPC});
    try_system_calls(fit_, writing_, {ENOSPC});
}

TEST_F(Failures, AllocationsLeaveFilesOldOrWhole) {
    if (tries_all()) {
        for (const Task& task : {convert_, export_, many_}) try_allocations(task, 200, 500);
        return;
    }
    for (const Task& task : {convert_, export_}) try_allocations(task, 3, 5);
    try_allocations(fit_, 1, 3);
}

TEST_F(Failures, WhatWasKilledResumes) {
    const auto expected = whole(many_);
    for (const std::string call : {"write", "fsync", "rename"})
        for (long at = 0;; at += tries_all() ? 1 : 17) {
            SCOPED_TRACE(text({call, at, 0}));
            fs::remove_all(folder / "models");
            std::optional<long> calls;
            run_with(many_, {call, at, 0}, calls);
            const ProgramRun resumed = run(folder, many_.arguments);
            EXPECT_EQ(resumed.status, 0) << resumed.err;
            for (const auto& [name, content] : expected)
                if (name.ends_with(".srbf")) {
                    EXPECT_EQ(contents(folder / name), content) << name;
                }
            EXPECT_NE(run(folder, many_.arguments).out.find("2 kept"), std::string::npos);
            if (calls) break;  // it was not killed
        }
}

/// What a report has of results, without what depends on time.
std::map<std::string, std::string> results_of(const fs::path& report) {
    std::map<std::string, std::string> all;
    for (const auto& entry : fs::recursive_directory_iterator(report)) {
        const fs::path file = fs::relative(entry.path(), report);
        const bool is_of_clocks = !file.has_parent_path() || file.filename() == "times.json" ||
                                  file.filename() == "frames.json" || file.filename() == "index.html";
        if (entry.is_regular_file()) all[file.string()] = is_of_clocks ? "" : contents(entry.path());
    }
    return all;
}

/// A report that is killed while it draws, and between its tables, is done by the next run.
TEST_F(Failures, AReportGoesOnWhereItWasKilled) {
    if (!is_offered({"report"})) GTEST_SKIP() << "without srbf report";
    ASSERT_EQ(run(folder, report_.arguments).status, 0);
    const auto whole = results_of(folder.path / "r");
    const auto files_beside = files();
    fs::remove_all(folder / "r");
    for (const long at : {6, 45}) {
        std::optional<long> calls;
        run_with(report_, {"rename", at, 0}, calls);
        EXPECT_FALSE(calls) << "it was done before it was killed, at " << at;
    }
    EXPECT_EQ(run(folder, report_.arguments).status, 0);
    EXPECT_TRUE(results_of(folder.path / "r") == whole);
    EXPECT_EQ(files(), files_beside);
}

/// The same of any moment; and a report in which something fails.
TEST_F(Failures, AReportGoesOnAfterAnyOfThem) {
    if (!tries_all()) GTEST_SKIP() << "SRBF_FAILURES=all";
    if (!is_offered({"report"})) GTEST_SKIP() << "without srbf report";
    const Task& task = report_;
    ASSERT_EQ(run(folder, task.arguments).status, 0);
    const auto whole = results_of(folder.path / "r");
    const auto files_beside = files();
    /// Whether it had such a call.
    const auto goes_on = [&](const Failure& failure) {
        SCOPED_TRACE(text(failure));
        fs::remove_all(folder / "r");
        std::optional<long> calls;
        const ProgramRun ended = run_with(task, failure, calls);
        if (calls) {
            EXPECT_TRUE(ended.status == 0 || ended.status == 1) << ended.status << " " << ended.err;
            EXPECT_EQ(ended.status == 1, ended.err.starts_with("srbf: ")) << ended.err;
            EXPECT_EQ(std::ranges::count(ended.err, '\n'), ended.status) << ended.err;
        }
        const ProgramRun resumed = run(folder, task.arguments);
        EXPECT_EQ(resumed.status, 0) << resumed.err;
        EXPECT_TRUE(results_of(folder.path / "r") == whole);
        EXPECT_EQ(files(), files_beside);
        return !calls || *calls > failure.at;
    };
    for (const std::string call : {"write", "fsync", "rename"})
        for (long at = 0; goes_on({call, at, 0}) && !HasFailure(); at += 3) continue;
    for (const std::string& call : every_call_)
        for (long at = 0; goes_on({call, at, call == "write" ? ENOSPC : EIO}) && !HasFailure(); at += 7) continue;
    for (long at = 1; goes_on({"malloc", at, ENOMEM}) && !HasFailure(); at += at / 4 + 1) continue;
}

/// Runs at once that write the same files leave a pair: the second waits until the first has renamed both.
TEST_F(Failures, RunsAtOnceLeaveAPair) {
    const std::string k_flock = std::to_string(SYS_flock) + " ";
    const TemporaryFolder captured;
    write(folder / "c.binary", text_of(merl_file({9, 6, 8}, [](int h, int, int, int) { return 1.0 + h; })));
    const auto start_fit = [&](const std::string& input) {
        return start(folder, k_quick_fit + Arguments{input, "-o", "same.srbf", "--json", "same.json"}, captured / input,
                     captured / "err");
    };
    // Between both the first one stops; the second may end before it goes on, or wait for it.
    const pid_t first = failing({"rename", 1, -1}, captured / "count", [&] { return start_fit("a.binary"); });
    int status = 0;
    ASSERT_EQ(::waitpid(first, &status, WUNTRACED), first);
    ASSERT_TRUE(WIFSTOPPED(status));
    const pid_t second = start_fit("b.binary");
    pid_t ended = 0;
    const auto waits = [&] { return contents(fmt::format("/proc/{}/syscall", second)).starts_with(k_flock); };
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
    for (int round = 0; round < (tries_all() ? 10 : 1); ++round) {
        std::vector<pid_t> all;
        for (const char* input : {"a.binary", "b.binary", "c.binary"}) all.push_back(start_fit(input));
        for (const pid_t process : all) {
            EXPECT_EQ(::waitpid(process, &status, 0), process);
            EXPECT_EQ(status, 0);
        }
        EXPECT_TRUE(is_report("same.json", "same.srbf"));
    }
}

/// A report beside another model than its own is not taken for that model's.
TEST_F(Failures, AReportIsThatOfItsModel) {
    const Arguments start = k_quick_fit + Arguments{"--resume", "-o", "models"};
    ASSERT_EQ(run(folder, start + Arguments{"a.binary"}).status, 0);
    ASSERT_EQ(run(folder, start + Arguments{"b.binary"}).status, 0);
    const std::string model = contents(folder / "models/a.srbf");
    EXPECT_NE(run(folder, start + Arguments{"a.binary"}).out.find("1 kept"), std::string::npos);
    fs::copy(folder / "models/b.srbf", folder / "models/a.srbf", fs::copy_options::overwrite_existing);
    EXPECT_NE(run(folder, start + Arguments{"a.binary"}).out.find("0 kept"), std::string::npos);
    EXPECT_EQ(contents(folder / "models/a.srbf"), model);
    const Json report = Json::parse(contents(folder / "models/a.json"), nullptr, false);
    EXPECT_EQ(report.value("model_hash", ""), hash_of(model));
}

/// The bound of a file's size [bytes] that the program inherits; it ends no process that ignores the signal.
TEST_F(Failures, FilesBeyondTheLimitAreOneLine) {
    rlimit before;
    ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
    const auto old = ::signal(SIGXFSZ, SIG_DFL);
    for (const Arguments& arguments : {Arguments{"convert", "a.binary", "-o", "x.csv"},
                                       {"convert", "m.srbf", "-o", "x.binary"},
                                       {"render", "m.srbf", "-o", "x.exr", "--size", "16x16", "--spp", "1"},
                                       {"export", "m.srbf", "--to", "glsl", "-o", "x.glsl"},
                                       k_quick_fit + Arguments{"a.binary", "b.binary", "-o", "models"},
                                       {"completion", "bash"}}) {
        if (!is_offered(arguments)) continue;
        SCOPED_TRACE(fmt::format("{}", fmt::join(arguments, " ")));
        const auto files_before = files();
        const rlimit low{512, before.rlim_max};
        ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &low), 0);
        const ProgramRun ended = run(folder, arguments);
        ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
        EXPECT_EQ(ended.status, 1) << ended.err;
        EXPECT_TRUE(ended.err.starts_with("srbf: ")) << ended.err;
        fs::remove_all(folder / "models");
        EXPECT_EQ(files(), files_before);
    }
    ::signal(SIGXFSZ, old);
}

}  // namespace
}  // namespace srbf::failures_test
