// Runs the program in this process, and checks its promises for every run.
#pragma once
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "../test/support/temporary_folder.h"
#include "app/commands.h"
#include "require.h"

namespace srbf {

/// Discards standard output, and redirects standard error to a file, until `end`.
class OutputCapture {
  public:
    explicit OutputCapture(const std::string& file)
        : file_(file), out_(redirect(1, "/dev/null")), error_(redirect(2, file.c_str())) {}
    /// Restores both streams, and returns the text of standard error.
    std::string end() const {
        std::fflush(stdout);
        std::fflush(stderr);
        ::dup2(out_, 1);
        ::dup2(error_, 2);
        ::close(out_);
        ::close(error_);
        return read_text(file_);
    }

  private:
    static int redirect(int number, const char* path) {
        const int kept = ::dup(number), file = ::open(path, O_WRONLY | O_CREAT | O_TRUNC, 0600);
        ::dup2(file, number);
        ::close(file);
        return kept;
    }
    std::string file_;
    int out_, error_;
};

struct InProcess {
    int status;
    std::string error;
    int lines;  ///< number of lines of `error`
};

/// Runs the program with the given words in the folder. Checks that the exit status is 0, 1 or 2; that any other than 0
/// comes with lines that begin with the program's name and have no control characters; and that wrong usage is one line
/// that names the help.
inline InProcess run_in_process(const std::filesystem::path& folder, std::vector<std::string> words) {
    const std::string line = fmt::format("{}", fmt::join(words, " "));
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    const auto previous = std::filesystem::current_path();
    std::filesystem::current_path(folder);
    OutputCapture capture("x.err");
    InProcess done{run_program(int(words.size()), argv.data()), {}, 0};
    done.error = capture.end();
    std::filesystem::remove("x.err");
    std::filesystem::current_path(previous);
    if (std::getenv("SRBF_FUZZ_SHOW")) fmt::print(stderr, "{}\n  {} {}\n", line, done.status, done.error);
    const auto demand = [&](bool holds, const char* promise) {
        if (!holds) fmt::print(stderr, "{}\nstatus {}: {}\n", line, done.status, done.error);
        require(holds, promise);
    };
    demand(done.status >= k_done && done.status <= k_usage, "a status of 0, 1 or 2");
    demand(done.status == k_done || !done.error.empty(), "an error is said");
    std::istringstream lines(done.error);
    for (std::string text; std::getline(lines, text); ++done.lines) {
        demand(text.starts_with("srbf: "), "a message begins with the program's name");
        demand(std::ranges::none_of(text, [](unsigned char c) { return c < 0x20 || c == 0x7f; }),
               "no control characters");
    }
    demand(done.status != k_usage || (done.lines == 1 && done.error.ends_with("--help)\n")),
           "wrong usage is one line that names the help");
    return done;
}

}  // namespace srbf
