// `srbf report`: all numbers on its pages are in its tables, and completed materials are skipped.
#include <signal.h>

#include <chrono>
#include <regex>
#include <thread>

#include "base/text.h"
#include "command.h"
#include "script.h"

namespace srbf::report_test {
namespace {

namespace fs = std::filesystem;
using Files = std::map<fs::path, std::string>;

/// Writes two small materials, whose names have no digits, and a file that is not a measurement.
void write_materials(const TemporaryFolder& folder) {
    for (const double gloss : {1.0, 9.0})
        write_text(folder / (gloss == 1 ? "nickel.binary" : "krylon_blue.binary"),
                   as_text(merl_file({9, 6, 8}, [&](int h, int d, int, int c) {
                       return 0.1 + gloss * std::exp(-h * gloss) * (1 + c) + 0.01 * d;
                   })));
    write_text(folder / "broken.binary", "no measurement");
}

/// All files of a report, by their relative path.
Files files_of(const fs::path& report) {
    Files files;
    for (const auto& entry : fs::recursive_directory_iterator(report))
        if (entry.is_regular_file()) files[fs::relative(entry.path(), report)] = read_text(entry.path());
    return files;
}
/// Results that depend on time, in the folder of a material.
bool is_measured_time(const fs::path& file) {
    return file.filename() == "times.json" || file.filename() == "frames.json";
}
/// All files that contain such results: also the pages and the tables.
bool contains_times(const fs::path& file) {
    return is_measured_time(file) || file.filename() == "index.html" || !file.has_parent_path();
}

Arguments arguments(const std::string& output) {
    return {"report", "nickel.binary", "broken.binary", "krylon_blue.binary", "-o", output, "--least"};
}

class Report : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        folder = std::make_unique<TemporaryFolder>();
        write_materials(*folder);
        first = run_srbf(*folder, arguments("whole"));
        const fs::path whole = folder->path / "whole";
        html = read_text(whole / "index.html");
        pages = {whole / "index.html", page_of("nickel"), page_of("krylon_blue")};
    }
    /// The page of the material with this name.
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
    EXPECT_ONE_LINE(first.err, "srbf: broken.binary: ");
    for (const char* name : {"nickel", "krylon_blue"}) EXPECT_CONTAINS(html, fmt::format("'>{}</a>", name));
    EXPECT_CONTAINS(html, "<b>broken</b>: broken.binary: ");
    EXPECT_CONTAINS(read_text(*folder / "whole" / "materials.csv"), "broken,,broken.binary");

    const ProgramRun none = run_srbf(*folder, {"report", "broken.binary", "missing.binary", "-o", "none", "--least"});
    EXPECT_EQ(none.status, 1);
    EXPECT_CONTAINS(none.err, "missing.binary");
    EXPECT_CONTAINS(read_text(*folder / "none" / "index.html"), "<b>missing</b>");
}

TEST_F(Report, NeedsNothingButItself) {
    int links = 0;
    for (const fs::path& page : pages) {
        const std::string text = read_text(page);
        for (const char* outside : {"<script ", "http:", "https:", "<link", "url(", "{{"})
            EXPECT_LACKS(text, outside) << page;
        // Everything that is shown or linked exists.
        const std::regex link("(?:href|src)=['\"]([^'\"]*)['\"]");
        for (std::sregex_iterator match(text.begin(), text.end(), link), end; match != end; ++match, ++links)
            EXPECT_TRUE(fs::exists(page.parent_path() / std::string((*match)[1]))) << page << ": " << (*match)[1];
    }
    EXPECT_GT(links, 40);
}

TEST_F(Report, IsShownByABrowser) {
    std::vector<std::string> files;
    for (const fs::path& page : pages) files.push_back(page.string());
    const ScriptRun run = run_script("extras/report/test/report_page.py", files);
    SKIP_IF_UNAVAILABLE(run);
    ASSERT_EQ(run.status, 0) << run.text;
    const auto answers = nlohmann::json::parse(run.text);
    EXPECT_EQ(answers["problems"], nlohmann::json::array());
    for (const std::string request : answers["requests"])
        EXPECT_TRUE(request.starts_with("file:") || request.starts_with("data:")) << request;
    for (const int pixels : answers["too_wide"]) EXPECT_LE(pixels, 0);
    EXPECT_EQ(answers["images"], nlohmann::json({2 * 3, 2 * 7, 2 * 7}));
    EXPECT_EQ(answers["blank"], 0);
    EXPECT_EQ(answers["plots"], nlohmann::json({0, 2 + 6, 2 + 6}));
    // A click changes the order of the materials.
    EXPECT_EQ(answers["by_name"], nlohmann::json({"krylon_blue", "nickel"}));
    auto by_error = answers["by_error"];
    EXPECT_TRUE(std::ranges::is_sorted(by_error.get<std::vector<double>>())) << by_error;
}

