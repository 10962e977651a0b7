// Every option of every subcommand changes what is written, or is refused: none is accepted that the chosen mode does
// not read.
#include <sys/file.h>

#include <map>
#include <set>
#include <sstream>

#include "command.h"
#include "measured/formats.h"
#include "models.h"

namespace srbf::options_test {
namespace {

const std::string k_fit = "--lobes 1 --variates 1 --objective raw --seed 3";
const std::string k_folder = "fit m.binary -o o/ --model su --directions 8 --lobes 1 --objective raw";
/// Modes of subcommands: a name, and arguments to which each option is added. The quickest mode of a subcommand comes
/// first. An input that is missing stands for one that takes long, where no option is read.
const std::pair<const char*, std::string> k_modes[] = {
    {"view by view", "fit m.binary -o o.srbf --model su --directions 8 --lobes 1 --objective raw"},
    {"a table", "fit m.binary -o o.srbf " + k_fit},
    {"a goal", "fit m.binary -o o.srbf --objective raw --budget 14"},
    {"ggx", "fit m.binary -o o.srbf --model ggx --objective raw"},
    {"openpbr", "fit m.binary -o o.srbf --model openpbr --surface principled --objective raw"},
    {"a folder", k_folder},
    {"texels", "map t.npy --pairs p.csv -o d " + k_fit},
    {"a map of shared lobes", "map t.npy --pairs p.csv --basis 2 --variates 1 -o o.srbf"},
    {"a library", "basis m.binary -o o.srbf --lobes 2 --active 1 --variates 1"},
    {"a library of old lobes", "basis m.binary -o o.srbf --lobes t.srbf --active 1"},
    {"explain", "explain"},
    {"eval", "eval m.srbf --pairs p.csv"},
    {"compare", "compare m.binary m.srbf"},
    {"to MERL", "convert m.srbf -o o.binary"},
    {"to RGL", "convert m.srbf -o o.bsdf"},
    {"to CSV", "convert m.srbf -o o.csv"},
    {"samples to CSV", "convert s.csv -o o.csv"},
    {"RGL to RGL", "convert r.bsdf -o o.bsdf"},
    {"paths", "render m.srbf -o o.exr --size 9x8 --spp 2"},
    {"a room", "render b.srbf -o o.exr --size 9x8 --spp 2 --scene room"},
    {"without occlusion", "render m.srbf -o o.exr --size 9x8 --spp 2 --no-occlusion --draw cosine"},
    {"raster", "render m.srbf -o o.exr --size 9x8 --renderer raster"},
    {"raster, environment", "render m.srbf -o o.exr --size 9x8 --renderer raster --env studio --spp 1"},
    {"code", "export m.srbf --to glsl -o o.glsl"},
    {"three.js", "export m.srbf --to three -o o.js"},
    {"an environment", "export none.hdr --to dds -o o.dds"},
    {"a map's code", "export t.srbf --to glsl -o o.glsl"},
    {"a map's textures", "export t.srbf --to ktx2 -o o.ktx2"},
    {"a surface", "export q.srbf --to mtlx -o o.mtlx"},
    {"page", "export m.srbf --to html -o o.html"},
    {"page, mesh", "export m.srbf --to html -o o.html --mesh m.obj"},
};

/// An argument for each option, other than its default. Every option must be here.
const std::map<std::string, std::string> k_argument{
    {"--output", "x.srbf"},
    {"--resume", ""},
    {"--model", "ggx"},
    {"--form", "gaussian"},
    {"--surface", "gltf"},
    {"--lobes", "2"},
    {"--variates", "2"},
    {"--axial", ""},
    {"--no-axial", ""},
    {"--reciprocal", ""},
    {"--no-scale", ""},
    {"--exchange", ""},
    {"--smooth", ""},
    {"--objective", "cosine"},
    {"--max-theta", "70"},
    {"--discretise", "light"},
    {"--directions", "9"},
    {"--interpolation", "plain"},
    {"--neighbours", "2"},
    {"--with-index", "cube"},
    {"--band", "Solar"},
    {"--channels", "spectral"},
    {"--target-delta-e", "50"},
    {"--budget", "12"},
    {"--preview", "x.png"},
    {"--json", "x.json"},
    {"--pairs", "p.csv"},
    {"--texels", "0:1"},
    {"--slab", "1"},
    {"--active", "2"},
    {"--width", "1"},
    {"--seed", "1"},
    {"--threads", "1"},
    {"--rgb-alone", ""},
    {"--basis", "2"},
    {"--columns", "wl_x,wl_y,wl_z,wv_x,wv_y,wv_z,value"},
    {"--quantity", "factor"},
    {"--floor", "0.1"},
    {"--renderer", "raster"},
    {"--mesh", "knot"},
    {"--up", "z"},
    {"--size", "8x8"},
    {"--aov", ""},
    {"--compare", "m.binary"},
    {"--env", "e.hdr"},
    {"--lights", "behind"},
    {"--spp", "1"},
    {"--bounces", "1"},
    {"--draw", "cosine"},
    {"--scene", "room"},
    {"--no-ground", ""},
    {"--no-occlusion", ""},
    {"--to", "hlsl"},
    {"--with", "sampling"},
    {"--reference", "m.binary"},
};
/// Formats have options of `srbf convert`, with values of their own.
std::string argument_of(const std::string& subcommand, const std::string& option) {
    for (const Format& format : formats())
        if (subcommand == "convert" && format.option && format.option->name == option)
            return std::string(format.option->values[1]);
    return k_argument.at(option);
}
/// The runs above, and a conversion to each format that has an option.
std::vector<std::pair<std::string, std::string>> all_modes() {
    std::vector<std::pair<std::string, std::string>> all(std::begin(k_modes), std::end(k_modes));
    for (const Format& format : formats())
        if (format.option)
            all.emplace_back("to " + std::string(format.name),
                             fmt::format("convert b.srbf -o o{} {} {}", format.extension, format.option->name,
                                         format.option->values.back()));
    return all;
}
/// True if what a subcommand prints has durations.
bool takes_time(const std::string& subcommand) {
    return subcommand == "fit" || subcommand == "map" || subcommand == "basis";
}
/// What promises not to change what is written, and the default of what is isotropic.
const std::set<std::string> k_changes_nothing{"--threads", "--resume", "--axial"};
/// What all modes of a subcommand that have it read by the same lines: tried in the first of them alone.
const std::set<std::string> k_read_alike{"--exchange", "--max-theta", "--seed", "--json", "--preview",
                                         "--env",      "--mesh",      "--up",   "--size", "--lights"};
/// What is read and changes nothing here: axial lobes take fewer bytes; tables of MERL's layout are reciprocal; the light
/// is outside the room, on another side than its window.
const std::set<std::pair<std::string, std::string>> k_reads_all_the_same{
    {"a goal", "--no-axial"}, {"to MERL", "--exchange"}, {"a room", "--lights"}};

class Options : public CommandLine {
  protected:
    void SetUp() override {
        static std::map<std::string, std::string> made;  // once
        if (made.empty()) {
            write_inputs();
            if (HasFatalFailure()) return;
            made = folder.files();
        }
        for (const auto& [name, content] : made) write(folder / name, content);
        inputs = made;
    }
    void write_inputs() {
        write(folder / "m.binary", small_merl());
        std::mt19937_64 random(1);
        ASSERT_TRUE(
            save_model({random_model(random, {.lobes = 1, .variates = 1, .most_bandwidth = 20}), {}}, folder / "m.srbf")
                .ok());
        ASSERT_TRUE(save_model({OpenPbrModel{}, {}}, folder / "q.srbf").ok());
        ASSERT_TRUE(save_model({full_bsdf(), {}}, folder / "b.srbf").ok());
        const Bytes map = write_library(random_map(random, {.lobes = 2}, 3, 2));
        write(folder / "t.srbf", text_of(map));
        std::string samples = "wl_x,wl_y,wl_z,wv_x,wv_y,wv_z,r,g,b\n", pairs = "wl_x,wl_y,wl_z,wv_x,wv_y,wv_z\n";
        std::vector<float> texels;
        for (int i = 0; i < 60; ++i) {
            const Vec3d wl = random_direction(random), wv = random_direction(random);
            const std::string pair =
                fmt::format("{},{},{},{},{},{}", wl.x, wl.y, std::abs(wl.z) + 1e-3, wv.x, wv.y, std::abs(wv.z) + 1e-3);
            samples += fmt::format("{},{},0.3,0.2\n", pair, 0.3 + 0.1 * wl.z * wv.z);
            pairs += pair + "\n";
        }
        for (int i = 0; i < 2 * 60 * 3; ++i) texels.push_back(float(0.2 + 0.1 * uniform(random)));
        write(folder / "s.csv", samples);
        write(folder / "p.csv", pairs);
        const std::string head = "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 60, 3), }\n";
        write(folder / "t.npy", "\x93NUMPY" + std::string("\1\0", 2) + char(head.size()) + '\0' + head +
                                    std::string(reinterpret_cast<const char*>(texels.data()), 4 * texels.size()));
        write(folder / "m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 2\nf 1 2 3\nf 1 2 4\n");
        write(folder / "e.hdr", fmt::format("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n{}",
                                            std::string("\x80\x40\x40\x81\x20\x40\x80\x80", 8)));
        ASSERT_EQ(run(folder, {"convert", "m.srbf", "-o", "r.bsdf"}).status, 0);
    }

