// Every option of every subcommand changes the output or is rejected. No option is accepted that the chosen mode does
// not read.
#include "command.h"
#include "measured/formats.h"
#include "models.h"

namespace srbf::options_test {
namespace {

const std::string k_fit = "--lobes 1 --variates 1 --objective raw --seed 3";
const std::string k_folder = "fit table.binary -o o/ --model su --directions 8 --lobes 1 --objective raw";
/// Modes of subcommands: a name, and arguments to which each option is added. The quickest mode of a subcommand comes
/// first. Modes that would be slow have a missing input, so that no option is read.
const std::pair<const char*, std::string> k_modes[] = {
    {"fit of a folder", k_folder},
    {"fit view by view", "fit table.binary -o o.srbf --model su --directions 8 --lobes 1 --objective raw"},
    {"fit of a table", "fit table.binary -o o.srbf " + k_fit},
    {"fit with a target ΔE", "fit table.binary -o o.srbf --objective raw --target-delta-e 50"},
    {"fit of files as one sample", "fit samples.csv samples.csv --as-one -o o.srbf --model ggx --objective raw"},
    {"fit of Lambert and GGX", "fit table.binary -o o.srbf --model ggx --objective raw"},
    {"fit of OpenPBR", "fit table.binary -o o.srbf --model principled --objective raw"},
    {"map of texels", "map texels.npy --pairs pairs.csv --lobes 1 --variates 1 -o o.srbf"},
    {"map of masks", "map table.binary table.binary --masks masks.npy --lobes 1 --variates 1 -o o.srbf"},
    {"eval", "eval model.srbf --pairs pairs.csv"},
    {"compare", "compare table.binary model.srbf"},
    {"convert to MERL", "convert model.srbf -o o.binary"},
    {"convert to RGL", "convert model.srbf -o o.bsdf"},
    {"convert to CSV", "convert model.srbf -o o.csv"},
    {"convert samples to CSV", "convert samples.csv -o o.csv"},
    {"convert RGL to RGL", "convert rgl.bsdf -o o.bsdf"},
    {"render paths", "render model.srbf -o o.exr --size 9x8 --spp 2"},
    {"render a room", "render bsdf.srbf -o o.exr --size 9x8 --spp 2 --scene room"},
    {"render without occlusion", "render model.srbf -o o.exr --size 9x8 --spp 2 --no-occlusion --draw cosine"},
    {"render by rasterization", "render model.srbf -o o.exr --size 9x8 --renderer raster"},
    {"edit a hue", "edit model.srbf --hue 10 -o o.srbf"},
    {"edit a coat", "edit model.srbf --coat 0.3 -o o.srbf"},
    {"blend", "blend model.srbf model.srbf -o o.srbf"},
    {"export code", "export model.srbf --to glsl -o o.glsl"},
    {"export three.js", "export model.srbf --to three -o o.js"},
    {"export three.js for WebGPU", "export model.srbf --to three-webgpu -o o.js"},
    {"export an environment", "export none.hdr --to dds -o o.dds"},
    {"export the code of a map", "export map.srbf --to glsl -o o.glsl"},
    {"export the textures of a map", "export map.srbf --to ktx2 -o o.ktx2"},
    {"export a surface", "export openpbr.srbf --to mtlx -o o.mtlx"},
    {"export Blender nodes", "export model.srbf --to blender -o o.py --terms 1"},
    {"export a shader of closures", "export model.srbf --to osl -o o.osl --terms 1"},
    {"export an HTML page", "export model.srbf --to html -o o.html"},
    {"export an HTML page with a mesh", "export model.srbf --to html -o o.html --mesh mesh.obj"},
};

/// Each option, and an argument that differs from its default; flags have none.
const Arguments k_arguments = words(
    "--output x.srbf --resume --as-one --model ggx --form gaussian --lobes 2 --variates 2 --axial --no-axial "
    "--as-measured --albedo-limit 0.01 --exchange --smooth --objective cosine --max-theta 70 --discretise light "
    "--directions 9 --interpolation 2 --with-index cube --band Solar --channels spectral --target-delta-e 50 "
    "--preview x.png --json x.json --pairs pairs.csv --masks masks.npy --width 1 --seed 1 --threads 1 --rgb-alone "
    "--basis 2 --columns wl_x,wl_y,wl_z,wv_x,wv_y,wv_z,value --quantity factor --floor 0.32 --renderer raster "
    "--mesh knot --up z --size 8x8 --aov --compare table.binary --env light.hdr --lights behind --spp 1 --bounces "
    "1 --draw cosine --scene room --no-ground --no-occlusion --to hlsl --with sampling --coefficients byte "
    "--terms 2 --reference table.binary --roughen 1.5 --tint-highlight 1,0.5,0.5 --tint-body 1,0.5,0.5 "
    "--scale-highlight 0.5 --scale-body 0.5 --saturate 0.5 --hue 20 --rotate 20 --coat 0.2 --coat-ior 1.6 "
    "--coat-tint 1,0.5,0.5 --reduce 1 --mix 0.3 --mask mesh.obj");
bool is_listed(const std::string& option) { return std::ranges::count(k_arguments, option) == 1; }
std::string argument_after(const std::string& option) {
    const auto next = std::ranges::find(k_arguments, option) + 1;
    return next == k_arguments.end() || next->starts_with("--") ? "" : *next;
}
/// The argument for an option. Formats have options of `srbf convert` with their own values.
std::string argument_of(const std::string& subcommand, const std::string& option) {
    for (const Format& format : formats())
        if (subcommand == "convert" && format.option && format.option->name == option)
            return std::string(format.option->values[1]);
    return argument_after(option);
}
/// The modes above, and a conversion to each format that has an option.
std::vector<std::pair<std::string, std::string>> all_modes() {
    std::vector<std::pair<std::string, std::string>> modes(std::begin(k_modes), std::end(k_modes));
    for (const Format& format : formats())
        if (format.option)
            modes.emplace_back("convert to " + std::string(format.name),
                               fmt::format("convert bsdf.srbf -o o{} {} {}", format.extension, format.option->name,
                                           format.option->values.back()));
    return modes;
}
/// True if the output of a subcommand contains durations.
bool prints_durations(const std::string& subcommand) { return subcommand == "fit" || subcommand == "map"; }
/// Options that do not change the output, and the default for isotropic measurements.
const std::set<std::string> k_without_effect{"--threads", "--resume", "--axial"};
/// Options that all modes of a subcommand read in the same lines of code. They are tried only in the first mode
/// that reads them.
const std::set<std::string> k_tried_once{
    "--exchange",      "--max-theta",  "--seed",    "--json",           "--preview",     "--discretise",
    "--interpolation", "--with-index", "--form",    "--no-axial",       "--as-measured", "--albedo-limit",
    "--env",           "--mesh",       "--up",      "--size",           "--lights",      "--compare",
    "--aov",           "--bounces",    "--roughen", "--tint-highlight", "--tint-body",   "--scale-highlight",
    "--scale-body",    "--saturate",   "--hue",     "--rotate",         "--reduce"};
/// Options that are read but have no effect in a mode: axial lobes take fewer bytes anyway; MERL tables are
/// reciprocal; the lights are outside the room and on a side without its window.
const std::set<std::pair<std::string, std::string>> k_without_effect_in_mode{
    {"fit with a target ΔE", "--no-axial"}, {"convert to MERL", "--exchange"}, {"render a room", "--lights"}};

class Options : public ProgramTest {
  protected:
    void SetUp() override {
        static std::map<std::string, std::string> input_files;  // created once
        if (input_files.empty()) {
            write_inputs();
            if (HasFatalFailure()) return;
            input_files = folder.files();
        }
        for (const auto& [name, content] : input_files) write_text(folder / name, content);
        inputs = input_files;
    }
    void write_inputs() {
        write_text(folder / "table.binary", small_merl());
        std::mt19937_64 random(1);
        ASSERT_TRUE(save_model({random_model(random, {.lobes = 1, .variates = 1, .max_bandwidth = 20}), {}},
                               folder / "model.srbf")
                        .ok());
        ASSERT_TRUE(save_model({OpenPbrModel{}, {}}, folder / "openpbr.srbf").ok());
        ASSERT_TRUE(save_model({lobe_bsdf_with_beams(), {}}, folder / "bsdf.srbf").ok());
        const Bytes map = write_map(random_map(random, {.lobes = 2}, 3, 2));
        write_text(folder / "map.srbf", as_text(map));
        std::string samples = "wl_x,wl_y,wl_z,wv_x,wv_y,wv_z,r,g,b\n", pairs = "wl_x,wl_y,wl_z,wv_x,wv_y,wv_z\n";
        std::vector<float> texels;
        for (int i = 0; i < 60; ++i) {
            const Vec3d wl = random_direction(random), wv = random_direction(random);
            const std::string pair =
                fmt::format("{},{},{},{},{},{}", wl.x, wl.y, std::abs(wl.z) + 1e-3, wv.x, wv.y, std::abs(wv.z) + 1e-3);
            const double f = 0.3 + 0.1 * wl.z * wv.z;
            samples += fmt::format("{},{},{},{}\n", pair, f, f + 0.01, f + 0.02);
            pairs += pair + "\n";
        }
        for (int i = 0; i < 2 * 60 * 3; ++i) texels.push_back(float(0.2 + 0.1 * uniform(random)));
        write_text(folder / "samples.csv", samples);
        write_text(folder / "pairs.csv", pairs);
        const auto write_npy = [&](const char* name, const char* shape, std::size_t numbers) {
            const std::string head = fmt::format("{{'descr': '<f4', 'fortran_order': False, 'shape': {}, }}\n", shape);
            write_text(folder / name, "\x93NUMPY" + std::string("\1\0", 2) + char(head.size()) + '\0' + head +
                                          std::string(reinterpret_cast<const char*>(texels.data()), 4 * numbers));
        };
        write_npy("texels.npy", "(2, 60, 3)", texels.size());
        write_npy("masks.npy", "(2, 3, 2)", 12);
        write_text(folder / "mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 2\nf 1 2 3\nf 1 2 4\n");
        write_text(folder / "light.hdr", fmt::format("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n{}",
                                                     std::string("\x80\x40\x40\x81\x20\x40\x80\x80", 8)));
        run_ok(folder, {"convert", "model.srbf", "-o", "rgl.bsdf"});
    }

