// Include dependencies: a file includes only files of lower levels, or of its own name.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <string>
#include <vector>

namespace srbf::layers_test {
namespace {

namespace fs = std::filesystem;
const fs::path k_root = SRBF_SOURCE_DIR;

// Folders and public headers in increasing level, by prefixes of their paths; a file may include its own level and those before
// it.
const std::vector<std::vector<std::string>> k_groups{
    {"include/srbf/kernel", "src/base/", "include/srbf/elementary", "include/srbf/vec", "include/srbf/half",
     "include/srbf/printable", "include/srbf/result", "include/srbf/progress", "include/srbf/file", "include/srbf/npy",
     "include/srbf/text"},
    {"src/brdf/", "include/srbf/colour", "include/srbf/directions", "include/srbf/brdf", "include/srbf/bsdf"},
    {"src/errors/", "include/srbf/picture", "include/srbf/likeness", "include/srbf/metrics"},
    {"src/measured/", "include/srbf/measured", "include/srbf/convert", "include/srbf/peak"},
    {"src/observe/", "src/models/", "include/srbf/su", "include/srbf/ggx", "include/srbf/pbr", "include/srbf/model",
     "include/srbf/exponent_terms", "include/srbf/library", "include/srbf/fit.h", "include/srbf/fit_samples"},
    {"src/sampling/", "include/srbf/sampling"},
    {"src/prepared/", "include/srbf/prepared", "include/srbf/load"},
    {"extras/environment/", "include/srbf/extended_light"},
    {"src/code/", "include/srbf/shader", "include/srbf/shading_code"},
    {"render/shading"},
    {"render/image", "render/tone", "render/mesh", "render/exr", "render/environment", "render/filtered_environment",
     "render/map_layers", "render/studio"},
    {"render/scene", "render/rays"},
    {"render/path", "render/room"},
    {"render/preview"},
    {"render/pixel", "render/surface", "render/whole", "render/develop"},
    {"render/offscreen", "render/gl_object"},
    {"render/raster"},
    {"render/frames"},
    {"render/html", "render/drawing"},
    {"render/slices", "render/chart", "render/material"},
    {"render/page"},
    {"src/fit/", "include/srbf/fit", "include/srbf/choose"},
    {"extras/maps/", "include/srbf/basis"},
    {"app/"},
};

/// The first group that matches; −1: none.
int place_of(const fs::path& path) {
    for (std::size_t place = 0; place < k_groups.size(); ++place)
        for (const std::string& beginning : k_groups[place])
            if (path.string().starts_with(beginning)) return int(place);
    return -1;
}

struct Source {
    fs::path path;                    // relative to the project's root
    std::vector<fs::path> included;   // in quotes, relative to the project's root
    std::vector<std::string> system;  // in angle brackets, as written
};
std::vector<Source> sources() {
    std::vector<Source> all;
    const std::regex include(R"(^\s*#include\s+([<"])([^>"]+)[>"])");
    for (const char* folder : {"include", "src", "extras", "render", "app"})
        for (const auto& entry : fs::recursive_directory_iterator(k_root / folder)) {
            if (!entry.is_regular_file()) continue;
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
                for (const char* root : {"include", "src", "."})
                    if (fs::exists(k_root / root / name))
                        source.included.push_back((fs::path(root) / name).lexically_normal());
            }
            all.push_back(std::move(source));
        }
    return all;
}

bool is_of(const fs::path& path, const char* noun) { return path.string().find(noun) != std::string::npos; }

TEST(Layers, EveryFileHasAPlace) {
    const auto all = sources();
    ASSERT_GT(all.size(), 30u);
    for (const Source& source : all) EXPECT_GE(place_of(source.path), 0) << source.path;
}

TEST(Layers, OnlyEarlierOnesAreIncluded) {
    for (const Source& source : sources())
        for (const fs::path& included : source.included)
            EXPECT_LE(place_of(included), place_of(source.path)) << source.path << " includes " << included;
}

TEST(Layers, FoldersOfSourcesHoldNoLooseFile) {
    for (const auto& entry : fs::directory_iterator(k_root / "src")) EXPECT_TRUE(entry.is_directory()) << entry.path();
}

TEST(Layers, MeasurementsAndModelsDoNotSeeEachOther) {
    for (const Source& source : sources()) {
        if (source.path.string().starts_with("app/")) continue;
        for (const fs::path& included : source.included) {
            EXPECT_FALSE(is_of(source.path, "measured") && is_of(included, "model")) << source.path;
            EXPECT_FALSE(is_of(source.path, "model") && is_of(included, "measured")) << source.path;
        }
    }
}

TEST(Layers, RenderersKnowNoFit) {
    for (const Source& source : sources())
        for (const fs::path& included : source.included)
            EXPECT_FALSE(is_of(source.path, "render/") && is_of(included, "fit")) << source.path;
}

TEST(Layers, PublicHeadersNeedTheStandardLibraryAlone) {
    for (const Source& source : sources())
        for (const std::string& name : source.system)
            EXPECT_FALSE(is_of(source.path, "include/srbf/") && name.find_first_of("/.") != std::string::npos)
                << source.path << " includes " << name;
}

// A shared library offers no other names than these headers declare in a namespace that says so.
TEST(Layers, PublicHeadersAreVisible) {
    for (const auto& entry : fs::directory_iterator(k_root / "include/srbf")) {
        if (entry.path().extension() != ".h") continue;
        std::ifstream in(entry.path());
        const std::string text{std::istreambuf_iterator<char>(in), {}};
        EXPECT_NE(text.find("\nnamespace [[gnu::visibility(\"default\")]] srbf {\n"), text.npos) << entry.path();
        EXPECT_EQ(text.find("\nnamespace srbf {\n"), text.npos) << entry.path();
    }
}

}  // namespace
}  // namespace srbf::layers_test
