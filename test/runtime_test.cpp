// srbf_runtime.h, compiled as C: its values are the library's, its densities describe its samples, and no file is
// unsafe.
#include <filesystem>
#include <map>
#include <random>

#include "compiled_code.h"
#include "models.h"
#include "properties.h"
#include "srbf/file.h"
#include "srbf/load.h"
#include "srbf/prepared_bsdf.h"
#include "srbf/shading_code.h"
#include "statistics.h"

namespace srbf::runtime_test {
namespace {

namespace fs = std::filesystem;

struct Opened;  // srbf_brdf
struct Light {
    Vec3f wl;
    Rgb weight;
    float pdf;
    int is_beam;
};

/// The functions of the header, as a library has them.
struct Runtime {
    std::size_t (*memory_needed)(const void*, std::size_t);
    int (*open)(const void*, std::size_t, void*, std::size_t, Opened**, std::size_t*);
    void (*prepare)(Opened*);
    void (*value)(const Opened*, const float*, const float*, float*);
    void (*values)(const Opened*, std::size_t, const float*, const float*, float*);
    void (*sample)(const Opened*, const float*, const float*, Light*);
    float (*pdf)(const Opened*, const float*, const float*);
    float (*value_pdf)(const Opened*, const float*, const float*, float*);
    void (*albedo)(const Opened*, float, float*);
};

Rgb value(const Runtime& runtime, const Opened* brdf, Vec3f wl, Vec3f wv) {
    Rgb f;
    runtime.value(brdf, &wl.x, &wv.x, &f.r);
    return f;
}
float pdf(const Runtime& runtime, const Opened* brdf, Vec3f wl, Vec3f wv) { return runtime.pdf(brdf, &wl.x, &wv.x); }

/// Names begin with this for a linker: they have the version, here of SRBF_VERSION.
const std::string k_prefix =
    fmt::format("srbf_v{}_{}", std::atoi(SRBF_VERSION), std::atoi(std::strchr(SRBF_VERSION, '.') + 1));

const std::string k_implementation = "#define SRBF_RUNTIME_IMPLEMENTATION\n#include \"srbf_runtime.h\"\n";

/// A model file of each kind, and a fit.
std::vector<fs::path> model_files() {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(fs::path(SRBF_SOURCE_DIR) / "test" / "models" / "1"))
        if (entry.path().extension() == ".srbf" && load_model(entry.path().string()).ok())
            files.push_back(entry.path());
    std::ranges::sort(files);
    return files;
}

/// A file opened by the header, beside the library's model.
struct Case {
    std::string name;
    Model model;
    std::vector<std::byte> bytes, memory;
    Opened* brdf = nullptr;
};

class RuntimeHeader : public CodeTest {
  protected:
    RuntimeHeader() { write_source("srbf_runtime.h", runtime_code()); }

