// Common parts of tests of the command line: a small fit, small input, and the properties of a failure.
#pragma once
#include <fmt/format.h>

#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "base/text.h"
#include "measured_files.h"
#include "program.h"
#include "properties.h"

namespace srbf {

using Json = nlohmann::json;
using Arguments = std::vector<std::string>;

inline const std::string k_paper = bundled_data() / "paper_white_rgb.bsdf";
/// Measures of a report, over the matrix and held out.
inline const Arguments k_measure_keys{"squared_error_ratio",
                                      "heldout_squared_error_ratio",
                                      "squared_error_ratio_cosine",
                                      "heldout_squared_error_ratio_cosine",
                                      "log_rms_cosine",
                                      "heldout_log_rms_cosine",
                                      "sixth_root_error_ratio",
                                      "heldout_sixth_root_error_ratio",
                                      "cube_root_error_ratio",
                                      "heldout_cube_root_error_ratio"};

inline Arguments operator+(Arguments a, const Arguments& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

/// Splits a text at blanks.
inline Arguments words(const std::string& text) {
    std::istringstream in(text);
    return {std::istream_iterator<std::string>(in), {}};
}

/// The long names of all options of each subcommand, from the completion for bash.
inline std::map<std::string, Arguments> long_options(const TemporaryFolder& folder) {
    std::map<std::string, Arguments> all;
    std::istringstream lines(run_srbf(folder, {"completion", "bash"}).out);
    for (std::string line; std::getline(lines, line);) {
        const auto at = line.find(":*:-*) words='");
        if (at == line.npos) continue;
        for (const std::string& word : words(line.substr(at + 14, line.rfind('\'') - at - 14)))
            if (word.starts_with("--") && word != "--help") all[words(line.substr(0, at))[0]].push_back(word);
    }
    return all;
}

/// True if the program has all extras that the command line needs: subcommands, kinds of `srbf export`, and functions
/// of its code.
inline bool is_built(const Arguments& arguments) {
    static const std::set<std::string> extras{"render",       "map",   "report",  "html",        "exr",
                                              "dds",          "three", "area",    "environment", "environment-draws",
                                              "three-webgpu", "unity", "blender", "osl",         "radiance"};
    static const std::set<std::string> built = [] {
        std::string text = run_srbf(TemporaryFolder(), {"completion", "bash"}).out;
        std::ranges::replace(text, '\'', ' ');
        const Arguments all = words(text);
        return std::set<std::string>(all.begin(), all.end());
    }();
    return std::ranges::all_of(arguments, [](const std::string& argument) {
        // "three" is a choice of lights, too.
        return !extras.contains(argument) || built.contains(argument == "three" ? "three-webgpu" : argument);
    });
}

/// A MERL file of a smooth glossy material.
inline std::string small_merl() {
    return std::string(
        as_text(merl_file({9, 6, 8}, [](int h, int, int, int c) { return 0.1 + std::exp(-h) * (1 + c); })));
}

/// The fastest fit of a table, without the names of files.
inline const Arguments k_quick_fit{"fit", "--model",     "su",  "--directions", "8", "--lobes",
                                   "1",   "--objective", "raw", "--threads",    "1"};

/// The command line in a folder of its own.
class ProgramTest : public testing::Test {
  protected:
    /// Runs the program in `folder`, and expects `status`, one line on standard error that contains `named`, and
    /// nothing else. Skips subcommands of extras that are not built.
    void expect_failure(int status, const Arguments& arguments, const std::string& named, std::string out = {}) {
        if (!is_built(arguments)) return;
        SCOPED_TRACE(fmt::format("{}", fmt::join(arguments, " ")));
        const auto before = folder.files();
        const ProgramRun failed = run_srbf(folder, arguments, std::move(out));
        EXPECT_EQ(failed.status, status);
        EXPECT_EQ(failed.out, "");
        EXPECT_ONE_LINE(failed.err, "srbf: ");
        EXPECT_CONTAINS(failed.err, named);
        EXPECT_EQ(folder.files(), before);
    }

    TemporaryFolder folder;
};

/// A small fit of bundled data, shared by several tests.
class SmallFit : public ProgramTest {
  protected:
    static void SetUpTestSuite() {
        fitted = std::make_unique<TemporaryFolder>();
        first = run_srbf(*fitted, {"fit", k_paper, "-o", "m.srbf", "--lobes", "2", "--variates", "2", "--threads", "1",
                                   "--preview", "p.png", "--json", "r.json"});
    }
    static void TearDownTestSuite() { fitted.reset(); }
    static Json report() { return Json::parse(read_text(*fitted / "r.json"), nullptr, false); }

    inline static std::unique_ptr<TemporaryFolder> fitted;
    inline static ProgramRun first;
};

}  // namespace srbf
