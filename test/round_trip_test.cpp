// Each command reads every file that another writes; and `srbf eval` takes constant memory and lines of any kind.
#include <sys/resource.h>
#include <sys/wait.h>

#include "command.h"
#include "models.h"
#include "models/bsdf/bsdf_functions.h"
#include "models/ggx/ggx_kind.h"
#include "srbf/file.h"
#include "su_models.h"

namespace srbf::round_trip_test {
namespace {

class RoundTrip : public ProgramTest {
  protected:
    void SetUp() override {
        write_text(folder / "pairs.csv",
                   "wl_x,wl_y,wl_z,wv_x,wv_y,wv_z\n0,0,1,0,0,1\n0.6,0,0.8,0,0,1\n0.8,0,0.6,0,0,1\n0.96,0,0.28,0,0,1\n"
                   "0.28,0,0.96,0.6,0,0.8\n0.96,0,0.28,0.28,0,0.96\n0.6,0,0.8,-0.8,0,0.6\n0,0.6,0.8,0.6,0,0.8\n");
        std::mt19937_64 random(1);
        map_ = random_map(random, {.lobes = 2, .variates = 2}, 1, 2);
        ASSERT_TRUE(write_file(folder / "map.srbf", write_map(map_)).ok());
    }
    TexelMap map_;
};

TEST_F(RoundTrip, EveryCommandReadsWhatOthersWrite) {
    std::mt19937_64 random(1);
    BsdfModel two =
        lobe_bsdf_with_beams();  // it has two of four parts, because each file of samples is fitted part by part
    two.part[std::size_t(Part::reflection_back)] = two.part[std::size_t(Part::transmission_back)] = nullptr;
    two.beam = {};  // tables of samples cannot hold beams
    const Model pm{random_model(random, {.lobes = 2, .variates = 2}), {}}, bsdf{two, {}},
        su{random_su(random, 8, 2), {}}, ggx{GgxModel{{0.1f, 0.1f, 0.1f}, {{0.4f, {0.5f, 0.1f, 0.1f}, 1}}}, {}},
        spectral{spectral_model(random, {.lobes = 2}, 3), {}};
    for (const auto& [name, model] : {std::pair("pm.srbf", pm),
                                      {"bsdf.srbf", bsdf},
                                      {"su.srbf", su},
                                      {"ggx.srbf", ggx},
                                      {"spectral.srbf", spectral}})
        ASSERT_TRUE(save_model(model, folder / name).ok());
    for (const char* output : {"table.binary", "table.bsdf", "table.mbsdf"})
        run_ok(folder, {"convert", "pm.srbf", "-o", output});
    run_ok(folder, {"convert", "bsdf.srbf", "-o", "both.mbsdf"});
    for (const char* name : {"pm", "bsdf"})
        run_ok(folder, {"convert", name + std::string(".srbf"), "-o", name + std::string(".csv"), "--directions", "4"});
    for (const std::string model : {"pm.srbf", "spectral.srbf", "table.binary"})
        write_text(folder / ("eval_" + model + ".csv"), run_ok(folder, {"eval", model, "--pairs", "pairs.csv"}).out);
    run_ok(folder, {"fit", "pm.csv", "--model", "ggx", "--objective", "raw", "-o", "fit.srbf"});

    for (const std::string file : {"pm.srbf", "bsdf.srbf", "su.srbf", "ggx.srbf", "spectral.srbf", "map.srbf#1",
                                   "fit.srbf", "table.binary", "table.bsdf", "table.mbsdf", "both.mbsdf", "pm.csv",
                                   "bsdf.csv", "eval_pm.srbf.csv", "eval_spectral.srbf.csv", "eval_table.binary.csv"}) {
        run_ok(folder, {"info", file});
        run_ok(folder, {"eval", file, "--pairs", "pairs.csv"});
        Arguments again{"convert", file, "-o", "again.csv"};
        if (!file.ends_with(".csv")) again.insert(again.end(), {"--directions", "3"});
        run_ok(folder, again);
        if (file == "bsdf.csv") continue;  // pictures and fits of scattered samples of two sides take seconds
        if (is_built({"render"})) run_ok(folder, {"render", file, "-o", "x.png", "--size", "4x4", "--spp", "1"});
        if (file.find("srbf") != file.npos && file.find(".csv") == file.npos)
            run_ok(folder, {"export", file, "--to", "c", "-o", "x.h"});
        else if (!file.ends_with(".csv"))
            run_ok(folder, k_quick_fit + Arguments{file, "-o", "x.srbf"});
        else if (file == "eval_spectral.srbf.csv")
            run_ok(folder, {"fit", file, "--model", "ggx", "--objective", "raw", "-o", "x.srbf"});
    }
    if (!is_built({"render"})) return;
    run_ok(folder, {"render", "pm.srbf", "-o", "x.exr", "--size", "8x8", "--spp", "1"});
    run_ok(folder, {"render", "pm.srbf", "-o", "x.png", "--size", "8x8", "--spp", "1", "--compare", "x.exr"});
    run_ok(folder, {"render", "pm.srbf", "-o", "y.png", "--size", "8x8", "--spp", "1", "--env", "x.exr"});
}

TEST_F(RoundTrip, TexelsOfAMapAreNamedByNumberAndPlace) {
    const ProgramRun whole = run_ok(folder, {"info", "map.srbf"});
    EXPECT_CONTAINS(whole.out, "1 × 2 texels of 2 shared lobes");
    ASSERT_TRUE(save_model(texel(map_, 1), folder / "model.srbf").ok());
    for (const char* name : {"map.srbf#1", "map.srbf#0,1"})
        EXPECT_EQ(run_srbf(folder, {"eval", name, "--pairs", "pairs.csv"}).out,
                  run_srbf(folder, {"eval", "model.srbf", "--pairs", "pairs.csv"}).out);
    expect_failure(1, {"info", "map.srbf#2"}, "map.srbf#2: texel: expected 0 to 1, or 0,0 to 0,1, found 2");
    expect_failure(1, {"info", "model.srbf#0"}, "expected a map, of which # names a texel, found a model");
    expect_failure(1, {"eval", "map.srbf", "--pairs", "pairs.csv"}, "a map of texels, which map.srbf#X,Y names");
    expect_failure(1, {"info", "missing#0"}, "missing: cannot be read");
    std::filesystem::copy(folder / "model.srbf", folder / "m#7");
    run_ok(folder, {"info", "m#7"});
}

/// A million pairs take the memory of a thousand.
TEST_F(RoundTrip, EvalTakesConstantMemory) {
    const auto memory = [&](std::size_t pairs) {
        {
            std::ofstream csv(folder / "many.csv");
            csv << "wl_x,wl_y,wl_z,wv_x,wv_y,wv_z\n";
            for (std::size_t i = 0; i < pairs; ++i) csv << "0.6,0,0.8,0,0,1\n";
        }
        const pid_t process =
            start_srbf(folder, {"eval", "map.srbf#0", "--pairs", "many.csv"}, folder / "out", folder / "err");
        int status = 0;
        rusage usage{};
        EXPECT_EQ(::wait4(process, &status, 0, &usage), process);
        EXPECT_EQ(status, 0);
        std::ifstream out(folder / "out");
        std::size_t lines = 0;
        for (std::string line; std::getline(out, line);) ++lines;
        EXPECT_EQ(lines, pairs + 1);
        return std::int64_t(usage.ru_maxrss) * 1024;
    };
    const std::int64_t few = memory(200'000);
    EXPECT_LT(memory(1'000'000), few + (8 << 20));
}

TEST_F(RoundTrip, EvalReadsLinesOfAnyKind) {
    const std::string header = "name,wl_x,wl_y,wl_z,wv_x,wv_y,wv_z", row = "0,0,1,0,0,1";
    const auto eval = [&](const std::string& csv) {
        write_text(folder / "lines.csv", csv);
        return run_srbf(folder, {"eval", "map.srbf#0", "--pairs", "lines.csv"});
    };
    const std::string plain = eval(header + "\nx," + row + "\n").out;
    EXPECT_EQ(std::ranges::count(plain, '\n'), 2);
    EXPECT_EQ(eval("\xef\xbb\xbf" + header + "\r\n\r\n\"x, y\"," + row).out, plain);
    EXPECT_EQ(eval(header + "\n").out, plain.substr(0, plain.find('\n') + 1));
    const std::string name(1'100'000, 'x');
    write_text(folder / "lines.csv", header + "\n" + name + "," + row + "\n");
    expect_failure(1, {"eval", "map.srbf#0", "--pairs", "lines.csv"},
                   "line 2: length: expected less than 1048576 bytes");
    // Blocks end anywhere within lines.
    std::string many = header + "\n";
    for (int i = 0; i < 60'000; ++i) many += std::string(std::size_t(i % 50), 'n') + "," + row + "\n";
    const std::string all = eval(many).out;
    EXPECT_EQ(std::ranges::count(all, '\n'), 60'001);
    write_text(folder / "lines.csv", many + "x,0,0,2,0,0,1\n");
    EXPECT_CONTAINS(run_srbf(folder, {"eval", "map.srbf#0", "--pairs", "lines.csv"}).err, "line 60002: direction wl");
}

}  // namespace
}  // namespace srbf::round_trip_test