    /// The header, compiled once for all tests.
    const Runtime& compiled_runtime(const std::string& options, const std::string& compiler = "gcc") {
        static std::map<std::string, Runtime> made;
        if (const auto at = made.find(compiler + options); at != made.end()) return at->second;
        void* library =
            compile_and_load(compiler + " -std=c99 -O2 " + options, compiler + options, k_implementation, "");
        ::dlopen(path(compiler + options + ".so").c_str(), RTLD_NOW | RTLD_NOLOAD);  // so that it stays after this test
        const auto named = [&](auto& member, const char* name) {
            const std::string versioned = fmt::format("{}_{}", k_prefix, name);
            member =
                function<std::remove_pointer_t<std::remove_reference_t<decltype(member)>>>(library, versioned.c_str());
        };
        Runtime& runtime = made[compiler + options];
        named(runtime.memory_needed, "memory_needed");
        named(runtime.open, "open");
        named(runtime.prepare, "prepare");
        named(runtime.value, "value");
        named(runtime.values, "values");
        named(runtime.sample, "sample");
        named(runtime.pdf, "pdf");
        named(runtime.value_pdf, "value_pdf");
        named(runtime.albedo, "albedo");
        return runtime;
    }
    static std::vector<Case> cases(const Runtime& runtime) {
        std::vector<Case> all;
        for (const fs::path& file : model_files()) {
            Case& opened = all.emplace_back(Case{file.stem().string(), *load_model(file.string()), {}, {}, nullptr});
            opened.bytes = *read_file(file.string());
            opened.memory.resize(runtime.memory_needed(opened.bytes.data(), opened.bytes.size()));
            const int error = runtime.open(opened.bytes.data(), opened.bytes.size(), opened.memory.data(),
                                           opened.memory.size(), &opened.brdf, nullptr);
            EXPECT_EQ(error, 0) << opened.name;
        }
        return all;
    }
    /// Returns the same cases, prepared for samples and albedos; they are made once.
    static const std::vector<Case>& prepared_cases(const Runtime& runtime) {
        static const std::vector<Case> all = [&] {
            std::vector<Case> made = cases(runtime);
            for (const Case& opened : made) runtime.prepare(opened.brdf);
            return made;
        }();
        return all;
    }
};

/// Random directions; every fourth one at the back.
Vec3f direction(std::mt19937_64& random, int i) { return to_float(random_direction(random, i % 4 == 3 ? -1 : 0.001)); }

TEST_F(RuntimeHeader, EqualsTheReadyFile) {
    const auto kept = checked(read_file((fs::path(SRBF_SOURCE_DIR) / "data" / "ready" / "srbf_runtime.h").string()));
    const std::string_view text(reinterpret_cast<const char*>(kept->data()), kept->size());
    EXPECT_TRUE(text == runtime_code()) << "copy srbf_runtime.h from the folder of the build";  // they are long
}

TEST_F(RuntimeHeader, ValuesAreThoseOfTheLibrary) {
    for (const char* options : {"", "-DSRBF_ONE_LANE"}) {
        const Runtime& runtime = compiled_runtime(options);
        for (const Case& opened : cases(runtime)) {
            if (!opened.brdf) continue;
            std::mt19937_64 random(1);
            for (int i = 0; i < 2000; ++i) {
                const Vec3f wl = direction(random, i), wv = i % 3 ? direction(random, i) : mirror(wl);
                const Rgb expected = value(opened.model, wl, wv), found = value(runtime, opened.brdf, wl, wv);
                ASSERT_RGB_WITHIN_RELATIVE(found, expected, 1e-4, 1e-6) << opened.name << options;
            }
        }
    }
}

// Renderers are often compiled with options that reorder sums and assume that all numbers are finite.
constexpr std::pair<const char*, const char*> k_fast[] = {
    {"gcc", "-Ofast -march=native"}, {"gcc", "-Ofast -DSRBF_ONE_LANE"}, {"clang", "-Ofast"}};

TEST_F(RuntimeHeader, IsTheSameWithFastMath) {
    const Runtime& exact = compiled_runtime("");
    for (const auto& [compiler, options] : k_fast) {
        if (!runs(fmt::format("which {}", compiler))) continue;
        const Runtime& fast = compiled_runtime(options, compiler);
        for (const Case& opened : prepared_cases(exact)) {
            std::mt19937_64 random(3);
            for (int i = 0; i < 500; ++i) {
                const Vec3f wl = direction(random, i), wv = i % 3 ? direction(random, i) : mirror(wl);
                Rgb f, found;
                const float density = exact.value_pdf(opened.brdf, &wl.x, &wv.x, &f.r),
                            found_density = fast.value_pdf(opened.brdf, &wl.x, &wv.x, &found.r);
                ASSERT_RGB_WITHIN_RELATIVE(found, f, 1e-4, 1e-6) << opened.name << compiler << options;
                ASSERT_WITHIN(found_density, density, 1e-4 * density + 1e-6) << opened.name << compiler << options;
            }
        }
    }
}

TEST_F(RuntimeHeader, IsZeroWhereADirectionIsNotAboveTheSurface) {
    for (const char* options : {"", "-Ofast -march=native"}) {
        const Runtime& runtime = compiled_runtime(options);
        constexpr float nan = std::numeric_limits<float>::quiet_NaN(),
                        infinity = std::numeric_limits<float>::infinity();
        const Vec3f up{0, 0.6f, 0.8f};
        for (const Case& opened : cases(runtime))
            for (const Vec3f w :
                 {Vec3f{1, 0, 0}, Vec3f{1, 0, 1e-40f}, Vec3f{nan, 0, 1}, Vec3f{0, 0, nan}, Vec3f{0, 0, infinity}})
                for (const auto& [wl, wv] : {std::pair(w, up), std::pair(up, w)}) {
                    EXPECT_EQ(value(runtime, opened.brdf, wl, wv), Rgb{}) << opened.name;
                    EXPECT_EQ(pdf(runtime, opened.brdf, wl, wv), 0) << opened.name;
                    Rgb f{1, 1, 1};
                    EXPECT_EQ(runtime.value_pdf(opened.brdf, &wl.x, &wv.x, &f.r), 0) << opened.name;
                    EXPECT_EQ(f, Rgb{}) << opened.name;
                }
    }
}

// True if the albedo does not depend on the azimuth or the side. Interpolated plainly, views of an isotropic model
// differ with the azimuth.
bool has_one_albedo(const Model& model) {
    const auto* su = std::get_if<SuModel>(&model.model);
    const bool is_plain = su && su->interpolation == SuInterpolation::plain;
    return is_isotropic(model) && !std::holds_alternative<BsdfModel>(model.model) && !is_plain;
}

// The density of samples is the one that is returned; weights are f |cos| / pdf.
TEST_F(RuntimeHeader, SamplesFollowTheirDensity) {
    const Runtime& runtime = compiled_runtime("");
    constexpr int draws = 4000;
    std::mt19937_64 random(2);
    const std::vector<Case>& all = prepared_cases(runtime);
    const int tests = 4 * int(all.size());
    for (const Case& opened : all) {
        for (const double z : {1.0, 0.5, 0.1, -0.4}) {
            if (z < 0 && !std::holds_alternative<BsdfModel>(opened.model.model)) continue;
            const Vec3f wv = to_float(spherical(std::acos(z), 0.3));
            PolarBins bins{to_double(mirror(wv)), {0}};
            for (const double t : {1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 0.01, 0.05, 0.15, 0.3, 0.5, 0.8, 1.2, 2.0})
                bins.edge.push_back(t);
            std::vector<double> expected =
                bins.integrals([&](Vec3d wl) { return double(pdf(runtime, opened.brdf, to_float(wl), wv)); });
            std::vector<double> observed(expected.size() + 1);
            double rest = draws, weights = 0;
            for (double& mass : expected) rest -= mass *= draws;
            expected.push_back(std::max(rest, 0.0));  // beams, and samples without a direction
            for (int i = 0; i < draws; ++i) {
                const float u[3] = {float(uniform(random)), float(uniform(random)), float(uniform(random))};
                Light light;
                runtime.sample(opened.brdf, &wv.x, u, &light);
                observed[light.pdf > 0 ? bins.index(to_double(light.wl)) : expected.size() - 1] += 1;
                if (!(light.pdf > 0)) continue;
                const float density = pdf(runtime, opened.brdf, light.wl, wv);
                ASSERT_WITHIN(light.pdf, density, 1e-3 * density) << opened.name;
                Rgb f;
                ASSERT_EQ(runtime.value_pdf(opened.brdf, &light.wl.x, &wv.x, &f.r), density) << opened.name;
                const double cosine = std::abs(double(light.wl.z));
                ASSERT_WITHIN(light.weight.g, double(f.g) * cosine / double(density),
                              2e-3 * double(light.weight.g) + 1e-6);
                weights += double(light.weight.g);
            }
            EXPECT_GT(chi2_p_value(observed, expected), sidak(0.01, tests)) << opened.name << " at " << z;
            if (!has_one_albedo(opened.model)) continue;
            Rgb albedo;
            runtime.albedo(opened.brdf, float(z), &albedo.r);
            EXPECT_WITHIN(weights / draws, albedo.g, 0.05 * double(albedo.g) + 0.002) << opened.name << " at " << z;
            EXPECT_LT(expected.back(), 0.1 * draws) << opened.name << " at " << z;
        }
    }
}

TEST_F(RuntimeHeader, AlbedosAreThoseOfTheLibrary) {
    const Runtime& runtime = compiled_runtime("");
    for (const Case& opened : prepared_cases(runtime)) {
        if (!has_one_albedo(opened.model)) continue;
        const PreparedBrdf prepared = prepare(opened.model, CosineProposal{});
        for (const float z : {1.f, 0.8f, 0.5f, 0.2f}) {
            const Rgb expected = albedo(prepared, z);
            Rgb found;
            runtime.albedo(opened.brdf, z, &found.r);
            EXPECT_RGB_WITHIN_RELATIVE(found, expected, 0.03, 0.002) << opened.name << " " << z;
        }
    }
}

TEST_F(RuntimeHeader, ReturnsTheMemoryThatItNeeds) {
    const Runtime& runtime = compiled_runtime("");
    for (const Case& opened : cases(runtime))
        for (std::size_t capacity = 0; capacity + 32 < opened.memory.size(); capacity += opened.memory.size() / 16) {
            std::vector<std::byte> memory(capacity);
            Opened* brdf = nullptr;
            EXPECT_NE(runtime.open(opened.bytes.data(), opened.bytes.size(), memory.data(), capacity, &brdf, nullptr),
                      0);
            EXPECT_EQ(brdf, nullptr);
        }
    EXPECT_EQ(runtime.memory_needed("no model", 8), 0u);
}

// Every truncation is an error that lies within the file.
TEST_F(RuntimeHeader, RefusesEveryTruncation) {
    const Runtime& runtime = compiled_runtime("");
    for (const Case& opened : cases(runtime))
        for (std::size_t size = 0; size < opened.bytes.size(); ++size) {
            std::vector<std::byte> memory(opened.memory.size());
            Opened* brdf = nullptr;
            std::size_t offset = 0;
            EXPECT_NE(runtime.open(opened.bytes.data(), size, memory.data(), memory.size(), &brdf, &offset), 0);
            EXPECT_LE(offset, size);
        }
}

TEST_F(RuntimeHeader, CompilesWithoutWarnings) {
    // Some warnings of GCC come with its optimisation. The C library's headers of 32 bits lack one file.
    fs::create_directory(path("gnu"));
    write_source("gnu/stubs-32.h", "");
    const std::string x87 = "gcc -m32 -std=c99 -O1 -idirafter /usr/include/x86_64-linux-gnu -I" + path("");
    for (const std::string& command :
         {std::string("gcc -std=c99 -Os"), std::string("gcc -std=c99 -O1 -DSRBF_ONE_LANE"), x87, x87 + " -msse2",
          std::string("gcc -std=c99 -O1 -DSRBF_RUNTIME_STATIC"), std::string("clang -std=c99 -fsyntax-only"),
          std::string("g++ -x c++ -std=c++11 -fsyntax-only"), std::string("clang++ -x c++ -std=c++11 -fsyntax-only")}) {
        if (!runs(command.substr(0, command.find(" -std")) + " -E -x c /dev/null")) continue;
        EXPECT_TRUE(runs(fmt::format("{} -Wall -Wextra -Wconversion -pedantic -Werror -c '{}' -o '{}'", command,
                                     write_source("warned.c", k_implementation), path("warned.o"))));
    }
}

// Two plugins with two versions of the header do not call each other's functions.
TEST_F(RuntimeHeader, NamesContainTheVersion) {
    for (const std::string options : {"", "-DSRBF_RUNTIME_STATIC"}) {
        compile_and_load("gcc -std=c99 " + options, "names" + options, k_implementation);
        const std::string names = fmt::format("nm -D --defined-only '{}'", path("names" + options + ".so"));
        EXPECT_TRUE(runs(fmt::format("! {} | grep -v ' {}_'", names, k_prefix)));
        EXPECT_EQ(bool(runs(names + " | grep srbf_")), options.empty());
    }
}

// examples/path_tracer.c, with a pixel of the sky, one of the sphere and one of the floor.
TEST_F(RuntimeHeader, TracesPaths) {
    const std::string source = std::string(SRBF_SOURCE_DIR) + "/examples/path_tracer.c",
                      model = std::string(SRBF_SOURCE_DIR) + "/test/models/1/openpbr.srbf";
    ASSERT_TRUE(runs(fmt::format("gcc -std=c99 -O2 -I'{}' '{}' -o '{}' -lm", path(""), source, path("tracer"))));
    ASSERT_TRUE(runs(fmt::format("'{}' '{}' '{}' 4", path("tracer"), model, path("picture.ppm"))));
    const std::vector<std::byte> picture = *read_file(path("picture.ppm"));
    constexpr std::size_t width = 320, height = 240, bytes = 3 * width * height;
    ASSERT_GT(picture.size(), bytes);
    const auto mean = [&](std::size_t x, std::size_t y) {  // of red in a square
        double sum = 0;
        for (std::size_t i = 0; i < 256; ++i)
            sum += double(picture[picture.size() - bytes + 3 * ((y + i / 16) * width + x + i % 16)]) / 256;
        return sum;
    };
    EXPECT_WITHIN(mean(10, 10), mean(290, 10), 2);  // the sky
    EXPECT_GT(std::abs(mean(10, 10) - mean(150, 100)), 5);
    EXPECT_GT(mean(10, 220), 10);
}

// Files with changed bytes, in a program with sanitizers: no error of memory, no hang, and what opens has finite
// values.
TEST_F(RuntimeHeader, SurvivesMutants) {
    std::string files;
    for (const fs::path& file : model_files()) files += fmt::format(" '{}'", file.string());
    ASSERT_TRUE(runs(fmt::format(
        "gcc -std=c99 -g -O1 -fsanitize=address,undefined -fno-sanitize-recover=all -I'{}' '{}' -o '{}' -lm", path(""),
        std::string(SRBF_SOURCE_DIR) + "/test/runtime_mutants.c", path("mutants"))));
    EXPECT_TRUE(runs(fmt::format("'{}' 40{}", path("mutants"), files)));
}

}  // namespace
}  // namespace srbf::runtime_test