/// All fields in all tables of a report.
std::set<std::string> fields_of(const fs::path& report) {
    std::set<std::string> fields_of_report;
    for (const auto& entry : fs::directory_iterator(report)) {
        if (entry.path().extension() != ".csv") continue;
        const std::string text = read_text(entry.path());
        std::vector<std::string_view> fields;
        Lines lines(text);
        std::size_t columns = 0;
        while (const auto line = lines.next()) {
            split_fields(*line, fields);
            if (columns == 0) columns = fields.size();
            EXPECT_EQ(fields.size(), columns) << entry.path() << ": " << *line;
            for (const std::string_view field : fields) fields_of_report.emplace(field);
        }
        EXPECT_GT(columns, 0u) << entry.path();
    }
    return fields_of_report;
}

TEST_F(Report, EveryNumberIsInTheTables) {
    const std::set<std::string> fields = fields_of(folder->path / "whole");
    std::string html_of_pages;
    for (const fs::path& page : pages) html_of_pages += read_text(page);
    // Each number carries the field that it was rounded from.
    const std::regex number("<data value='([^']*)'>([^<]*)</data>");
    int numbers = 0;
    for (std::sregex_iterator match(html_of_pages.begin(), html_of_pages.end(), number), end; match != end;
         ++match, ++numbers) {
        const std::string exact = (*match)[1];
        std::string displayed = (*match)[2];
        EXPECT_TRUE(fields.contains(exact)) << exact;
        const bool is_percent = displayed.ends_with('%');
        std::erase_if(displayed, [](char c) { return c == ',' || c == ' ' || c == '%' || c == 's'; });
        const auto value = to_number<double>(displayed), field = to_number<double>(exact);
        ASSERT_TRUE(value && field) << (*match)[0];
        EXPECT_WITHIN(*value, (is_percent ? 100 : 1) * *field, 0.006 * std::abs(*value) + 0.005) << (*match)[0];
    }
    EXPECT_GT(numbers, 120);
    // The same holds for each point of a plot.
    const std::regex point("<circle[^>]*><title>[^:<]*: ([^<]*)</title>");
    int points = 0;
    for (std::sregex_iterator match(html_of_pages.begin(), html_of_pages.end(), point), end; match != end;
         ++match, ++points)
        EXPECT_TRUE(fields.contains((*match)[1])) << (*match)[1];
    EXPECT_GE(points, 3);
    // Tables, captions and cards contain no digits except in these numbers and in names.
    const std::string remaining =
        std::regex_replace(html_of_pages, std::regex("<data [^>]*>[^<]*</data>|<img[^>]*>|<a [^>]*>[^<]*</a>"), "");
    const std::regex element("<(td|figcaption|article|p class='lead')[^>]*>([^]*?)</(td|figcaption|article|p)>");
    for (std::sregex_iterator match(remaining.begin(), remaining.end(), element), end; match != end; ++match) {
        const std::string text = std::regex_replace(std::string((*match)[2]), std::regex("<[^>]*>"), "");
        EXPECT_EQ(text.find_first_of("0123456789"), text.npos) << text;
    }
}

/// The folders of completed materials.
std::set<fs::path> completed_folders(const fs::path& report) {
    std::set<fs::path> folders;
    std::error_code none_yet;
    for (const auto& entry : fs::directory_iterator(report, none_yet))
        if (entry.is_directory() && !entry.path().filename().string().starts_with('.')) folders.insert(entry.path());
    return folders;
}

TEST_F(Report, SaysIfNoFramesCanBeTimed) {
    const TemporaryFolder blind;
    fs::copy(*folder / "nickel.binary", blind / "nickel.binary");
    for (const fs::path& done : completed_folders(folder->path / "whole"))
        if (done.filename().string().starts_with("nickel-")) {
            fs::create_directory(blind / "a");
            fs::copy(done, blind.path / "a" / done.filename(), fs::copy_options::recursive);
            fs::remove(blind.path / "a" / done.filename() / "frames.json");
        }
    ::setenv("__EGL_VENDOR_LIBRARY_FILENAMES", "/dev/null", 1);  // no library that draws
    const ProgramRun done = run_srbf(blind, {"report", "nickel.binary", "-o", "a", "--least"});
    ::unsetenv("__EGL_VENDOR_LIBRARY_FILENAMES");
    EXPECT_EQ(done.status, 0) << done.err;
    const std::string page = read_text(*completed_folders(blind / "a").begin() / "index.html");
    EXPECT_CONTAINS(page, "No frames were timed: ");
    EXPECT_CONTAINS(page, "Sizes, errors, seconds");
}

TEST_F(Report, NamesTheSourcesRowsBesideItsOwnMaterials) {
    const std::string krylon = read_text(page_of("krylon_blue"));
    EXPECT_CONTAINS(krylon, "Tsai 2009, multivariate");
    EXPECT_CONTAINS(krylon, "<data value='0.0102'>1.02 %</data>");
    EXPECT_CONTAINS(read_text(page_of("nickel")), "<data value='0.0044'>0.44 %</data>");
}

