// Output of the subcommands other than fit.
#include <regex>

#include "app/map_layers.h"
#include "brdf_functions.h"
#include "command.h"
#include "models.h"
#include "models/openpbr/openpbr_kind.h"
#include "srbf/measured.h"
#include "srbf/metrics.h"
#include "srbf/model.h"

namespace srbf::command_test {
namespace {

/// Tests that use a saved random model, because a fit would take a minute under sanitizers.
class Command : public ProgramTest {
  protected:
    static void SetUpTestSuite() {
        fitted = std::make_unique<TemporaryFolder>();
        std::mt19937_64 random(1);
        const PmModel model = rounded(random_model(random, {.lobes = 2, .variates = 2, .form = PmForm::extended}));
        const auto saved = checked(
            save_model({model, {{"source", "paper_white_rgb.bsdf"}, {"objective", "cosine"}, {"max_theta", "89"}}},
                       *fitted / "m.srbf"));
    }
    static void TearDownTestSuite() { fitted.reset(); }

    /// The text that `export` writes for the surface `s.srbf`.
    std::string exported(const std::string& kind) {
        run_ok(folder, {"export", "s.srbf", "--to", kind, "-o", "o"});
        return read_text(folder / "o");
    }

    /// Converts a measurement, samples or a model, and expects a file of the given format.
    void expect_converted(const std::string& input, const std::string& output, const std::string& format) {
        Arguments convert{"convert", input, "-o", output};
        if (!output.ends_with(".csv")) convert = convert + Arguments{"--threads", "1"};
        if (output.ends_with(".csv") && !input.ends_with(".csv")) convert = convert + Arguments{"--directions", "9"};
        const ProgramRun result = run_ok(folder, convert);
        EXPECT_EQ(result.out, "");
        const auto measured = checked(load_measured(folder / output));
        EXPECT_EQ(measured->format, format) << input;
    }