    /// The output and the files of a run, of fits without their reports, which hold durations.
    struct Written {
        int status;
        std::string out, err;
        std::map<std::string, std::string> files;
        bool operator==(const Written&) const = default;
    };
    Written written(const Arguments& arguments) {
        ProgramRun done = run(folder, arguments);
        Written all{done.status, takes_time(arguments[0]) ? "" : done.out, done.err, {}};
        for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path)) {
            const std::string name = entry.path().lexically_relative(folder.path).string();
            if (inputs.contains(name) || !entry.is_regular_file()) continue;
            all.files[name] = name.ends_with(".json") ? "" : contents(entry.path());
        }
        for (const auto& entry : std::filesystem::directory_iterator(folder.path))
            if (!inputs.contains(entry.path().filename().string())) std::filesystem::remove_all(entry.path());
        return all;
    }

    /// The same, with a folder `o` to write to.
    Written written_anew(const Arguments& arguments) {
        std::filesystem::create_directories(folder / "o");
        return written(arguments);
    }
    /// The same of the inputs of `SetUp`, once for the same arguments.
    const Written& fresh(const Arguments& arguments) {
        static std::map<Arguments, Written> all;
        const auto [at, is_new] = all.try_emplace(arguments);
        if (is_new) at->second = written_anew(arguments);
        return at->second;
    }

