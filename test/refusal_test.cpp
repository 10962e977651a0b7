// Errors of the command line: one line that states the cause, and no output files.
#include "command.h"
#include "models.h"

namespace srbf::refusal_test {
namespace {

using Refusal = ProgramTest;

TEST_F(Refusal, SpectraOfColoursAreRefused) {
    write_text(folder / "pairs.csv", "wl_x,wl_y,wl_z,wv_x,wv_y,wv_z\n0,0,1,0,0,1\n");
    write_text(folder / "c.csv", "wl_x,wl_y,wl_z,wv_x,wv_y,wv_z,value\n0,0,1,0,0,1,1\n");
    for (const std::string& file : {k_paper, std::string("c.csv")}) {
        expect_failure(1, {"fit", file, "--channels", "spectral"}, "expected a measurement at wavelengths");
        expect_failure(1, {"eval", file, "--pairs", "pairs.csv", "--channels", "spectral"}, "found one of colours");
    }
    for (const char* model : {"su", "ggx"})
        expect_failure(2, {"fit", k_paper, "--channels", "spectral", "--model", model},
                       "spectral only with --model pm");
}

TEST_F(Refusal, BadInputLeavesNothingBehind) {
    const std::string paper = read_text(k_paper), merl = small_merl();
    write_text(folder / "empty", "");
    write_text(folder / "truncated.bsdf", paper.substr(0, paper.size() / 2));
    write_text(folder / "magic.bsdf", fmt::format("T{}", paper.substr(1)));
    write_text(folder / "size.binary", merl + "x");
    write_text(folder / "truncated.binary", merl.substr(0, merl.size() - 1));
    write_text(folder / "nan.binary", as_text(merl_file({9, 6, 8}, [](auto...) { return std::nan(""); })));
    std::mt19937_64 random(1);
    ASSERT_TRUE(save_model({random_model(random, {}), {}}, folder / "m.srbf").ok());
    write_text(folder / "truncated.srbf", read_text(folder / "m.srbf").substr(0, 40));
    write_text(folder / "kept.srbf", "kept");
    std::filesystem::create_directory(folder / "a folder");
    for (const std::string name : {"missing", "empty", "truncated.bsdf", "magic.bsdf", "size.binary",
                                   "truncated.binary", "nan.binary", "truncated.srbf", "a folder"}) {
        expect_failure(1, {"fit", name, "-o", "kept.srbf", "--preview", "p.png", "--json", "r.json"}, name);
        expect_failure(1, {"info", name}, name);
        expect_failure(1, {"compare", k_paper, name, "--json", "r.json"}, name);
    }
    expect_failure(1, {"fit", "m.srbf"}, "m.srbf: input: expected a measurement, found a fitted model");
    write_text(folder / "zero.binary", as_text(merl_file({9, 6, 8}, [](auto...) { return 0; })));
    expect_failure(1, {"fit", "zero.binary"}, "zero.binary: ");
}

TEST_F(Refusal, OutputsThatCannotBeWrittenLeaveNothingBehind) {
    write_text(folder / "small.binary", small_merl());
    std::filesystem::create_directory(folder / "a folder");
    std::filesystem::create_symlink("small.binary", folder / "link");
    const Arguments fit{"fit", "small.binary", "--model", "ggx"};
    for (const char* option : {"-o", "--preview", "--json"})
        for (const char* name : {"missing/x", "a folder", "link"})
            if (option != std::string("-o") ||
                name != std::string("a folder"))  // which is valid as a folder for several models
                expect_failure(1, fit + Arguments{option, name}, name);
    expect_failure(1, fit + Arguments{"-o", "./small.binary"}, "small.binary");
    expect_failure(1, fit + Arguments{"-o", "x.png", "--preview", "./x.png"}, "x.png");
    expect_failure(1, {"compare", "small.binary", k_paper, "--json", "small.binary"}, "small.binary");
    const Arguments eval{"eval", k_paper, "--pairs", bundled_data() / "paper_white_rgb.csv"};
    for (const Arguments& command : {Arguments{"info", k_paper}, eval})
        expect_failure(1, command, "standard output", "/dev/full");
}

/// A full device is noticed only after fitting and measuring.
TEST_F(Refusal, FullDevicesLeaveNothingBehind) {
    SKIP_UNDER_SANITIZERS("fits take too long");
    write_text(folder / "small.binary", small_merl());
    const Arguments fit{"fit", "small.binary", "--model", "ggx", "--objective", "cosine"};
    expect_failure(1, fit + Arguments{"-o", "/dev/full", "--json", "r.json"}, "/dev/full");
    expect_failure(1, fit + Arguments{"--json", "/dev/full", "--preview", "p.png"}, "/dev/full");
    expect_failure(1, fit, "standard output", "/dev/full");
}

TEST_F(Refusal, UsageErrorsNameTheChoices) {
    expect_failure(2, {"fit", k_paper, "--form", "sauce"}, "expected gaussian or extended or reciprocal, found sauce");
    expect_failure(2, {"fit", k_paper, "--lobes", "many"}, "expected 1 to 64 or auto, found many");
    expect_failure(2, {"fit", k_paper, "--axial", "--no-axial"}, "--axial");
    expect_failure(2, {"fit", k_paper, "--resume", "-o", "x.srbf"}, "must be a folder");
    expect_failure(2, {"fit", k_paper, k_paper, "-o", "x.srbf"}, "must be a folder");
    expect_failure(2, {"fit", k_paper, "--as-one"}, "--as-one");
    expect_failure(1, {"fit", k_paper, k_paper, "--as-one"}, "one sample: expected samples as in paper_white_rgb.bsdf");
}

TEST_F(Refusal, OptionsThatAModeDoesNotReadAreRefused) {
    write_text(folder / "m.binary", small_merl());
    const Arguments raster{"render", "m.binary", "-o", "x.png", "--size", "8x8", "--renderer", "raster"};
    for (const Arguments& path_only : {Arguments{"--aov"},
                                       {"--bounces", "2"},
                                       {"--scene", "room"},
                                       {"--seed", "1"},
                                       {"--draw", "cosine"},
                                       {"--no-ground"},
                                       {"--no-occlusion"},
                                       {"--threads", "1"},
                                       {"--lights", "softbox"}})
        expect_failure(2, raster + path_only, "only with --renderer path (see srbf render --help)");
    expect_failure(2, {"render", "m.binary", "-o", "x.png", "--json", "r.json"}, "--json: only with --compare");
    expect_failure(2, {"render", "m.binary", "-o", "x.png", "--scene", "room", "--mesh", "knot"}, "--scene object");
    expect_failure(2, {"convert", "m.binary", "-o", "x.csv", "--rgb-alone"}, "--rgb-alone: only with an output .bsdf");
    expect_failure(2, {"convert", "m.binary", "-o", "x.mbsdf", "--directions", "9"}, "only with an output .csv");
    expect_failure(2, {"export", "m.srbf", "--to", "html", "-o", "x.html", "--up", "z"}, "--up: only with --mesh");
    for (const Arguments& empty :
         {Arguments{"fit", "m.binary", "-o", ""}, {"info", ""}, {"render", "m.binary", "-o", "x.png", "--env", ""}})
        expect_failure(2, empty, "found an empty one");
    expect_failure(2, {"fit", "m.binary", "-o", "-h"}, "--output: expected a text, found the option -h");
}

/// Models, maps and texels of maps refuse the options of samples.
TEST_F(Refusal, OptionsOfSamplesAreRefusedForModels) {
    write_text(folder / "m.binary", small_merl());
    std::mt19937_64 random(1);
    write_text(folder / "map.srbf", as_text(write_map(random_map(random, {}, 1, 1))));
    ASSERT_TRUE(save_model({random_model(random, {}), {}}, folder / "m.srbf").ok());
    const std::string words = "input: expected samples, for --columns, --quantity and --floor, found a fitted model";
    for (const std::string name : {"m.srbf", "map.srbf", "map.srbf#0"}) {
        expect_failure(1, {"info", name, "--quantity", "factor"}, fmt::format("{}: {}", name, words));
        expect_failure(1, {"convert", name, "-o", "x.csv", "--floor", "0.1"}, fmt::format("{}: {}", name, words));
    }
}

TEST_F(Refusal, UsageErrorsNameTheHelpOfTheirSubcommand) {
    for (const auto& [arguments, help_command] : {std::pair(Arguments{}, "srbf --help"),
                                                  {{"bogus"}, "srbf --help"},
                                                  {{"fit"}, "srbf fit --help"},
                                                  {{"--max-memory", "40", "info", "a"}, "srbf --help"},
                                                  {{"render", "--bogus"}, "srbf render --help"},
                                                  {{"compare", "a"}, "srbf compare --help"}})
        expect_failure(2, arguments, fmt::format("(see {})", help_command));
}

TEST_F(Refusal, UsageErrorsNameWhatIsWrong) {
    const std::pair<Arguments, std::string> bad[] = {
        {{}, "subcommand"},
        {{"bogus"}, "bogus"},
        {{"--bogus"}, "--bogus"},
        {{"fit"}, "INPUT"},
        {{"fit", k_paper, "two"}, "--output"},
        {{"fit", k_paper, "--resume"}, "--output"},
        {{"fit", k_paper, "two", "-o", "d", "--json", "r.json"}, "--json"},
        {{"map", "texels.npy", "-o", "d"}, "--pairs"},
        {{"map", "texels.npy", "--pairs", "pairs.csv"}, "--output"},
        {{"map", "texels.npy", "--pairs", "pairs.csv", "-o", "d", "--model", "ggx"}, "--model"},
        {{"map", "texels.npy", "--pairs", "pairs.csv", "--masks", "masks.npy", "-o", "d"}, "either --pairs or --masks"},
        {{"map", "t.bsdf", "--masks", "masks.npy", "-o", "d", "--width", "2"}, "--width: only with --pairs"},
        {{"map", "texels.npy", "--pairs", "pairs.csv", "-o", "d", "--lobes", "257"},
         "--lobes: expected 1 to 256, found 257"},
        {{"fit", "--bogus"}, "--bogus"},
        {{"fit", k_paper, "--bogus"}, "--bogus"},
        {{"info"}, "FILE"},
        {{"eval", k_paper}, "--pairs"},
        {{"compare", k_paper}, "OTHER"},
        {{"compare", k_paper, k_paper, "--max-theta", "nan"}, "--max-theta"},
        {{"fit", k_paper, "--output"}, "--output"},
        {{"fit", k_paper, "--objective", "none"}, "--objective"},
        {{"fit", k_paper, "--preview", "x.jpg"}, "--preview"},
        {{"fit", k_paper, "--seed", "-1"}, "--seed"},
        {{"fit", k_paper, "--threads", "-1"}, "--threads"},
    };
    for (const auto& [arguments, message_part] : bad) expect_failure(2, arguments, message_part);
}

TEST_F(Refusal, ConvertRefusesInvalidRequests) {
    write_text(folder / "m.binary", small_merl());
    write_text(folder / "a.csv",
               "# anisotropic\nwl_x,wl_y,wl_z,wv_x,wv_y,wv_z,value\n0,0.6,0.8,0,0,1,1\n0.6,0,0.8,0,0,1,1\n");
    expect_failure(2, {"convert", "m.binary", "-o", "m.exr"}, "ends in .bsdf, .mbsdf, .binary, ");
    expect_failure(2, {"convert", "m.binary"}, "--output");
    expect_failure(1, {"convert", "m.binary", "-o", "m.binary"}, "another file than the input");
    expect_failure(1, {"convert", "a.csv", "-o", "a.bsdf"},
                   "expected an isotropic BRDF, as RGL tables are, found an anisotropic one");
    expect_failure(1, {"convert", "none.binary", "-o", "m.csv"}, "none.binary");
    expect_failure(1, {"convert", "m.binary", "-o", "no/folder.bsdf"}, "a folder that exists");
    expect_failure(1, {"map", "m.binary", "--pairs", "a.csv", "-o", "d"}, "m.binary: at 0: magic");
    expect_failure(1, {"fit", "a.csv"}, "samples at different directions: expected at least 5, found 2");
}

TEST_F(Refusal, RenderRefusesInvalidRequests) {
    write_text(folder / "m.binary", small_merl());
    write_text(folder / "no_faces.obj", "v 0 0 0\n");
    write_text(folder / "nan.obj", "v 0 nan 0\nf 1 1 1\n");
    write_text(folder / "range.ply",
               "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
               "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n3 0 1 2\n");
    const Arguments render{"render", "m.binary", "--renderer", "raster", "-o", "x.png"};
    const auto with_mesh = [&](const std::string& mesh) { return render + Arguments{"--mesh", mesh}; };
    expect_failure(1, with_mesh("no_faces.obj"), "no_faces.obj: faces of the mesh: expected one at least, found none");
    expect_failure(1, with_mesh("nan.obj"), "nan.obj: line 1: v: expected three numbers");
    expect_failure(1, with_mesh("range.ply"), "range.ply: vertex index of a face: expected below 1, found 1");
    expect_failure(1, with_mesh("missing.ply"), "missing.ply");
    write_text(folder / "huge.obj", "v 0 0 0\nv 1e18 0 0\nv 0 1e18 0\nf 1 2 3\n");
    expect_failure(1, {"render", "m.binary", "-o", "x.png", "--mesh", "huge.obj"},
                   "huge.obj: coordinates of the mesh: expected at most 1e+07 from 0, found 1e+18");
    expect_failure(1, {"render", "missing", "-o", "x.png"}, "missing");
    expect_failure(1, {"render", "m.binary", "-o", "no/folder.png"}, "a folder that exists");
    for (const char* size : {"0x0", "640x0", "640", "-1x5", "640x480x2", "9000x1", "x", "1e2x5"})
        expect_failure(2, render + Arguments{"--size", size}, "--size: expected WxH");
    expect_failure(2, render + Arguments{"--renderer", "none"}, "--renderer");
    expect_failure(2, render + Arguments{"--up", "x"}, "--up");
    expect_failure(2, {"render", "m.binary", "-o", "x.jpg"}, "--output");
    expect_failure(2, {"render", "m.binary"}, "--output");
}

}  // namespace
}  // namespace srbf::refusal_test