    inline static std::unique_ptr<TemporaryFolder> fitted;
};

TEST_F(Command, ExportWritesAPageOrNothing) {
    SKIP_UNDER_SANITIZERS("takes too long");
    if (!is_built({"html"})) GTEST_SKIP() << "without pages";
    const Arguments page{"export", *fitted / "m.srbf", "--to", "html"};
    const ProgramRun alone = run_ok(folder, page + Arguments{"-o", "alone.html"});
    EXPECT_EQ(alone.err + alone.out, "");
    const ProgramRun both = run_ok(folder, page + Arguments{"--reference", k_paper, "-o", "both.html"});
    const std::string html = read_text(folder / "both.html");
    EXPECT_CONTAINS(html, "<title>paper_white_rgb</title>");
    // The page shows the errors that `srbf compare` reports as held out.
    const auto measured = checked(load_measured(k_paper));
    const auto model = checked(load_model(*fitted / "m.srbf"));
    const double error =
        heldout_measures(evaluator(*measured), evaluator(*model), 89 * k_degree).squared_error_ratio_cosine;
    EXPECT_CONTAINS(html, fmt::format("<td>{:.3g} %</td>", 100 * error));
    EXPECT_LT(html.size(), 3'000'000u);
    EXPECT_LT(read_text(folder / "alone.html").size(), html.size());

    write_text(folder / "broken.srbf", read_text(*fitted / "m.srbf").substr(0, 300));
    const Arguments start{"export", *fitted / "m.srbf"}, to{"--to", "html", "-o", "x.html"};
    expect_failure(1, start + Arguments{"missing.srbf"} + to, "missing.srbf");
    expect_failure(1, start + Arguments{"broken.srbf"} + to, "broken.srbf");
    expect_failure(1, start + Arguments{k_paper} + to, "expected a model, found a measurement");
    expect_failure(1, start + Arguments{"--reference", *fitted / "m.srbf"} + to,
                   "expected a measurement, found a model");
    expect_failure(1, start + Arguments{"--reference", "missing.bsdf"} + to, "missing.bsdf");
    expect_failure(1, start + Arguments{"--to", "html", "-o", "missing/x.html"}, "missing");
    expect_failure(1, start + Arguments{"--to", "html", "-o", *fitted / "m.srbf"}, "m.srbf");
    expect_failure(1, page + Arguments{"-o", "/dev/full"}, "/dev/full");
    expect_failure(2, Arguments{"export"} + to, "MODEL");
    expect_failure(2, start + Arguments{"--to", "word", "-o", "x"}, "found word");
    expect_failure(2, start + Arguments{"--to", "html"}, "--output");
    expect_failure(2, page + Arguments{"--with", "sampling", "-o", "x"}, "--with");
}

TEST_F(Command, ExportWritesCodeOrNothing) {
    SKIP_UNDER_SANITIZERS("takes too long");
    const Arguments start{"export", *fitted / "m.srbf", *fitted / "m.srbf"};
    for (const char* language : {"glsl", "hlsl", "wgsl", "msl", "c"}) {
        const Arguments to{"--to", language, "-o", std::string("two.") + language};
        const ProgramRun result = run_ok(folder, start + to);
        EXPECT_EQ(result.err + result.out, "");
        const std::string text = read_text(folder / (std::string("two.") + language));
        for (const char* name : {"m_brdf(", "m_2_brdf(", "two_pm_", "source paper_white_rgb.bsdf"})
            EXPECT_CONTAINS(text, name) << language;
    }
    const Arguments to{"--to", "c", "-o", "x.h"};
    run_ok(folder, start + to + Arguments{"--with", "sampling", "--with", "albedo"});
    for (const char* name : {"m_sample(", "m_albedo(", "m_2_sample(", "m_2_albedo("})
        EXPECT_CONTAINS(read_text(folder / "x.h"), name);
    std::filesystem::remove(folder / "x.h");
    expect_failure(1, Arguments{"export", k_paper} + to, "expected a model, found a measurement");
    expect_failure(1, start + Arguments{"--to", "c", "-o", "missing/x.h"}, "missing");
    expect_failure(1, start + Arguments{"--to", "c", "-o", "/dev/full"}, "/dev/full");
    expect_failure(2, start + to + Arguments{"--reference", k_paper}, "--reference");
    expect_failure(2, start + to + Arguments{"--with", "lobes"}, "found lobes");
}

TEST_F(Command, ExportWritesAMapOrNothing) {
    SKIP_UNDER_SANITIZERS("takes too long");
    std::mt19937_64 random(2);
    const auto save = [&](const TexelMap& map, const std::string& name) {
        write_text(folder / name, as_text(write_map(map)));
    };
    const TexelMap map = random_map(random, {.lobes = 3}, 4, 2);
    save(map, "map.srbf");
    for (const char* kind : {"glsl", "hlsl", "wgsl", "msl", "c", "ktx2", "exr", "three"}) {
        if (!is_built({kind})) continue;
        const ProgramRun result = run_ok(folder, {"export", "map.srbf", "--to", kind, "-o", std::string("o.") + kind});
        EXPECT_EQ(result.err + result.out, "");
    }
    EXPECT_CONTAINS(read_text(folder / "o.glsl"), "vec3 map_brdf(vec3 wl, vec3 wv, map_Coefficients ");
    if (is_built({"three"})) {
        EXPECT_CONTAINS(read_text(folder / "o.three"), "new URL('./map.ktx2', import.meta.url)");
        EXPECT_EQ(read_text(folder / "map.ktx2"), read_text(folder / "o.ktx2"));
    }
    const Arguments code{"--to", "c", "-o", "x.h"}, layers{"--to", "ktx2", "-o", "x.ktx2"}, start{"export", "map.srbf"};
    for (const char* numbers : {"half", "byte"})
        run_ok(folder, start + Arguments{"--to", "ktx2", "--coefficients", numbers, "-o", numbers});
    EXPECT_EQ(read_text(folder / "half"), read_text(folder / "o.ktx2"));
    EXPECT_LT(read_text(folder / "byte").size(), read_text(folder / "half").size());
    expect_failure(2, start + layers + Arguments{"--coefficients", "none"}, "--coefficients");
    expect_failure(2, start + code + Arguments{"--coefficients", "byte"}, "--coefficients");
    if (is_built({"three"}))
        expect_failure(1,
                       Arguments{"export", *fitted / "m.srbf", "--to", "three", "--coefficients", "byte", "-o", "x.js"},
                       "--coefficients");
    expect_failure(1, start + Arguments{"--to", "three", "-o", "map.ktx2"}, "map.ktx2");
    expect_failure(1, start + code + Arguments{"--with", "sampling"}, "expected values, albedos and light");
    expect_failure(1, start + Arguments{"--to", "html", "-o", "x.html"}, "map.srbf#X,Y");
    expect_failure(1, Arguments{"export", "map.srbf", "map.srbf"} + layers, "found a map of texels");
    expect_failure(1, Arguments{"export", *fitted / "m.srbf"} + layers,
                   "expected a map of shared lobes, found a model");
    expect_failure(1, Arguments{"export", "missing.srbf"} + layers, "missing.srbf");
    expect_failure(1, start + Arguments{"--to", "exr", "-o", "/dev/full"}, "/dev/full");
    expect_failure(1, start + Arguments{"--to", "exr", "-o", "map.srbf"}, "map.srbf");
    save(random_map(random, {.lobes = 1}, k_longest_side + 1, 1), "list.srbf");
    for (const Arguments& to : {code, layers})
        expect_failure(1, Arguments{"export", "list.srbf"} + to, "expected at most 16384 (srbf map --width)");
    write_text(folder / "broken.srbf", read_text(folder / "map.srbf").substr(0, 500));
    expect_failure(1, Arguments{"export", "broken.srbf"} + layers, "broken.srbf");
}

TEST_F(Command, InfoGivesOneWavelengthNoColour) {
    write_text(folder / "laser.csv",
               "theta_l_deg,theta_v_deg,phi_v_deg,532nm\n10,10,180,0.5\n10,40,180,0.2\n40,40,180,0.6\n");
    const ProgramRun result = run_ok(folder, {"info", "laser.csv"});
    EXPECT_CONTAINS(result.out, "value [1/sr]      0.2 to 0.6");
    EXPECT_CONTAINS(result.out, "  albedo ");
    for (const char* word : {"albedo R", "[1/sr] R"}) EXPECT_LACKS(result.out, word);
}

TEST_F(Command, InfoDescribesFiles) {
    const ProgramRun measured = run_ok(*fitted, {"info", k_paper}), model = run_ok(*fitted, {"info", "m.srbf"});
    for (const char* word :
         {"RGL", "658,928 bytes", "masked entries", "albedo R", "  peak ", "reciprocity error", "smallest value"})
        EXPECT_CONTAINS(measured.out, word);
    EXPECT_CONTAINS(measured.out,
                    "more light than it receives at θv = 85°\n");  // where the measurement is extrapolated
    for (const char* word : {"2 lobes × 2 variates", "paper_white_rgb.bsdf", "objective", "albedo R", "  peak "})
        EXPECT_CONTAINS(model.out, word);
}

TEST_F(Command, InfoWarnsOfAlbedosAboveOne) {
    const PmModel model = axial_gaussians({{0.1f, 0.4f, 0.2f}}, {0});  // f = 0.4, an albedo of 0.4 π
    ASSERT_TRUE(save_model({model, {}}, folder / "bright.srbf").ok());
    const ProgramRun info = run_ok(folder, {"info", "bright.srbf"});
    for (const char* word : {"1.256", "warning", "more light than it receives at θv = 0°, 15°", "reciprocity error 0 %",
                             "smallest value    0.09998 1/sr"})
        EXPECT_CONTAINS(info.out, word);
}

TEST_F(Command, EvalKeepsOrderAndTextOfRows) {
    const auto model = checked(load_model(*fitted / "m.srbf"));
    // Columns in another order, additional columns, quotes, a byte-order mark, CRLF, and no newline at the end.
    write_text(folder / "pairs.csv",
               "\xef\xbb\xbfnote,\"wv_z\",wv_y,wv_x, wl_x ,wl_y,wl_z,r\r\n"
               "\"a, b\",1.0,0,0.000,6e-1,+0,0.8,x\r\n"
               "\r\n"
               ",\"0.8\",-.6,0,0,0,1,\r\n"
               "below,1,0,0,0.6,0,-0.8,7");
    const ProgramRun eval = run_ok(folder, {"eval", *fitted / "m.srbf", "--pairs", "pairs.csv"});
    const auto row = [&](const char* text, Vec3f wl, Vec3f wv) {
        Rgb f;
        evaluate(*model, {&wl, 1}, {&wv, 1}, {&f, 1});
        return fmt::format("{},{:.9g},{:.9g},{:.9g}\n", text, f.r, f.g, f.b);
    };
    EXPECT_EQ(eval.out, std::string("wl_x,wl_y,wl_z,wv_x,wv_y,wv_z,r,g,b\n") +
                            row("6e-1,+0,0.8,0.000,0,1.0", {0.6f, 0, 0.8f}, {0, 0, 1}) +
                            row("0,0,1,0,-.6,0.8", {0, 0, 1}, {0, -0.6f, 0.8f}) + "0.6,0,-0.8,0,0,1,0,0,0\n");
}

TEST_F(Command, EvalNamesTheLineAtFault) {
    const std::string header = "wl_x,wl_y,wl_z,wv_x,wv_y,wv_z\n", good = "0,0,1,0,0,1\n";
    struct Case {
        std::string csv, expected;
    };
    for (const auto& [csv, expected] : {Case{"", "pairs.csv: line 1"},
                                        {"wl_x,wl_y,wl_z,wv_x,wv_y\n", "line 1: header"},
                                        {header + good + "0,0,one,0,0,1\n", "line 3: column wl_z"},
                                        {header + good + good + "0,0,1,0,0\n", "line 4: column wv_z"},
                                        {header + "0,0,1,0,0,nan\n", "line 2: column wv_z"},
                                        {header + "0,0,1,0,0,1e999\n", "line 2: column wv_z"},
                                        {header + "0,0,1,0,0.2,1\n", "line 2: direction wv"}}) {
        write_text(folder / "pairs.csv", csv);
        expect_failure(1, {"eval", *fitted / "m.srbf", "--pairs", "pairs.csv"}, expected);
    }
    expect_failure(1, {"eval", *fitted / "m.srbf", "--pairs", "none.csv"}, "none.csv");
}

TEST_F(Command, HelpShowsAnExample) {
    std::vector<Arguments> commands{{}, {"completion"}};
    for (const auto& [sub, options] : long_options(folder)) commands.push_back({sub});
    EXPECT_GE(commands.size(), 9u);
    for (const Arguments& command : commands) {
        const ProgramRun help = run_ok(folder, command + Arguments{"--help"});
        EXPECT_EQ(help.err, "");
        EXPECT_CONTAINS(help.out, "Example");
        EXPECT_CONTAINS(help.out, "\n  srbf ");
    }
    const ProgramRun version = run_ok(folder, {"--version"});
    EXPECT_TRUE(version.out.starts_with("srbf 0.")) << version.out;
}

TEST_F(Command, CompletionsAndTheManualAgreeWithHelp) {
    const ProgramRun manual = run_ok(folder, {"--help-all"}), bash = run_ok(folder, {"completion", "bash"});
    const std::regex option("  (-[a-z-]+)[ ,{]");
    for (const auto& [sub, options_of_sub] : long_options(folder)) {
        const std::string help = run_srbf(folder, {sub, "--help"}).out;
        // help2man turns this line into a section. "Options:" would become the section of the program's own options.
        const auto section = manual.out.find(fmt::format("\n*srbf {}*\n\n", sub));
        ASSERT_NE(section, std::string::npos) << sub;
        EXPECT_EQ(manual.out.find("\nOptions:", section), std::string::npos) << sub;
        std::size_t options = 0;
        for (std::sregex_iterator match(help.begin(), help.end(), option), end; match != end; ++match, ++options) {
            const std::string name = (*match)[1];
            EXPECT_CONTAINS(bash.out, name) << sub;
            EXPECT_NE(manual.out.find(name, section), std::string::npos) << sub << " " << name;
        }
        EXPECT_GE(options, 1u) << help;
    }
    for (const char* shell : {"zsh", "fish"}) {
        const ProgramRun completion = run_ok(folder, {"completion", shell});
        EXPECT_CONTAINS(completion.out, "max-memory") << shell;
    }
    expect_failure(2, {"completion", "csh"}, "found csh");

    // The completions that bash offers.
    write_text(folder / "completion", bash.out);
    write_text(folder / "ask",
               "source ./completion; COMP_WORDS=(\"$@\"); COMP_CWORD=$(($# - 1)); _srbf; echo \"${COMPREPLY[@]}\"");
    const auto offered = [&](const std::string& words) {
        FILE* pipe = popen(fmt::format("cd {} && bash ask srbf {} 2>&1", folder.path.string(), words).c_str(), "r");
        std::string text(200, '\0');
        text.resize(std::fread(text.data(), 1, text.size(), pipe));
        pclose(pipe);
        return text;
    };
    EXPECT_TRUE(offered("re").starts_with("render"));
    EXPECT_EQ(offered("ex"), "export\n");
    EXPECT_EQ(offered("fit --model ''"), "pm su ggx openpbr gltf principled\n");
    EXPECT_EQ(offered("fit --ob"), "--objective\n");
    EXPECT_EQ(offered("--max"), "--max-memory\n");
    EXPECT_EQ(offered("--max-memory ''"), "\n");
    EXPECT_EQ(offered("--max-memory 500 ex"), "export\n");
    EXPECT_EQ(offered("--max-memory 500 fit --ob"), "--objective\n");
    EXPECT_EQ(offered("fit pap"), "\n");  // a file: bash's own completion
}

TEST_F(Command, ConvertCopiesAndConverts) {
    SKIP_UNDER_SANITIZERS("takes too long");
    // A file already in that format is copied byte for byte.
    const std::string merl = small_merl();
    write_text(folder / "m.binary", merl);
    write_text(folder / "s.csv", std::string(k_small_csv));
    run_ok(folder, {"convert", "m.binary", "-o", "copy.binary"});
    EXPECT_EQ(read_text(folder / "copy.binary"), merl);
    run_ok(folder, {"convert", k_paper, "-o", "paper.bsdf"});
    EXPECT_EQ(read_text(folder / "paper.bsdf"), read_text(k_paper));
    expect_converted(k_paper, "o.bsdf", "RGL");
    expect_converted(k_paper, "o.csv", "CSV");
    expect_converted("s.csv", "o.bsdf", "RGL");
    expect_converted("s.csv", "o.mbsdf", "MBSDF");
    expect_converted("s.csv", "o.csv", "CSV");
}

TEST_F(Command, SurfacesAreExportedForOtherPrograms) {
    OpenPbrModel surface{.base_color = {0.9f, 0.6f, 0.3f}, .base_metalness = 1, .specular_roughness = 0.2f};
    surface.coat_weight = 1;
    surface.coat_roughness = 0.5f;
    surface.thin_film_weight = 0.5f;
    surface.thin_film_thickness = 0.25f;
    ASSERT_TRUE(save_model({rounded(surface), {{"source", "a--b.bsdf"}}}, folder / "s.srbf").ok());
    const std::string openpbr = exported("mtlx"), standard = exported("standard-surface"),
                      script = exported("principled");
    EXPECT_CONTAINS(openpbr, "name=\"thin_film_thickness\" type=\"float\" value=\"0.25\"");
    EXPECT_CONTAINS(openpbr, "name=\"specular_roughness\" type=\"float\" value=\"0.199951\"");
    EXPECT_CONTAINS(standard, "name=\"thin_film_thickness\" type=\"float\" value=\"250\"");
    EXPECT_CONTAINS(script, "\"Thin Film Thickness\": 250,");
    EXPECT_CONTAINS(exported("usd"), "inputs:thin_film_weight = 0.5");

    // The script does not change variables of the script that runs it. A replacement for Blender's module records
    // the requests.
    write_text(folder / "s.py", script);
    write_text(folder / "bpy.py",
               "from collections import defaultdict\nfrom types import SimpleNamespace as Object\n"
               "node, made = Object(type='BSDF_PRINCIPLED', inputs=defaultdict(Object)), []\n"
               "data = Object(materials=Object(new=lambda name: made.append(name) or "
               "Object(node_tree=Object(nodes=[node]))))\n");
    write_text(folder / "caller.py",
               "import bpy as module\nsys = bpy = node = name = value = material = 'own'\n"
               "exec(open('s.py').read())\n"
               "assert {sys, bpy, node, name, value, material} == {'own'}\n"
               "assert module.made == ['s'] and module.node.inputs['Thin Film Thickness'].default_value == 250\n");
    if (std::system("python3 -c '' > /dev/null 2>&1") == 0) {
        EXPECT_EQ(std::system(fmt::format("cd '{}' && python3 -B caller.py", folder.path.string()).c_str()), 0);
    }

    const Json gltf = Json::parse(exported("gltf"));
    const Json& material = gltf["materials"][0];
    EXPECT_EQ(material["extensions"]["KHR_materials_iridescence"]["iridescenceThicknessMaximum"], 250);
    // The coat widens the highlight of the base, as coats of other programs do not: (0.2⁴ + 2 · 0.5⁴)^(1/4).
    EXPECT_WITHIN(material["pbrMetallicRoughness"]["roughnessFactor"].get<double>(), 0.5955, 1e-3);

    // Binary glTF has a header, the text, and the same binary data as the other file.
    const std::string glb = exported("glb");
    const auto uint32_at = [&](std::size_t offset) {
        std::uint32_t x = 0;
        for (int k = 3; k >= 0; --k) x = 256 * x + std::uint8_t(glb[offset + std::size_t(k)]);
        return x;
    };
    ASSERT_GT(glb.size(), 28u);
    EXPECT_EQ(glb.substr(0, 4), "glTF");
    EXPECT_EQ(uint32_at(4), 2u);
    EXPECT_EQ(uint32_at(8), glb.size());
    const std::size_t text_length = uint32_at(12);
    EXPECT_EQ(glb.substr(16, 4), "JSON");
    const Json json = Json::parse(glb.substr(20, text_length));
    EXPECT_EQ(json["materials"], gltf["materials"]);
    EXPECT_EQ(text_length % 4, 0u);
    EXPECT_EQ(uint32_at(20 + text_length), json["buffers"][0]["byteLength"]);
    EXPECT_EQ(glb.size(), 28 + text_length + uint32_at(20 + text_length));
}

/// Facets that are rougher along the tangent than across it, written for the other programs.
TEST_F(Command, AnisotropicSurfacesAreExportedForOtherPrograms) {
    OpenPbrModel surface{.base_metalness = 1, .specular_roughness = 0.5f};
    surface.specular_roughness_anisotropy = 0.5f;
    surface.specular_rotation = 0.125f;
    ASSERT_TRUE(save_model({surface, {}}, folder / "s.srbf").ok());
    const std::string openpbr = exported("mtlx"), usd = exported("usd"), script = exported("principled");
    EXPECT_CONTAINS(openpbr, "name=\"amount\" type=\"float\" value=\"-45\"");
    EXPECT_CONTAINS(openpbr, "name=\"geometry_tangent\"");
    EXPECT_CONTAINS(usd, "inputs:geometry_tangent.connect");
    // α along the tangent is .25 √(2 / 1.25) = .316228, and half of it across.
    EXPECT_CONTAINS(script, "\"Roughness\": 0.472871,") << script;    // the square root of √(.316228 · .158114)
    EXPECT_CONTAINS(script, "\"Anisotropic\": 0.555556,") << script;  // (1 − ½) / .9

    const Json gltf = Json::parse(exported("gltf"));
    const Json& material = gltf["materials"][0];
    const Json& anisotropy = material["extensions"]["KHR_materials_anisotropy"];
    const double roughness = material["pbrMetallicRoughness"]["roughnessFactor"].get<double>(),
                 strength = anisotropy["anisotropyStrength"].get<double>(), across = roughness * roughness;
    EXPECT_WITHIN(across, 0.158114, 1e-5);
    EXPECT_WITHIN(across + strength * strength * (1 - across), 0.316228, 1e-5);
    EXPECT_WITHIN(anisotropy["anisotropyRotation"].get<double>(), k_pi / 4, 1e-5);
    const Json& tangents =
        gltf["accessors"][gltf["meshes"][0]["primitives"][0]["attributes"]["TANGENT"].get<std::size_t>()];
    EXPECT_EQ(tangents["count"], gltf["accessors"][0]["count"]);
    std::size_t bytes = 0;
    for (const Json& view : gltf["bufferViews"]) bytes += view["byteLength"].get<std::size_t>();
    EXPECT_EQ(bytes, gltf["buffers"][0]["byteLength"].get<std::size_t>());
}

/// A file with transmission is read as a BSDF, and copied unchanged.
TEST_F(Command, MbsdfFilesAreReadWithTheirTransmission) {
    SKIP_UNDER_SANITIZERS("takes too long");
    write_text(folder / "t.mbsdf", as_text(grey_mbsdf()));
    write_text(folder / "r.mbsdf", as_text(small_mbsdf()));
    for (const Arguments& output : {Arguments{"o.csv", "--directions", "3"}, {"copy.mbsdf"}}) {
        const ProgramRun result = run_ok(folder, Arguments{"convert", "t.mbsdf", "-o"} + output);
        EXPECT_EQ(result.err, "");
    }
    EXPECT_EQ(read_text(folder / "copy.mbsdf"), as_text(grey_mbsdf()));
    const ProgramRun with = run_srbf(folder, {"info", "t.mbsdf"}), without = run_srbf(folder, {"info", "r.mbsdf"});
    EXPECT_EQ(with.err, "");
    EXPECT_CONTAINS(with.out, "transmission_front\n");
    EXPECT_CONTAINS(with.out, "dimensions        2 θl × 2 θv × 3 φ, grey\n");
    EXPECT_EQ(without.err, "");
    EXPECT_CONTAINS(without.out, "material          blue \"paint\"\n");
    // Anisotropic measurements are rejected.
    write_text(folder / "a.bsdf", as_text(tensor_file(anisotropic_rgl())));
    expect_failure(1, {"convert", "a.bsdf", "-o", "a.mbsdf"},
                   "an isotropic BRDF, as MBSDF tables are, found an anisotropic one");
}

}  // namespace
}  // namespace srbf::command_test