    std::map<std::string, std::string> inputs;
};

TEST_F(Options, are_read_or_refused) {
    const auto all = long_options(folder);
    ASSERT_GE(all.at("fit").size(), 25u);
    std::map<std::string, std::set<std::string>> was_read;  // by a mode of the subcommand
    for (const auto& [name, text] : all_modes()) {
        const Arguments base = words(text);
        if (!is_offered(base)) continue;
        const Written& without = fresh(base);
        if (without.status != 0 && text.find("none.") == text.npos) {
            EXPECT_NE(text.find("raster"), text.npos) << text << '\n' << without.err;  // where there is no OpenGL
            continue;
        }
        for (const std::string& option : all.contains(base[0]) ? all.at(base[0]) : Arguments{}) {
            ASSERT_TRUE(k_argument.contains(option)) << option << " is to be tried";
            const bool is_given =
                std::ranges::count(base, option) > 0 || (option == "--output" && text.find("-o") != text.npos);
            if (is_given || k_changes_nothing.contains(option) || k_reads_all_the_same.contains({name, option}))
                continue;
            if (k_read_alike.contains(option) && was_read[base[0]].contains(option)) continue;
            const Written& with = fresh(base + Arguments{option} + words(argument_of(base[0], option)));
            EXPECT_GE(with.status, 0) << text << ' ' << option;
            EXPECT_FALSE(with == without) << name << ": " << text << ": " << option << " is accepted and not read";
            if (with.status == 0) {
                was_read[base[0]].insert(option);
                continue;
            }
            EXPECT_EQ(with.files.size(), 0u) << text << ' ' << option;
            EXPECT_TRUE(with.err.starts_with("srbf: ") && with.err.find('\n') + 1 == with.err.size()) << with.err;
        }
    }
}

