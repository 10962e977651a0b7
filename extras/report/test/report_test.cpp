// `srbf report`: all numbers of its pages are in its tables, and complete materials are skipped.
#include <fmt/format.h>
#include <signal.h>

#include <chrono>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <thread>

#include "base/text.h"
#include "command.h"

namespace srbf::report_test {
namespace {

namespace fs = std::filesystem;
using Files = std::map<fs::path, std::string>;

/// Two small materials, whose names have no digits, and a file that is none.
void write_materials(const TemporaryFolder& folder) {
    for (const double gloss : {1.0, 9.0})
        write(folder / (gloss == 1 ? "matt.binary" : "krylon_blue.binary"),
              text_of(merl_file({9, 6, 8}, [&](int h, int d, int, int c) {
                  return 0.1 + gloss * std::exp(-h * gloss) * (1 + c) + 0.01 * d;
              })));
    write(folder / "broken.binary", "no measurement");
}

/// All files of a report, by their path in it.
Files files_of(const fs::path& report) {
    Files all;
    for (const auto& entry : fs::recursive_directory_iterator(report))
        if (entry.is_regular_file()) all[fs::relative(entry.path(), report)] = contents(entry.path());
    return all;
}
/// Results that depend on time, in the folder of a material; and all files, its page too, that contain them.
bool is_measured_time(const fs::path& file) {
    return file.filename() == "times.json" || file.filename() == "frames.json";
}
bool is_of_clocks(const fs::path& file) {
    return is_measured_time(file) || file.filename() == "index.html" || !file.has_parent_path();
}

Arguments arguments(const std::string& output) {
    return {"report",    "matt.binary", "broken.binary", "krylon_blue.binary",      "-o",
            output,      "--least",     "--label",       "matt=stand-in & <so on>", "--note",
            "Not <real>"};
}

class Report : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        folder = std::make_unique<TemporaryFolder>();
        write_materials(*folder);
        first = run(*folder, arguments("whole"));
        const fs::path whole = folder->path / "whole";
        html = contents(whole / "index.html");
        pages = {whole / "index.html", whole / "numbers.html", page_of("matt"), page_of("krylon_blue")};
    }
    /// The page of a material of that name.
    static fs::path page_of(const std::string& name) {
        for (const auto& entry : fs::directory_iterator(folder->path / "whole"))
            if (entry.path().filename().string().starts_with(name + "-")) return entry.path() / "index.html";
        return {};
    }
    static void TearDownTestSuite() { folder.reset(); }

    static std::unique_ptr<TemporaryFolder> folder;
    static ProgramRun first;
    static std::string html;  ///< the gallery
    static std::vector<fs::path> pages;
};
std::unique_ptr<TemporaryFolder> Report::folder;
ProgramRun Report::first;
std::string Report::html;
std::vector<fs::path> Report::pages;

TEST_F(Report, OneMaterialThatFailsDoesNotStopTheOthers) {
    EXPECT_EQ(first.status, 1);
    EXPECT_TRUE(first.err.starts_with("srbf: broken.binary: ")) << first.err;
    EXPECT_EQ(first.err.find('\n'), first.err.size() - 1) << first.err;
    for (const char* name : {"matt", "krylon_blue"})
        EXPECT_NE(html.find(fmt::format("'>{}</a>", name)), html.npos) << name;
    EXPECT_NE(html.find("<b>broken</b>: broken.binary: "), html.npos);
    EXPECT_NE(contents(*folder / "whole" / "materials.csv").find("broken,,,broken.binary"), html.npos);

    const ProgramRun none = run(*folder, {"report", "broken.binary", "missing.binary", "-o", "none", "--least"});
    EXPECT_EQ(none.status, 1);
    EXPECT_NE(none.err.find("missing.binary"), html.npos);
    EXPECT_NE(contents(*folder / "none" / "index.html").find("<b>missing</b>"), html.npos);
}

TEST_F(Report, WrongUseIsAnError) {
    const auto expect_wrong = [&](const Arguments& arguments, const std::string& words) {
        const ProgramRun done = run(*folder, arguments);
        EXPECT_EQ(done.status, 2) << done.err;
        EXPECT_NE(done.err.find(words), done.err.npos) << done.err;
    };
    expect_wrong({"report", "matt.binary", "-o", "d", "--label", "n=stand-in"}, "--label");
    expect_wrong({"report", "", "-o", "d"}, "found an empty one");
    expect_wrong({"report", "matt.binary", "-o", "-h"}, "--output: expected a text, found the option -h");
}

