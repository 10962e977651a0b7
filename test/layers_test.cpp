// Include dependencies: the sources of a folder include public headers, their own folder and folders of lower levels.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <regex>
#include <string>
#include <vector>

#include "properties.h"
#include "temporary_folder.h"

namespace srbf::layers_test {
namespace {

namespace fs = std::filesystem;
const fs::path k_root = SRBF_SOURCE_DIR;

// Folders in increasing level. A folder may include its own files and files of lower levels, and no other folder of its
// level.
const std::vector<std::vector<std::string>> k_levels{
    {"src/base"},
    {"src/brdf"},
    {"src/errors", "src/measured", "src/sampling", "src/models/kind"},
    {"src/measured/formats", "src/observe", "src/models/bsdf", "src/models/pm"},
    {"src/models/*", "src/models/pm/solve"},
    {"src/models/pm/search", "src/models/su"},
    {"src/samples"},
    {"src/models"},
    {"src/prepared", "src/fit", "src/edit", "src/api"},
    {"src/code", "src/code/runtime", "extras/maps", "extras/environment"},
    {"extras/daylight/code", "extras/environment/code", "app"},
    {"extras/render", "extras/maps/app"},
    {"extras/render/app"},
    {"extras/report", "extras/environment/app", "extras/optics", "extras/daylight", "extras/blender"},
    {"extras/blender/app"},
};

/// The level of a file's folder, or of "*" beside it; −1 if it has none.
int level_of(const fs::path& path) {
    for (const fs::path& folder : {path.parent_path(), path.parent_path().parent_path() / "*"})
        for (std::size_t level = 0; level < k_levels.size(); ++level)
            if (std::ranges::count(k_levels[level], folder.string()) > 0) return int(level);
    return -1;
}
bool has_part(const fs::path& path, const char* part) { return path.string().find(part) != std::string::npos; }
/// An extra has public headers, too, for its own files and for programs.
bool is_public(const fs::path& path) { return has_part(path, "include/srbf/"); }
/// "extras/NAME" for a file of an extra; empty for one of the core.
fs::path extra_of(const fs::path& path) {
    return path.string().starts_with("extras/") ? *path.begin() / *std::next(path.begin()) : fs::path();
}

struct Source {
    fs::path path;                    // relative to the project's root
    std::vector<fs::path> included;   // in quotes, relative to the project's root
    std::vector<std::string> system;  // in angle brackets, as written
};
std::vector<Source> sources() {
    std::vector<Source> all;
    const std::regex include(R"(^\s*#include\s+([<"])([^>"]+)[>"])");
    std::vector<fs::path> roots{"include", "src", "."};
    for (const auto& extra : fs::directory_iterator(k_root / "extras"))
        roots.push_back(fs::relative(extra.path() / "include", k_root));
    for (const char* folder : {"include", "src", "extras", "app"})
        for (const auto& entry : fs::recursive_directory_iterator(k_root / folder)) {
            if (!entry.is_regular_file() || has_part(entry.path(), "/test/") || has_part(entry.path(), "/corpus/"))
                continue;
            Source source{fs::relative(entry.path(), k_root), {}, {}};
            std::ifstream in(entry.path());
            std::smatch match;
            for (std::string line; std::getline(in, line);) {
                if (!std::regex_search(line, match, include)) continue;
                const std::string name = match[2];
                if (match[1] == "<") {
                    source.system.push_back(name);
                    continue;
                }
                for (const fs::path& root : roots)
                    if (fs::exists(k_root / root / name)) source.included.push_back((root / name).lexically_normal());
            }
            all.push_back(std::move(source));
        }
    return all;
}

TEST(Layers, EveryFolderHasALevel) {
    const auto all = sources();
    ASSERT_GT(all.size(), 30u);
    for (const Source& source : all) EXPECT_TRUE(is_public(source.path) || level_of(source.path) >= 0) << source.path;
}

TEST(Layers, OnlyLowerFoldersAreIncluded) {
    for (const Source& source : sources())
        for (const fs::path& included : source.included) {
            EXPECT_TRUE(is_public(included) || !is_public(source.path)) << source.path << " includes " << included;
            if (is_public(included) || included.parent_path() == source.path.parent_path()) continue;
            EXPECT_LT(level_of(included), level_of(source.path)) << source.path << " includes " << included;
        }
}

/// An extra is named by itself, and by extras whose CMakeLists.txt says that they need it.
TEST(Layers, NoExtraIsNamedElsewhere) {
    for (const Source& source : sources())
        for (const fs::path& included : source.included) {
            const fs::path extra = extra_of(included);
            const fs::path user = extra_of(source.path);
            if (extra.empty() || extra == user) continue;
            const std::string needs = read_text(k_root / user / "CMakeLists.txt");
            EXPECT_TRUE(!user.empty() && needs.find(extra.filename().string()) != needs.npos)
                << source.path << " includes " << included;
        }
}

/// A header declares ahead no type that a higher folder defines.
TEST(Layers, TypesDeclaredAheadAreOfLowerFolders) {
    const std::regex declared("\n(?:struct|class) ([A-Za-z]+);"), defined("\n(?:struct|class) ([A-Za-z]+) [^;\n]*\\{");
    std::map<std::string, int> level_of_type;
    std::map<fs::path, std::string> texts;
    const auto names_in = [](const std::string& text, const std::regex& pattern) {
        std::vector<std::string> names;
        for (std::sregex_iterator match(text.begin(), text.end(), pattern), end; match != end; ++match)
            names.push_back((*match)[1]);
        return names;
    };
    for (const Source& source : sources()) {
        if (is_public(source.path)) continue;
        texts[source.path] = read_text(k_root / source.path);
        for (const std::string& name : names_in(texts[source.path], defined))
            level_of_type[name] = level_of(source.path);
    }
    for (const auto& [path, text] : texts)
        for (const std::string& name : names_in(text, declared))
            EXPECT_TRUE(!level_of_type.contains(name) || level_of_type[name] <= level_of(path)) << path << ": " << name;
}

TEST(Layers, NoFilesIncludeEachOther) {
    std::map<fs::path, std::vector<fs::path>> included;
    for (Source& source : sources()) included[source.path] = std::move(source.included);
    std::map<fs::path, bool> is_done;  // false: on the path that is followed
    const std::function<void(const fs::path&)> follow = [&](const fs::path& from) {
        is_done[from] = false;
        for (const fs::path& to : included[from])
            if (const auto known = is_done.find(to); known == is_done.end())
                follow(to);
            else
                EXPECT_TRUE(known->second) << from << " includes " << to << ", which includes it";
        is_done[from] = true;
    };
    for (const auto& [path, includes] : std::map(included))
        if (!is_done.contains(path)) follow(path);
}

TEST(Layers, MeasurementsAndModelsDoNotSeeEachOther) {
    for (const Source& source : sources()) {
        if (source.path.string().starts_with("app/")) continue;
        for (const fs::path& included : source.included) {
            EXPECT_FALSE(has_part(source.path, "measured") && has_part(included, "model")) << source.path;
            EXPECT_FALSE(has_part(source.path, "model") && has_part(included, "measured")) << source.path;
        }
    }
}

TEST(Layers, RenderersKnowNoFit) {
    for (const Source& source : sources())
        for (const fs::path& included : source.included)
            EXPECT_FALSE(has_part(source.path, "render/") && has_part(included, "fit")) << source.path;
}

TEST(Layers, PublicHeadersNeedTheStandardLibraryAlone) {
    for (const Source& source : sources())
        for (const std::string& name : source.system)
            EXPECT_FALSE(is_public(source.path) && name.find_first_of("/.") != std::string::npos)
                << source.path << " includes " << name;
}

// A shared library offers no other names than these headers declare, and all names have the version.
TEST(Layers, NamesHaveTheVersion) {
    for (const Source& source : sources()) {
        const bool is_header = is_public(source.path) && source.path.extension() == ".h";
        if (!is_header && source.path.string().starts_with("app/")) continue;
        const std::string text = read_text(k_root / source.path);
        EXPECT_LACKS(text, "\nnamespace srbf") << source.path;
        EXPECT_TRUE(!is_header || text.find("\nSRBF_BEGIN\n") != text.npos || source.path.stem() == "version")
            << source.path;
    }
}

}  // namespace
}  // namespace srbf::layers_test