#ifdef SRBF_FAILING_CALLS
/// Commands that resume, and their inputs.
const std::tuple<const char*, std::string, Arguments> k_resuming[] = {
    {"models", k_folder, {"m.binary"}},
    {"slabs", "map t.npy --pairs p.csv -o o/ --slab 1 " + k_fit, {"t.npy", "p.csv"}},
    {"a map", "map t.npy --pairs p.csv --basis 1 --variates 1 -o o/map.srbf", {"t.npy", "p.csv"}},
};

/// Another measurement, or other pairs, that can be fitted as well.
std::string changed(std::string content) {
    if (const auto row = content.find('\n'); content.starts_with("wl_x"))
        return content.insert(row + 1, content.substr(row + 1, content.find('\n', row + 1) - row))
            .erase(content.rfind('\n', content.size() - 2) + 1);
    content[content.size() - 2] = char(content[content.size() - 2] ^ 1);  // of the last number
    return content;
}

class Resuming : public Options {
  protected:
    /// Runs a command until it is killed before it has finished its last output; what it leaves is in `left`.
    void kill_at_the_end(const Arguments& arguments) {
        std::filesystem::create_directories(folder / "o");
        std::string count = run_failing(arguments, "-1", "5");
        ASSERT_FALSE(count.empty());
        std::filesystem::remove_all(folder / "o");
        std::filesystem::create_directories(folder / "o");
        count = run_failing(arguments, std::to_string(std::stol(count) - 2), "0");
        ASSERT_TRUE(count.empty()) << "it was not killed";
        for (const auto& entry : std::filesystem::directory_iterator(folder / "o"))  // a write that was not finished
            if (entry.path().extension() == ".tmp") std::filesystem::remove(entry.path());
        std::filesystem::rename(folder / "o", left / "o");
    }
    Written resumed(const Arguments& arguments) {
        std::filesystem::copy(left / "o", folder / "o", std::filesystem::copy_options::recursive);
        return written(arguments + Arguments{"--resume"});
    }
    /// After any change a run that resumes makes `expected`, which a fresh one does, or says that it cannot. Whether it
    /// is tried: it is not if the command is refused.
    bool try_resuming(const Arguments& arguments, const Written& expected) {
        SCOPED_TRACE(fmt::format("{}", fmt::join(arguments, " ")));
        if (expected.status != 0) return false;
        const Written found = resumed(arguments);
        if (found.status == 0) {
            EXPECT_TRUE(found.files == expected.files);
            return true;
        }
        EXPECT_EQ(found.status, 1);
        EXPECT_NE(found.err.find("unfinished work"), found.err.npos) << found.err;
        std::filesystem::copy(left / "o", folder / "o", std::filesystem::copy_options::recursive);
        const Written anew = written(arguments);
        EXPECT_TRUE(anew.files == expected.files);
        EXPECT_NE(anew.err.find("is replaced"), anew.err.npos) << anew.err;
        return true;
    }

    TemporaryFolder left;

  private:
    /// The number of calls of fsync, of a run that ended by itself.
    std::string run_failing(const Arguments& arguments, const std::string& at, const std::string& error) {
        const TemporaryFolder counted;
        ::setenv("LD_PRELOAD", SRBF_FAILING_CALLS, 1);
        ::setenv("SRBF_FAIL_CALL", "fsync", 1);
        ::setenv("SRBF_FAIL_AT", at.c_str(), 1);
        ::setenv("SRBF_FAIL_ERROR", error.c_str(), 1);
        ::setenv("SRBF_FAIL_COUNT", (counted / "count").c_str(), 1);
        (void)run(folder, arguments);
        ::unsetenv("LD_PRELOAD");
        return contents(counted / "count");
    }
};