TEST_F(Report, NeedsNothingButItself) {
    int links = 0;
    for (const fs::path& page : pages) {
        const std::string text = contents(page);
        for (const char* outside : {"<script ", "http:", "https:", "<link", "url(", "{{", "Not <real>", "<so on>"})
            EXPECT_EQ(text.find(outside), text.npos) << page << ": " << outside;
        // What is shown and linked to is there.
        const std::regex link("(?:href|src)=['\"]([^'\"]*)['\"]");
        for (std::sregex_iterator at(text.begin(), text.end(), link), end; at != end; ++at, ++links)
            EXPECT_TRUE(fs::exists(page.parent_path() / std::string((*at)[1]))) << page << ": " << (*at)[1];
    }
    EXPECT_GT(links, 60);
}

TEST_F(Report, GivesTheDefaultFitToOtherPrograms) {
    for (const char* name : {"matt", "krylon_blue"}) {
        const fs::path at = page_of(name).parent_path();
        const std::string page = contents(at / "index.html");
        for (const char* ending : {".glsl", ".hlsl", ".wgsl", ".metal", ".h", ".js"}) {
            EXPECT_NE(page.find(fmt::format("href='{}{}' download", name, ending)), page.npos) << ending;
            EXPECT_NE(contents(at / (std::string(name) + ending)).find(name), page.npos) << ending;
        }
        // They are what `srbf export` makes of the model.
        const std::string model = (at / "pm-source-2x2-raw.srbf").string(), code = std::string(name) + ".glsl";
        fs::copy(model, *folder / (std::string(name) + ".srbf"));
        EXPECT_EQ(
            run(*folder, {"export", std::string(name) + ".srbf", "--to", "glsl", "--with", "sampling", "-o", code})
                .status,
            0);
        EXPECT_EQ(contents(*folder / code), contents(at / code));
        EXPECT_NE(contents(at / "page.html").find("<canvas"), page.npos);
    }
}

TEST_F(Report, IsShownByABrowser) {
    const std::string script = (fs::path(SRBF_SOURCE_DIR) / "extras/report/test/report_page.py").string();
    std::string files;
    for (const fs::path& page : pages) files += fmt::format(" '{}'", page.string());
    const int status =
        std::system(fmt::format("PYTHONDONTWRITEBYTECODE=1 PYTHONPATH='{}/test' python3 '{}'{} > '{}' 2>&1",
                                SRBF_SOURCE_DIR, script, files, (*folder / "said").string())
                        .c_str());
    const std::string said = contents(*folder / "said");
    if (WIFEXITED(status) && (WEXITSTATUS(status) == 77 || WEXITSTATUS(status) == 127)) GTEST_SKIP() << said;
    ASSERT_EQ(status, 0) << said;
    const auto answers = nlohmann::json::parse(said);
    EXPECT_EQ(answers["problems"], nlohmann::json::array());
    for (const std::string request : answers["requests"])
        EXPECT_TRUE(request.starts_with("file:") || request.starts_with("data:")) << request;
    for (const int pixels : answers["too_wide"]) EXPECT_LE(pixels, 0);
    EXPECT_EQ(answers["images"], nlohmann::json({2 * 3, 0, 2 * 7, 2 * 7}));
    EXPECT_EQ(answers["blank"], 0);
    EXPECT_EQ(answers["plots"], nlohmann::json({0, 0, 2 + 6, 2 + 6}));
    // A click puts the materials into another order.
    EXPECT_EQ(answers["by_name"], nlohmann::json({"krylon_blue", "matt"}));
    auto by_error = answers["by_error"];
    EXPECT_TRUE(std::ranges::is_sorted(by_error.get<std::vector<double>>())) << by_error;
}