    /// The output and the files of a run. Reports of fits are left out because they contain durations.
    struct Written {
        int status;
        std::string out, err;
        std::map<std::string, std::string> files;
        bool operator==(const Written&) const = default;
    };
    Written run_and_collect(const Arguments& arguments) {
        ProgramRun result = run_srbf(folder, arguments);
        Written output{result.status, prints_durations(arguments[0]) ? "" : result.out, result.err, {}};
        for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path)) {
            const std::string name = entry.path().lexically_relative(folder.path).string();
            if (inputs.contains(name) || !entry.is_regular_file()) continue;
            output.files[name] = name.ends_with(".json") ? "" : read_text(entry.path());
        }
        for (const auto& entry : std::filesystem::directory_iterator(folder.path))
            if (!inputs.contains(entry.path().filename().string())) std::filesystem::remove_all(entry.path());
        return output;
    }

    /// Runs the command with a folder `o` for its output.
    Written run_in_new_folder(const Arguments& arguments) {
        std::filesystem::create_directories(folder / "o");
        return run_and_collect(arguments);
    }
    /// The result of `run_in_new_folder`, which is kept.
    const Written& cached_run(const Arguments& arguments) {
        static std::map<Arguments, Written> results;
        const auto [entry, is_new] = results.try_emplace(arguments);
        if (is_new) entry->second = run_in_new_folder(arguments);
        return entry->second;
    }

