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

// Groups of files in increasing level, by prefixes of their paths; a file may include its own group and those before
// it.
const std::vector<std::vector<std::string>> k_groups{
    {"include/srbf/elementary", "src/elementary", "include/srbf/vec", "include/srbf/half", "src/half",
     "include/srbf/colour", "src/colour", "include/srbf/printable", "src/printable", "include/srbf/result",
     "src/result", "include/srbf/picture.h", "include/srbf/progress", "src/progress", "src/reporter"},
    {"src/aligned", "src/floating_point", "src/parallel", "src/r_sequence", "src/k_d_tree", "src/elevation_nodes",
     "src/weighted_quantile", "src/errors", "src/least_squares", "src/step_bounds", "src/levenberg_marquardt",
     "include/srbf/file", "src/file", "src/npy", "include/srbf/npy", "include/srbf/text"},
    {"include/srbf/kernel", "src/batch-inl", "src/fused"},
    {"include/srbf/directions", "src/directions"},
    {"include/srbf/brdf", "include/srbf/bsdf", "src/values"},
    {"include/srbf/likeness", "src/pictures/likeness", "src/pictures/itp"},
    {"include/srbf/pictures", "src/pictures/"},
    {"include/srbf/metrics", "src/metrics"},
    {"include/srbf/measured", "include/srbf/convert", "src/measured/"},
    {"include/srbf/peak", "src/peak"},
    {"include/srbf/su", "include/srbf/ggx", "include/srbf/pbr"},
    {"include/srbf/model", "include/srbf/exponent_terms", "include/srbf/library", "src/model/"},
    {"include/srbf/sampling", "src/sampling"},
    {"include/srbf/prepared", "src/prepared", "include/srbf/load", "src/load", "include/srbf/extended_light",
     "src/extended_light"},
    {"include/srbf/shader", "include/srbf/shading_code", "src/shader/"},
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
    {"include/srbf/fit", "include/srbf/fit_samples", "include/srbf/choose", "include/srbf/basis"},
    {"src/fit/solve/block", "src/fit/solve/columns"},
    {"src/fit/fits", "src/fit/data/", "src/fit/objective/"},
    {"src/fit/solve/rows"},
    {"src/fit/model/"},
    {"src/fit/solve/"},
    {"src/fit/options", "src/fit/search/random_lobes"},
    {"src/fit/views/"},
    {"src/fit/search/"},
    {"src/microfacets/"},
    {"src/samples/"},
    {"src/fitting/"},
    {"src/basis/"},
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
    for (const char* folder : {"include", "src", "render", "app"})
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