/// All fields of all tables of a report.
std::set<std::string> fields_of(const fs::path& report) {
    std::set<std::string> all;
    for (const auto& entry : fs::directory_iterator(report)) {
        if (entry.path().extension() != ".csv") continue;
        const std::string text = contents(entry.path());
        std::vector<std::string_view> fields;
        Lines lines(text);
        std::size_t columns = 0;
        while (const auto line = lines.next()) {
            split_fields(*line, fields);
            if (columns == 0) columns = fields.size();
            EXPECT_EQ(fields.size(), columns) << entry.path() << ": " << *line;
            for (const std::string_view field : fields) all.emplace(field);
        }
        EXPECT_GT(columns, 0u) << entry.path();
    }
    return all;
}

TEST_F(Report, EveryNumberIsInTheTables) {
    const std::set<std::string> fields = fields_of(folder->path / "whole");
    std::string all;
    for (const fs::path& page : pages) all += contents(page);
    // Each number carries the field that it was rounded from.
    const std::regex number("<data value='([^']*)'>([^<]*)</data>");
    int numbers = 0;
    for (std::sregex_iterator at(all.begin(), all.end(), number), end; at != end; ++at, ++numbers) {
        const std::string exact = (*at)[1];
        std::string shown = (*at)[2];
        EXPECT_TRUE(fields.contains(exact)) << exact;
        const bool is_percent = shown.ends_with('%');
        std::erase_if(shown, [](char c) { return c == ',' || c == ' ' || c == '%' || c == 's'; });
        const auto value = to_number<double>(shown), field = to_number<double>(exact);
        ASSERT_TRUE(value && field) << (*at)[0];
        EXPECT_PRED3(near, *value, (is_percent ? 100 : 1) * *field, 0.006 * std::abs(*value) + 0.005) << (*at)[0];
    }
    EXPECT_GT(numbers, 300);
    // So does each point of a plot.
    const std::regex point("<circle[^>]*><title>[^:<]*: ([^<]*)</title>");
    int points = 0;
    for (std::sregex_iterator at(all.begin(), all.end(), point), end; at != end; ++at, ++points)
        EXPECT_TRUE(fields.contains((*at)[1])) << (*at)[1];
    EXPECT_GE(points, 3);
    // Nor is there a digit in a table, caption or card but in these, and in names.
    const std::string rest =
        std::regex_replace(all, std::regex("<data [^>]*>[^<]*</data>|<img[^>]*>|<a [^>]*>[^<]*</a>"), "");
    const std::regex place("<(td|figcaption|article|p class='lead')[^>]*>([^]*?)</(td|figcaption|article|p)>");
    for (std::sregex_iterator at(rest.begin(), rest.end(), place), end; at != end; ++at) {
        const std::string text = std::regex_replace(std::string((*at)[2]), std::regex("<[^>]*>"), "");
        EXPECT_EQ(text.find_first_of("0123456789"), text.npos) << text;
    }
}

/// The folders of finished materials.
std::set<fs::path> finished(const fs::path& report) {
    std::set<fs::path> all;
    std::error_code none_yet;
    for (const auto& entry : fs::directory_iterator(report, none_yet))
        if (entry.is_directory() && !entry.path().filename().string().starts_with('.')) all.insert(entry.path());
    return all;
}

TEST_F(Report, SaysWhereNoFramesCanBeTimed) {
    const TemporaryFolder blind;
    fs::copy(*folder / "matt.binary", blind / "matt.binary");
    for (const fs::path& done : finished(folder->path / "whole"))
        if (done.filename().string().starts_with("matt-")) {
            fs::create_directory(blind / "a");
            fs::copy(done, blind.path / "a" / done.filename(), fs::copy_options::recursive);
            fs::remove(blind.path / "a" / done.filename() / "frames.json");
        }
    ::setenv("__EGL_VENDOR_LIBRARY_FILENAMES", "/dev/null", 1);  // no library that draws
    const ProgramRun done = run(blind, {"report", "matt.binary", "-o", "a", "--least"});
    ::unsetenv("__EGL_VENDOR_LIBRARY_FILENAMES");
    EXPECT_EQ(done.status, 0) << done.err;
    const std::string page = contents(*finished(blind / "a").begin() / "index.html");
    EXPECT_NE(page.find("No frames were timed: "), page.npos);
    EXPECT_NE(page.find("Sizes, errors, seconds"), page.npos);
}