TEST_F(Report, ResumesAfterItWasKilled) {
    const pid_t process = start_srbf(*folder, arguments("killed"), *folder / "out", *folder / "err");
    ASSERT_GT(process, 0);
    const fs::path report = folder->path / "killed";
    int status = 0;
    while (completed_folders(report).empty() && ::waitpid(process, &status, WNOHANG) == 0)
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    ::kill(process, SIGKILL);
    ASSERT_EQ(::waitpid(process, &status, 0), process);
    ASSERT_TRUE(WIFSIGNALED(status)) << "it was done before it was killed";
    const auto kept = completed_folders(report);
    ASSERT_GE(kept.size(), 1u);
    ASSERT_LT(kept.size(), 2u);
    EXPECT_FALSE(fs::exists(report / "index.html"));
    const Files before = files_of(*kept.begin());

    // Running the others in parallel does not change the results.
    Arguments side_by_side = arguments("killed");
    side_by_side.insert(side_by_side.end(), {"--jobs", "2"});
    EXPECT_EQ(run_srbf(*folder, side_by_side).status, first.status);
    // Completed materials were not repeated, and their times are the same.
    Files after = files_of(*kept.begin());
    for (const auto& [file, content] : before) EXPECT_TRUE(after[file] == content) << file;
    // Except for times, everything is as without the interruption.
    const Files whole = files_of(folder->path / "whole");
    Files resumed = files_of(report);
    EXPECT_EQ(resumed.size(), whole.size());
    for (const auto& [file, content] : whole) EXPECT_TRUE(contains_times(file) || resumed[file] == content) << file;
    // With the same times, pages and tables have the same bytes.
    for (const auto& [file, content] : whole)
        if (is_measured_time(file)) write_text(report / file, content);
    EXPECT_EQ(run_srbf(*folder, arguments("killed")).status, first.status);
    resumed = files_of(report);
    for (const auto& [file, content] : whole) EXPECT_TRUE(resumed[file] == content) << file;
}

/// A study is kept only if its input and the options that it depends on are the same.
TEST_F(Report, KeepsStudiesOfTheSameInputAndOptionsAlone) {
    const TemporaryFolder other;
    fs::copy(*folder / "nickel.binary", other / "nickel.binary");
    write_text(other / "m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 2\nf 1 2 3\nf 1 2 4\n# a\n");
    const Arguments base{"report", "nickel.binary", "-o", "o", "--least", "--mesh", "m.obj"};
    const auto studies_after = [&](const Arguments& more) {
        run_ok(other, base + more);
        return completed_folders(other / "o");
    };
    const auto first_studies = studies_after({});
    ASSERT_EQ(first_studies.size(), 1u);
    const Files expected = files_of(*first_studies.begin());
    EXPECT_EQ(studies_after({"--threads", "1", "--jobs", "1"}), first_studies);
    EXPECT_TRUE(files_of(*first_studies.begin()) == expected);
    EXPECT_EQ(studies_after({"--up", "z"}).size(), 2u);
    for (const char* file : {"m.obj", "nickel.binary"}) {
        std::string content = read_text(other / file);
        content[content.size() - 2] = char(content[content.size() - 2] ^ 1);
        write_text(other / file, content);
        EXPECT_EQ(studies_after({}).size(), file[0] == 'm' ? 3u : 4u);
    }
    fs::copy(other / "nickel.binary", other / "matt.binary");
    run_ok(other, {"report", "matt.binary", "-o", "o", "--least"});
    EXPECT_EQ(completed_folders(other / "o").size(), 5u);
}

TEST_F(Report, RefusesInputItCannotUse) {
    const auto refused = [&](Arguments more, int status, const char* named) {
        more.insert(more.begin(), "report");
        const ProgramRun run = run_srbf(*folder, more);
        EXPECT_EQ(run.status, status) << run.err;
        EXPECT_CONTAINS(run.err, named);
    };
    refused({"nickel.binary"}, 2, "--output");
    refused({"-o", "x"}, 2, "FILE");
    refused({"nickel.binary", "-o", "nickel.binary"}, 1, "nickel.binary");
    refused({"nickel.binary", "-o", "x", "--mesh", "missing.ply"}, 1, "missing.ply");
    const std::string map = (fs::path(SRBF_SOURCE_DIR) / "fuzz" / "corpus" / "map" / "two").string();
    refused({map + "#0", "-o", "of_a_model"}, 1, "expected a measurement, found a fitted model");
    refused({map + "#99", "-o", "of_a_model"}, 1, "texel: expected 0 to ");
    refused({"missing.binary", "-o", "of_a_model"}, 1, "missing.binary: cannot be read");
    EXPECT_FALSE(fs::exists(folder->path / "x" / "index.html"));
}

}  // namespace
}  // namespace srbf::report_test