/// Between a killed run and the one that resumes it each option and each input changes.
TEST_F(Resuming, mixes_nothing_old_into_the_new) {
    const auto all = long_options(folder);
    for (const auto& [name, text, files] : k_resuming) {
        SCOPED_TRACE(name);
        const Arguments base = words(text);
        if (!is_offered(base)) continue;
        std::filesystem::remove_all(left / "o");
        kill_at_the_end(base);
        if (HasFatalFailure()) return;
        std::filesystem::copy(left / "o", folder / "o", std::filesystem::copy_options::recursive);
        EXPECT_EQ(run(folder, base + Arguments{"--resume"}).out.find(" 0 kept"), std::string::npos);
        std::filesystem::remove_all(folder / "o");
        EXPECT_TRUE(try_resuming(base, fresh(base)));
        int tried = 0;
        for (const std::string& option : all.at(base[0])) {
            if (k_changes_nothing.contains(option) || option == "--output" || option == "--pairs") continue;
            Arguments with = base;
            if (const auto at = std::ranges::find(with, option); at != with.end()) with.erase(at, at + 2);
            with = with + Arguments{option} + words(argument_of(base[0], option));
            tried += try_resuming(with, fresh(with));
        }
        EXPECT_GE(tried, 5);
        for (const std::string& file : files) {
            const std::string before = contents(folder / file);
            ASSERT_NE(changed(before), before);
            write(folder / file, changed(before));
            EXPECT_TRUE(try_resuming(base, written_anew(base)));
            write(folder / file, before);
        }
    }
}

/// A journal that is torn or changed is made again from there on; what is no journal is left alone; a second run waits
/// for nobody and is refused.
TEST_F(Resuming, takes_the_journal_of_a_map_for_what_it_is) {
    const Arguments base = words(std::get<1>(k_resuming[2]));
    const Written& expected = fresh(base);
    kill_at_the_end(base);
    const std::string part = left / "o/map.srbf.part", whole = contents(part);
    for (const std::size_t size : {std::size_t(9), whole.size() - 1}) {
        write(part, whole.substr(0, size));
        EXPECT_TRUE(resumed(base).files == expected.files) << size;
    }
    for (const std::size_t at : {whole.size() / 2, whole.size() - 1}) {
        std::string other = whole;
        other[at] = char(other[at] ^ 1);
        write(part, other);
        const Written found = resumed(base);
        EXPECT_TRUE(found.files == expected.files) << at;
        EXPECT_NE(found.err.find("made again"), found.err.npos) << found.err;
    }
    write(part, "a file of the user's");
    EXPECT_EQ(resumed(base).status, 1);

    write(part, whole);
    std::filesystem::copy(left / "o", folder / "o", std::filesystem::copy_options::recursive);
    const int held = ::open((folder / "o/map.srbf.part").c_str(), O_RDONLY);
    ASSERT_EQ(::flock(held, LOCK_EX), 0);
    for (const Arguments& more : {Arguments{}, Arguments{"--resume"}})
        expect_failure(1, base + more, "another run that writes it");
    ::close(held);
    EXPECT_EQ(run(folder, base + Arguments{"--resume"}).status, 0);
}

#endif

/// A value of another kind than the option takes, of a flag any value. The input is missing, so that nothing takes long.
TEST_F(Options, of_another_kind_are_wrong_use_or_failures) {
    const std::map<std::string, std::string> base{{"fit", "fit x"},
                                                  {"map", "map x --pairs p.csv -o o"},
                                                  {"basis", "basis x -o o"},
                                                  {"explain", "explain"},
                                                  {"info", "info x"},
                                                  {"eval", "eval x --pairs p.csv"},
                                                  {"compare", "compare x m.srbf"},
                                                  {"convert", "convert x -o o.csv"},
                                                  {"render", "render x -o o.png"},
                                                  {"export", "export x --to glsl -o o.glsl"},
                                                  {"report", "report x -o o"}};
    const auto all = long_options(folder);
    for (const auto& [subcommand, text] : base) {
        if (!all.contains(subcommand)) continue;  // an extra that was left out
        for (const std::string& option : all.at(subcommand) + Arguments{"--help", "--version", "--max-memory"}) {
            const bool is_flag = k_argument.contains(option) && k_argument.at(option).empty();
            for (const std::string value : {"rgb", "-7", "99999999999999999999"}) {
                const Written done = written(words(text) + Arguments{option + "=" + value});
                const std::string line = fmt::format("{} {}={}: {}", text, option, value, done.err);
                EXPECT_TRUE(is_flag ? done.status == 2 : done.status == 1 || done.status == 2) << line;
                EXPECT_EQ(std::ranges::count(done.err, '\n'), 1) << line;
                EXPECT_TRUE(done.files.empty() || subcommand == "report") << line;  // which has a row for what failed
            }
        }
    }
}

}  // namespace
}  // namespace srbf::options_test