TEST_F(Report, NamesTheSourcesRowsBesideItsOwnMaterials) {
    const std::string krylon = contents(page_of("krylon_blue"));
    EXPECT_NE(krylon.find("Tsai 2009, multivariate"), krylon.npos);
    EXPECT_NE(krylon.find("<data value='0.0102'>1.02 %</data>"), krylon.npos);
    EXPECT_EQ(contents(page_of("matt")).find("Tsai 2009, "), krylon.npos);
    // A file with the name of a material of Tsai 2009 is taken for that material, unless it is labelled. Its bytes are
    // those of a material that is complete.
    const TemporaryFolder metal;
    fs::copy(*folder / "matt.binary", metal / "nickel.binary");
    for (const fs::path& done : finished(folder->path / "whole"))
        if (const std::string name = done.filename().string(); name.starts_with("matt-"))
            fs::create_directory(metal / "a"),
                fs::copy(done, metal.path / "a" / ("nickel-" + name.substr(5)), fs::copy_options::recursive);
    const Arguments again{"report", "nickel.binary", "-o", "a", "--least"};
    EXPECT_EQ(run(metal, again).status, 0);
    const auto page = [&] { return contents(*finished(metal / "a").begin() / "index.html"); };
    EXPECT_NE(page().find("<data value='0.0044'>0.44 %</data>"), html.npos);
    Arguments labelled = again;
    labelled.insert(labelled.begin() + 1, {"--label", "nickel=stand-in"});
    EXPECT_EQ(run(metal, labelled).status, 0);
    EXPECT_EQ(page().find("Tsai 2009, "), html.npos);
}

TEST_F(Report, GoesOnWhereItWasKilled) {
    const pid_t process = start(*folder, arguments("killed"), *folder / "out", *folder / "err");
    ASSERT_GT(process, 0);
    const fs::path report = folder->path / "killed";
    int status = 0;
    while (finished(report).empty() && ::waitpid(process, &status, WNOHANG) == 0)
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    ::kill(process, SIGKILL);
    ASSERT_EQ(::waitpid(process, &status, 0), process);
    ASSERT_TRUE(WIFSIGNALED(status)) << "it was done before it was killed";
    const auto kept = finished(report);
    ASSERT_GE(kept.size(), 1u);
    ASSERT_LT(kept.size(), 2u);
    EXPECT_FALSE(fs::exists(report / "index.html"));
    const Files before = files_of(*kept.begin());

    // Running the others in parallel does not change the results either.
    Arguments side_by_side = arguments("killed");
    side_by_side.insert(side_by_side.end(), {"--jobs", "2"});
    EXPECT_EQ(run(*folder, side_by_side).status, first.status);
    // Complete materials were not repeated, including their times.
    Files after = files_of(*kept.begin());
    for (const auto& [file, content] : before) EXPECT_TRUE(after[file] == content) << file;
    // Except for times, everything is as without the interruption.
    const Files whole = files_of(folder->path / "whole");
    Files resumed = files_of(report);
    EXPECT_EQ(resumed.size(), whole.size());
    for (const auto& [file, content] : whole) EXPECT_TRUE(is_of_clocks(file) || resumed[file] == content) << file;
    // And with the same times the page and the tables are the same bytes.
    for (const auto& [file, content] : whole)
        if (is_measured_time(file)) write(report / file, content);
    EXPECT_EQ(run(*folder, arguments("killed")).status, first.status);
    resumed = files_of(report);
    for (const auto& [file, content] : whole) EXPECT_TRUE(resumed[file] == content) << file;
}

/// The folder of the study that a run begins in `o`, upon which it is killed; empty if the run keeps what is there.
std::string begun(const TemporaryFolder& folder, const Arguments& arguments) {
    const pid_t process = start(folder, arguments, folder / "out", folder / "err");
    int status = 0;
    for (bool has_ended = false; !has_ended; std::this_thread::sleep_for(std::chrono::milliseconds(2))) {
        has_ended = ::waitpid(process, &status, WNOHANG) == process;
        for (const auto& entry : fs::directory_iterator(folder / "o")) {
            const std::string name = entry.path().filename().string();
            if (!name.starts_with('.') || !entry.is_directory()) continue;
            if (!has_ended) ::kill(process, SIGKILL), ::waitpid(process, &status, 0);
            fs::remove_all(entry.path());
            return name.substr(1);
        }
    }
    EXPECT_EQ(status, 0) << contents(folder / "err");
    return {};
}