    std::map<std::string, std::string> inputs;
};

TEST_F(Options, AreReadOrRefused) {
    const auto options = long_options(folder);
    ASSERT_GE(options.at("fit").size(), 25u);
    std::map<std::string, std::set<std::string>> options_read;  // for each subcommand
    for (const auto& [name, text] : all_modes()) {
        const Arguments base = words(text);
        if (!is_built(base)) continue;
        const Written& without = cached_run(base);
        if (without.status != 0 && text.find("none.") == text.npos) {
            EXPECT_CONTAINS(text, "raster") << '\n' << without.err;  // there is no OpenGL
            continue;
        }
        for (const std::string& option : options.contains(base[0]) ? options.at(base[0]) : Arguments{}) {
            ASSERT_TRUE(is_listed(option)) << option << " has no argument in this test";
            const bool is_given =
                std::ranges::count(base, option) > 0 || (option == "--output" && text.find("-o") != text.npos);
            if (is_given || k_without_effect.contains(option) || k_without_effect_in_mode.contains({name, option}))
                continue;
            if (k_tried_once.contains(option) && options_read[base[0]].contains(option)) continue;
            const Written& with = cached_run(base + Arguments{option} + words(argument_of(base[0], option)));
            EXPECT_GE(with.status, 0) << text << ' ' << option;
            EXPECT_FALSE(with == without) << name << ": " << text << ": " << option << " is accepted and not read";
            if (with.status == 0) {
                options_read[base[0]].insert(option);
                continue;
            }
            EXPECT_EQ(with.files.size(), 0u) << text << ' ' << option;
            EXPECT_ONE_LINE(with.err, "srbf: ");
        }
    }
}