/// Between a run that was killed before its pages and the next one each option and each input changes.
TEST_F(Report, KeepsStudiesOfTheSameInputAndOptionsAlone) {
    const TemporaryFolder other;
    fs::copy(*folder / "matt.binary", other / "matt.binary");
    const fs::path study = page_of("matt").parent_path(), kept = other.path / "o" / study.filename();
    fs::create_directory(other / "o");
    fs::copy(study, kept, fs::copy_options::recursive);
    fs::remove(kept / "index.html");
    write(other / "m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 2\nf 1 2 3\nf 1 2 4\n# a\n");
    const Arguments base{"report", "matt.binary", "-o", "o", "--least"};
    EXPECT_EQ(begun(other, base), "");
    const Files expected = files_of(other / "o");

    const auto key_of = [](const std::string& name) { return name.substr(name.rfind('-') + 1); };
    std::set<std::string> keys{key_of(study.filename().string())};
    const auto expect_anew = [&](const Arguments& arguments) {
        const std::string name = begun(other, arguments);
        EXPECT_TRUE(!name.empty() && keys.insert(key_of(name)).second) << fmt::format("{}", fmt::join(arguments, " "));
    };
    const std::map<std::string, std::string> argument{{"--quick", ""},       {"--mesh", "m.obj"}, {"--up", "z"},
                                                      {"--label", "matt=x"}, {"--note", "x"},     {"--threads", "1"},
                                                      {"--jobs", "1"}};
    const std::set<std::string> changes_no_study{"--label", "--note", "--threads", "--jobs"};
    const auto options = long_options(other);
    for (const std::string& option : options.at("report")) {
        if (option == "--output") continue;
        ASSERT_TRUE(argument.contains(option)) << option << " is to be tried";
        const Arguments with = base + Arguments{option} + words(argument.at(option));
        if (!changes_no_study.contains(option)) {
            expect_anew(with);
            continue;
        }
        EXPECT_EQ(begun(other, with), "") << option;
        EXPECT_EQ(begun(other, base), "");
        EXPECT_TRUE(files_of(other / "o") == expected) << option << " is left in what a run without it writes";
    }
    expect_anew({"report", "matt.binary", "-o", "o"});
    fs::copy(other / "matt.binary", other / "nickel.binary");
    expect_anew({"report", "nickel.binary", "-o", "o", "--least"});
    for (const char* file : {"m.obj", "matt.binary"}) {
        std::string content = contents(other / file);
        content[content.size() - 2] = char(content[content.size() - 2] ^ 1);
        write(other / file, content);
        expect_anew(base + Arguments{"--mesh", "m.obj"});
    }
}

TEST_F(Report, RefusesWhatItCannotUse) {
    const auto refused = [&](Arguments more, int status, const char* named) {
        more.insert(more.begin(), "report");
        const ProgramRun run = srbf::run(*folder, more);
        EXPECT_EQ(run.status, status) << run.err;
        EXPECT_NE(run.err.find(named), run.err.npos) << run.err;
    };
    refused({"matt.binary"}, 2, "--output");
    refused({"-o", "x"}, 2, "FILE");
    refused({"matt.binary", "-o", "matt.binary"}, 1, "matt.binary");
    refused({"matt.binary", "-o", "x", "--mesh", "missing.ply"}, 1, "missing.ply");
    const std::string stack = (fs::path(SRBF_SOURCE_DIR) / "fuzz" / "corpus" / "stack" / "small").string();
    refused({stack + "#0", "-o", "of_a_model"}, 1, "expected a measurement, found a fitted model");
    refused({stack + "#9", "-o", "of_a_model"}, 1, "texel: expected 0 to 1, found 9");
    refused({"missing.binary", "-o", "of_a_model"}, 1, "missing.binary: cannot be read");
    refused({"matt.binary", "-o", "x", "--label", "no sign of equality"}, 2, "NAME=TEXT");
    EXPECT_FALSE(fs::exists(folder->path / "x" / "index.html"));
}

}  // namespace
}  // namespace srbf::report_test