#ifdef SRBF_FAILING_CALLS
/// A command that can resume, and the name of its input.
const Arguments k_resuming = words(k_folder);
constexpr const char* k_resumed_input = "table.binary";

/// The content of another measurement, which differs in one bit.
std::string changed_content(std::string content) {
    content[content.size() - 2] = char(content[content.size() - 2] ^ 1);  // a bit of the last number
    return content;
}

class Resuming : public Options {
  protected:
    /// Runs a command that is killed before it completes its last output. Moves the remaining files to `left`.
    void kill_at_the_end(const Arguments& arguments) {
        std::filesystem::create_directories(folder / "o");
        std::string count = run_failing(arguments, "-1", "5");
        ASSERT_FALSE(count.empty());
        std::filesystem::remove_all(folder / "o");
        std::filesystem::create_directories(folder / "o");
        count = run_failing(arguments, std::to_string(std::stol(count) - 2), "0");
        ASSERT_TRUE(count.empty()) << "it was not killed";
        for (const auto& entry : std::filesystem::directory_iterator(folder / "o"))  // an incomplete write
            if (entry.path().extension() == ".tmp") std::filesystem::remove(entry.path());
        std::filesystem::rename(folder / "o", partial_output / "o");
    }
    Written resumed(const Arguments& arguments) {
        std::filesystem::copy(partial_output / "o", folder / "o", std::filesystem::copy_options::recursive);
        return run_and_collect(arguments + Arguments{"--resume"});
    }
    /// Expects that a resumed run writes the same files as a fresh one, `expected`. Returns false without running if
    /// the command is rejected.
    bool expect_resumed(const Arguments& arguments, const Written& expected) {
        SCOPED_TRACE(fmt::format("{}", fmt::join(arguments, " ")));
        if (expected.status != 0) return false;
        const Written result = resumed(arguments);
        EXPECT_EQ(result.status, 0) << result.err;
        EXPECT_TRUE(result.files == expected.files);
        return true;
    }

    TemporaryFolder partial_output;

  private:
    /// The number of fsync calls of a run that ended normally, otherwise an empty string.
    std::string run_failing(const Arguments& arguments, const std::string& fail_at, const std::string& error) {
        const TemporaryFolder count_folder;
        ::setenv("LD_PRELOAD", SRBF_FAILING_CALLS, 1);
        ::setenv("SRBF_FAIL_CALL", "fsync", 1);
        ::setenv("SRBF_FAIL_AT", fail_at.c_str(), 1);
        ::setenv("SRBF_FAIL_ERROR", error.c_str(), 1);
        ::setenv("SRBF_FAIL_COUNT", (count_folder / "count").c_str(), 1);
        (void)run_srbf(folder, arguments);
        ::unsetenv("LD_PRELOAD");
        return read_text(count_folder / "count");
    }
};

/// Each option and each input changes between a killed run and the run that resumes it.
TEST_F(Resuming, KeepsOldResultsOutOfNewOnes) {
    const auto options = long_options(folder);
    const Arguments& base = k_resuming;
    kill_at_the_end(base);
    if (HasFatalFailure()) return;
    std::filesystem::copy(partial_output / "o", folder / "o", std::filesystem::copy_options::recursive);
    EXPECT_LACKS(run_srbf(folder, base + Arguments{"--resume"}).out, " 0 kept");
    std::filesystem::remove_all(folder / "o");
    EXPECT_TRUE(expect_resumed(base, cached_run(base)));
    int tried = 0;
    for (const std::string& option : options.at(base[0])) {
        if (k_without_effect.contains(option) || option == "--output") continue;
        Arguments with = base;
        if (const auto position = std::ranges::find(with, option); position != with.end())
            with.erase(position, position + 2);
        with = with + Arguments{option} + words(argument_of(base[0], option));
        tried += expect_resumed(with, cached_run(with));
    }
    EXPECT_GE(tried, 5);
    const std::string before = read_text(folder / k_resumed_input);
    ASSERT_NE(changed_content(before), before);
    write_text(folder / k_resumed_input, changed_content(before));
    EXPECT_TRUE(expect_resumed(base, run_in_new_folder(base)));
    write_text(folder / k_resumed_input, before);
}

#endif

/// Values of the wrong type for an option, and any value for a flag. The input is missing, so that every run is
/// quick.
TEST_F(Options, AreRefusedWithValuesOfTheWrongType) {
    const std::map<std::string, std::string> base{{"fit", "fit x"},
                                                  {"map", "map x --pairs pairs.csv -o o"},
                                                  {"info", "info x"},
                                                  {"eval", "eval x --pairs pairs.csv"},
                                                  {"compare", "compare x model.srbf"},
                                                  {"convert", "convert x -o o.csv"},
                                                  {"render", "render x -o o.png"},
                                                  {"export", "export x --to glsl -o o.glsl"},
                                                  {"report", "report x -o o"}};
    const auto options = long_options(folder);
    for (const auto& [subcommand, text] : base) {
        if (!options.contains(subcommand)) continue;  // an extra that is not built
        for (const std::string& option : options.at(subcommand) + Arguments{"--help", "--version", "--max-memory"}) {
            const bool is_flag = is_listed(option) && argument_after(option).empty();
            for (const std::string value : {"rgb", "-7", "99999999999999999999"}) {
                const Written result = run_and_collect(words(text) + Arguments{option + "=" + value});
                const std::string line = fmt::format("{} {}={}: {}", text, option, value, result.err);
                EXPECT_TRUE(is_flag ? result.status == 2 : result.status == 1 || result.status == 2) << line;
                EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << line;
                EXPECT_TRUE(result.files.empty() || subcommand == "report") << line;  // a report has rows for failures
            }
        }
    }
}

}  // namespace
}  // namespace srbf::options_test
