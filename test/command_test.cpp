#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "measured_files.h"
#include "program.h"
#include "properties.h"
#include "srbf/file.h"
#include "srbf/measured.h"
#include "srbf/metrics.h"
#include "srbf/model.h"

namespace srbf {
namespace {

using Json = nlohmann::json;
using Arguments = std::vector<std::string>;

const std::string k_paper = bundled_data() / "paper_white_rgb.bsdf";
const Arguments k_measures{"squared_error_ratio", "squared_error_ratio_cosine", "log_rms_cosine",
                           "cube_root_error_ratio"};

Arguments operator+(Arguments a, const Arguments& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

std::string text_of(const Bytes& bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

/// A MERL file of a smooth glossy material.
std::string small_merl() {
    return text_of(merl_file({9, 6, 8}, [](int h, int, int, int c) { return 0.1 + std::exp(-h) * (1 + c); }));
}

/// One small fit of bundled data that several tests look at.
class Command : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        fitted = std::make_unique<TemporaryFolder>();
        first = run(*fitted, {"fit", k_paper, "-o", "m.srbf", "--lobes", "2", "--variates", "2", "--threads", "1",
                              "--preview", "p.png", "--json", "r.json"});
    }
    static void TearDownTestSuite() { fitted.reset(); }
    static Json report() { return Json::parse(contents(*fitted / "r.json"), nullptr, false); }

    /// Runs in `folder`, expects `status`, one line on standard error that holds `named`, and nothing else.
    void expect_failure(int status, const Arguments& arguments, const std::string& named, std::string out = {}) {
        SCOPED_TRACE(fmt::format("{}", fmt::join(arguments, " ")));
        const auto before = folder.files();
        const ProgramRun failed = run(folder, arguments, std::move(out));
        EXPECT_EQ(failed.status, status);
        EXPECT_EQ(failed.out, "");
        EXPECT_TRUE(failed.err.starts_with("srbf: ")) << failed.err;
        EXPECT_EQ(failed.err.find('\n'), failed.err.size() - 1) << failed.err;
        EXPECT_NE(failed.err.find(named), std::string::npos) << failed.err;
        EXPECT_EQ(folder.files(), before);
    }

    TemporaryFolder folder;
    static std::unique_ptr<TemporaryFolder> fitted;
    static ProgramRun first;
};
std::unique_ptr<TemporaryFolder> Command::fitted;
ProgramRun Command::first;

TEST_F(Command, fit_writes_model_picture_and_report) {
    ASSERT_EQ(first.status, 0) << first.err;
    EXPECT_EQ(first.err, "");  // progress is for a terminal
    EXPECT_EQ(fitted->files().size(), 3u);
    EXPECT_TRUE(contents(*fitted / "p.png").starts_with("\x89PNG\r\n\x1a\n"));
    const auto model = load_model(*fitted / "m.srbf");
    ASSERT_TRUE(model) << message(model.error());
    const PmModel& pm = std::get<PmModel>(model->model);

    const Json json = report();
    ASSERT_TRUE(json.is_object());
    const Json expected = Json::parse(R"({"model": "pm", "form": "extended", "lobes": 2, "variates": 2, "axial": true,
        "channels": 3, "objective": "cosine", "max_theta": 89.0, "raw_bytes": 28311552, "auxiliary_bytes": 0, "seed": 0,
        "threads": 1, "masked_samples": 0, "clamped_samples": 0})");
    EXPECT_EQ(json.value("payload_bytes", std::size_t(0)), payload_bytes(pm));
    for (const auto& [key, value] : expected.items()) EXPECT_EQ(json.value(key, Json()), value) << key;
    EXPECT_GT(json.value("fit_seconds", 0.0), 0.0);
    EXPECT_GT(json.value("load_seconds", 0.0), 0.0);
    EXPECT_NE(json.value("stop_reason", ""), "");
    for (const std::string prefix : {"", "unrounded_"}) {
        Arguments names{"albedo_error"};
        for (const std::string& name : k_measures) names = names + Arguments{name, "heldout_" + name};
        for (const std::string& name : names) {
            const double error = json.value(prefix + name, -1.0);
            EXPECT_TRUE(std::isfinite(error) && error > 0 && error < 0.5) << prefix << name << ' ' << error;
        }
    }
}

TEST_F(Command, fit_stores_eight_lobes_of_four_variates_by_default) {
    write(folder / "small.binary", small_merl());
    const ProgramRun fit = run(folder, {"fit", "small.binary", "--form", "source", "--json", "-"});
    ASSERT_EQ(fit.status, 0) << fit.err;
    const Json json = Json::parse(fit.out, nullptr, false);
    EXPECT_EQ(json.value("lobes", 0), 8);
    EXPECT_EQ(json.value("variates", 0), 4);
    const auto model = load_model(folder / "small.srbf");
    ASSERT_TRUE(model);
    EXPECT_EQ(json.value("payload_bytes", 0), has_log_scale(std::get<PmModel>(model->model)) ? 144 : 128);
}

TEST_F(Command, fit_does_not_depend_on_threads_but_on_the_seed) {
    write(folder / "paper_white_rgb.srbf", "what was here before");
    const Arguments fit{"fit", k_paper, "--lobes", "2", "--variates", "2"};
    const ProgramRun second = run(folder, fit + Arguments{"--threads", "2", "--json", "-"});
    ASSERT_EQ(second.status, 0) << second.err;
    EXPECT_EQ(second.err, "");
    const auto files = folder.files();
    EXPECT_EQ(files.size(), 1u);  // the default name, in the working directory
    EXPECT_EQ(files.begin()->second, contents(*fitted / "m.srbf"));

    Json ours = Json::parse(second.out, nullptr, false), theirs = report();  // standard output is JSON and nothing else
    ASSERT_TRUE(ours.is_object());
    for (const char* key : {"threads", "output", "fit_seconds", "load_seconds"}) ours.erase(key), theirs.erase(key);
    EXPECT_EQ(ours, theirs);

    ASSERT_EQ(run(folder, fit + Arguments{"--seed", "1", "-o", "seed.srbf"}).status, 0);
    const auto a = load_model(*fitted / "m.srbf"), b = load_model(folder / "seed.srbf");
    ASSERT_TRUE(a && b);
    EXPECT_NE(std::get<PmModel>(a->model), std::get<PmModel>(b->model));
}

TEST_F(Command, export_writes_a_page_or_nothing) {
    const Arguments page{"export", *fitted / "m.srbf", "--to", "html"};
    const ProgramRun alone = run(folder, page + Arguments{"-o", "alone.html"});
    EXPECT_EQ(alone.status, 0) << alone.err;
    EXPECT_EQ(alone.err + alone.out, "");
    const ProgramRun both = run(folder, page + Arguments{"--reference", k_paper, "-o", "both.html"});
    EXPECT_EQ(both.status, 0) << both.err;
    const std::string html = contents(folder / "both.html");
    EXPECT_NE(html.find("<title>paper_white_rgb</title>"), html.npos);
    // The figures are those that `srbf compare` calls held out.
    const auto measured = load_measured(k_paper);
    const auto model = load_model(*fitted / "m.srbf");
    ASSERT_TRUE(measured && model);
    const Evaluate others[] = {evaluator(*model)};
    const double error =
        measure_heldout(evaluator(*measured), others, {89 * k_degree, 0})[0].squared_error_ratio_cosine;
    EXPECT_NE(html.find(fmt::format("<td>{:.3g} %</td>", 100 * error)), html.npos);
    EXPECT_LT(html.size(), 3'000'000u);
    EXPECT_LT(contents(folder / "alone.html").size(), html.size());

    write(folder / "broken.srbf", contents(*fitted / "m.srbf").substr(0, 300));
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
    expect_failure(2, start + Arguments{"--to", "word", "-o", "x"}, "expected html, found word");
    expect_failure(2, start + Arguments{"--to", "html"}, "--output");
}

/// `count` samples of a smooth BRDF at random directions, as CSV.
std::string smooth_samples(int count) {
    std::mt19937_64 random(3);
    std::string csv = "# isotropic\nwl_x,wl_y,wl_z,wv_x,wv_y,wv_z,r,g,b\n";
    for (int i = 0; i < count; ++i) {
        const auto draw = [&] {
            const double u1 = uniform(random), u2 = uniform(random);
            return spherical(std::acos(1 - 0.8 * u1), 2 * k_pi * u2);
        };
        const Vec3d l = draw(), v = draw();
        const double f = 0.2 + 0.3 * dot(l, v) * dot(l, v);
        csv += fmt::format("{},{},{},{},{},{},{},{},{}\n", l.x, l.y, l.z, v.x, v.y, v.z, f, 0.5 * f, 0.2);
    }
    return csv;
}

TEST_F(Command, fit_chooses_the_lobes_of_scattered_samples) {
    write(folder / "samples.csv", smooth_samples(60));
    const ProgramRun fit = run(folder, {"fit", "samples.csv", "--variates", "1", "--form", "source", "--objective",
                                        "raw", "--max-theta", "70", "--json", "-"});
    ASSERT_EQ(fit.status, 0) << fit.err;
    const Json json = Json::parse(fit.out, nullptr, false);
    EXPECT_EQ(json.value("folds", 0), 5);
    EXPECT_LT(json.value("heldout_squared_error_ratio", 1.0), 0.1);
    EXPECT_GE(json.value("heldout_squared_error_ratio", 0.0), json.value("squared_error_ratio", 1.0));
    // The path holds the model that was taken: the smallest of those that err hardly more than the best.
    ASSERT_TRUE(json.contains("path") && json["path"].size() > 1);
    double least = 1;
    for (const Json& step : json["path"]) least = std::min(least, step.value("error", 1.0));
    for (const Json& step : json["path"]) {
        const bool good = step.value("error", 1.0) <= 1.03 * least;
        if (step.value("lobes", 0) <= json.value("lobes", 0)) {
            EXPECT_EQ(good, step.value("lobes", 0) == json.value("lobes", 0)) << step;
        }
    }
    EXPECT_EQ(run(folder, {"compare", "samples.csv", "samples.srbf"}).status, 0);
}

TEST_F(Command, fit_ggx_is_a_model_as_the_others) {
    const ProgramRun fit =
        run(folder, {"fit", k_paper, "--model", "ggx", "--lobes", "2", "-o", "g.srbf", "--json", "-"});
    ASSERT_EQ(fit.status, 0) << fit.err;
    const Json json = Json::parse(fit.out, nullptr, false);
    EXPECT_EQ(json.value("payload_bytes", 0), 26);
    EXPECT_EQ(json.value("model", ""), "ggx");
    EXPECT_LT(json.value("heldout_squared_error_ratio_cosine", 1.0), 0.01);
    const ProgramRun compare = run(folder, {"compare", k_paper, "g.srbf", "--max-theta", "89", "--json", "-"});
    ASSERT_EQ(compare.status, 0) << compare.err;
    EXPECT_EQ(Json::parse(compare.out, nullptr, false).value("heldout_squared_error_ratio_cosine", 1.0),
              json.value("heldout_squared_error_ratio_cosine", 0.0));
    EXPECT_NE(run(folder, {"info", "g.srbf"}).out.find("Lambert and GGX"), std::string::npos);
}

/// Smooth samples at five wavelengths, as Cornell's files have them.
std::string smooth_spectra() {
    std::string text = "5\n400 450.5 500 600 700\n";
    for (int l = 0; l <= 70; l += 10)
        for (int v = 5; v <= 75; v += 10)
            for (int p = 0; p <= 180; p += 30) {
                text += fmt::format("{} 0 {} {}", l * k_degree, v * k_degree, p * k_degree);
                const Vec3d h = normalize(spherical(l * k_degree, 0.0) + spherical(v * k_degree, p * k_degree));
                const double gloss = std::exp(-12 * (1 - h.z));
                for (int c = 0; c < 5; ++c) text += fmt::format(" {:.6f}", 0.02 * (c + 1) + 0.3 * gloss);
                text += '\n';
            }
    return text;
}

TEST_F(Command, fit_takes_spectra) {
    write(folder / "s.brdf", smooth_spectra());
    const ProgramRun fit = run(folder, {"fit", "s.brdf", "--channels", "spectral", "--lobes", "2", "--variates", "2",
                                        "--objective", "raw", "--max-theta", "75", "--json", "-"});
    ASSERT_EQ(fit.status, 0) << fit.err;
    const Json json = Json::parse(fit.out, nullptr, false);
    EXPECT_EQ(json.value("channels", 0), 5);
    EXPECT_EQ(json.value("payload_bytes", 0), 2 * (2 * (5 + 2 + 1 + 4) + 4));
    EXPECT_EQ(json.value("raw_bytes", 0), 8 * 8 * 7 * 5 * 4);
    EXPECT_LT(json.value("squared_error_ratio", 1.0), 0.02);
    EXPECT_LT(json.value("heldout_squared_error_ratio", 1.0), 0.03);
    EXPECT_NE(run(folder, {"info", "s.srbf"}).out.find("5, 400 to 700 nm"), std::string::npos);

    // Spectra of the model unless colours are asked for, of the measurement where they are.
    write(folder / "p.csv", "wl_x,wl_y,wl_z,wv_x,wv_y,wv_z\n0,0,1,0.6,0,0.8\n0.6,0,0.8,-0.6,0,0.8\n");
    const std::string directions = "wl_x,wl_y,wl_z,wv_x,wv_y,wv_z", nm = ",400nm,450.5nm,500nm,600nm,700nm\n";
    for (const Arguments& arguments :
         {Arguments{"s.srbf"}, {"s.srbf", "--channels", "spectral"}, {"s.brdf", "--channels", "spectral"}}) {
        const ProgramRun eval = run(folder, Arguments{"eval", "--pairs", "p.csv"} + arguments);
        ASSERT_EQ(eval.status, 0) << eval.err;
        EXPECT_TRUE(eval.out.starts_with(directions + nm)) << eval.out;
        // What is written is a measurement at wavelengths again.
        const auto samples = read_csv(as_bytes(eval.out), "e");
        ASSERT_TRUE(samples.ok());
        ASSERT_EQ(samples->spectrum.size(), 10u);
        for (std::size_t c = 0; c < 5; ++c)
            EXPECT_PRED3(near, samples->spectrum[5 + c], 0.02 * double(c + 1) + 0.3, 0.06) << c;
    }
    for (const Arguments& arguments : {Arguments{"s.brdf"}, {"s.srbf", "--channels", "rgb"}}) {
        const ProgramRun eval = run(folder, Arguments{"eval", "--pairs", "p.csv"} + arguments);
        EXPECT_TRUE(eval.out.starts_with(directions + ",r,g,b\n")) << eval.out;
    }
}

TEST_F(Command, spectra_of_colours_are_refused) {
    write(folder / "p.csv", "wl_x,wl_y,wl_z,wv_x,wv_y,wv_z\n0,0,1,0,0,1\n");
    write(folder / "c.csv", "wl_x,wl_y,wl_z,wv_x,wv_y,wv_z,value\n0,0,1,0,0,1,1\n");
    for (const std::string& file : {k_paper, std::string("c.csv")}) {
        expect_failure(1, {"fit", file, "--channels", "spectral"}, "expected a measurement at wavelengths");
        expect_failure(1, {"eval", file, "--pairs", "p.csv", "--channels", "spectral"}, "found one of colours");
    }
    for (const char* model : {"su", "ggx"})
        expect_failure(2, {"fit", k_paper, "--channels", "spectral", "--model", model},
                       "spectral only with --model pm");
    expect_failure(2, {"fit", k_paper, "--channels", "spectral", "--budget", "160"}, "only with --channels rgb");
}

TEST_F(Command, fit_keeps_a_budget) {
    const ProgramRun fit = run(folder, {"fit", k_paper, "--budget", "20", "-o", "b.srbf", "--json", "-"});
    ASSERT_EQ(fit.status, 0) << fit.err;
    const Json json = Json::parse(fit.out, nullptr, false);
    EXPECT_LE(json.value("payload_bytes", 99), 20);
    EXPECT_TRUE(json.value("reached", false));
    EXPECT_GE(json["path"].size(), 3u);
}

TEST_F(Command, fit_su_takes_scattered_samples) {
    write(folder / "samples.csv", smooth_samples(600));
    const ProgramRun fit = run(folder, {"fit", "samples.csv", "--model", "su", "--lobes", "3", "--directions", "96",
                                        "--objective", "raw", "--max-theta", "70", "--json", "-"});
    ASSERT_EQ(fit.status, 0) << fit.err;
    const Json json = Json::parse(fit.out, nullptr, false);
    // Interpolation's part is the larger one: the samples are 10° apart.
    EXPECT_LT(json.value("squared_error_ratio", 1.0), 0.02);
    EXPECT_GT(json.value("squared_error_ratio", 0.0), 0.0);
    EXPECT_LT(json.value("heldout_squared_error_ratio", 1.0), 0.03);
    EXPECT_EQ(json.value("folds", 0), 5);
}

TEST_F(Command, fit_su_writes_a_model_that_the_others_read) {
    const Arguments fit{"fit", k_paper, "--model", "su", "--directions", "200", "--lobes", "2", "--objective", "raw"};
    const ProgramRun done =
        run(folder, fit + Arguments{"-o", "su.srbf", "--with-index", "parabolic", "--json", "r.json"});
    ASSERT_EQ(done.status, 0) << done.err;
    const Json json = Json::parse(contents(folder / "r.json"), nullptr, false);
    const Json expected = Json::parse(R"({"model": "su", "form": "source", "lobes": 2, "variates": 1, "axial": false,
        "discretise": "view", "directions": 200, "interpolation": "rotated", "index": "parabolic", "channels": 3,
        "objective": "raw", "max_theta": 80.0, "raw_bytes": 480000, "payload_bytes": 4800, "auxiliary_bytes": 1050176,
        "masked_samples": 0, "clamped_samples": 0, "empty_directions": 0})");
    for (const auto& [key, value] : expected.items()) EXPECT_EQ(json.value(key, Json()), value) << key;
    EXPECT_GT(json.value("fit_seconds", 0.0), 0.0);

    const auto model = load_model(folder / "su.srbf");
    ASSERT_TRUE(model) << message(model.error());
    const SuModel& su = std::get<SuModel>(model->model);
    EXPECT_EQ(su.index, index_texture(su, DirectionMap::parabolic));

    const ProgramRun compared = run(folder, {"compare", k_paper, "su.srbf", "--json", "-"});
    ASSERT_EQ(compared.status, 0) << compared.err;
    const Json measures = Json::parse(compared.out, nullptr, false);
    for (const std::string& name : k_measures)
        for (const std::string& key : {name, "heldout_" + name}) {
            EXPECT_EQ(measures.value(key, -1.0), json.value(key, -2.0)) << key;
            EXPECT_TRUE(near_relative(json.value("unrounded_" + key, -1.0), json.value(key, -2.0), 0.02)) << key;
        }
    EXPECT_EQ(measures.value("pairs", 0), 165 * 165);  // of 200 directions those within 80 degrees

    const ProgramRun info = run(folder, {"info", "su.srbf"});
    EXPECT_EQ(info.status, 0);
    for (const char* word : {"2 lobes × 200 sampled directions", "4,800 bytes", "parabolic", "albedo R"})
        EXPECT_NE(info.out.find(word), std::string::npos) << word;

    write(folder / "pairs.csv", "wl_x,wl_y,wl_z,wv_x,wv_y,wv_z\n0,0.6,0.8,0,0,1\n");
    const ProgramRun eval = run(folder, {"eval", "su.srbf", "--pairs", "pairs.csv"});
    EXPECT_EQ(eval.status, 0);
    std::vector<Rgb> f(1);
    const Vec3f wl[] = {{0, 0.6f, 0.8f}}, wv[] = {{0, 0, 1}};
    evaluator (*model)(wl, wv, f);
    EXPECT_NE(eval.out.find(fmt::format("0,0,1,{:.9g},{:.9g},{:.9g}\n", f[0].r, f[0].g, f[0].b)), std::string::npos)
        << eval.out;

    // Without the texture, by light, and with the interpolation of the source.
    const Arguments otherwise{"-o",           "light.srbf", "--discretise", "light", "--interpolation", "plain",
                              "--neighbours", "4",          "--between",    "0"};
    ASSERT_EQ(run(folder, fit + otherwise).status, 0);
    const auto by_light = load_model(folder / "light.srbf");
    ASSERT_TRUE(by_light);
    EXPECT_EQ(std::get<SuModel>(by_light->model).discretise, Discretise::light);
    EXPECT_EQ(std::get<SuModel>(by_light->model).interpolation, SuInterpolation::plain);
    EXPECT_EQ(std::get<SuModel>(by_light->model).neighbours, 4);
    EXPECT_FALSE(std::get<SuModel>(by_light->model).index);

    // As many lobes as there are directions within 80 degrees, and one more.
    expect_failure(1, {"fit", k_paper, "--model", "su", "--directions", "16", "--lobes", "14", "--objective", "raw"},
                   "paper_white_rgb.bsdf: directions with data in sampled view 0: expected none or at least 14");
    write(folder / "zero.binary", text_of(merl_file({9, 6, 8}, [](auto...) { return 0; })));
    expect_failure(1, {"fit", "zero.binary", "--model", "su", "--directions", "64"}, "zero.binary: values");
    expect_failure(2, fit + Arguments{"--variates", "2"}, "--variates: only with --model pm");
    expect_failure(2, {"fit", k_paper, "--with-index", "cube"}, "--with-index: only with --model su");
    expect_failure(2, fit + Arguments{"--neighbours", "8"}, "--neighbours");
    expect_failure(2, fit + Arguments{"--between", "-1"}, "--between");
    for (const char* directions : {"7", "8193", "x"})
        expect_failure(2, {"fit", k_paper, "--model", "su", "--directions", directions}, "--directions");
}

TEST_F(Command, compare_finds_the_errors_that_fit_reports) {
    const Json fit = report();
    for (const Arguments& theta : {Arguments{}, Arguments{"--max-theta", "89"}}) {
        const ProgramRun compared =
            run(*fitted, Arguments{"compare", k_paper, "m.srbf", "--json", "-", "--threads", "2"} + theta);
        ASSERT_EQ(compared.status, 0) << compared.err;
        const Json json = Json::parse(compared.out, nullptr, false);
        EXPECT_EQ(json.value("albedo_error", -1.0), fit.value("albedo_error", -2.0));
        for (const std::string& name : k_measures)
            for (const std::string& key : {name, "heldout_" + name})
                EXPECT_EQ(json.value(key, -1.0), fit.value(key, -2.0)) << key;
    }
}

TEST_F(Command, compare_of_a_file_with_itself_is_zero) {
    write(folder / "small.binary", small_merl());
    ASSERT_EQ(run(folder, {"compare", "small.binary", "small.binary", "--json", "r.json"}).status, 0);
    const Json json = Json::parse(contents(folder / "r.json"), nullptr, false);
    EXPECT_EQ(json.value("albedo_error", -1.0), 0.0);
    EXPECT_EQ(json.value("max_theta", -1.0), 80.0);
    for (const std::string& name : k_measures)
        for (const std::string& key : {name, "heldout_" + name}) EXPECT_EQ(json.value(key, -1.0), 0.0) << key;
}

TEST_F(Command, info_tells_what_a_file_is) {
    const ProgramRun measured = run(*fitted, {"info", k_paper}), model = run(*fitted, {"info", "m.srbf"});
    EXPECT_EQ(measured.status + model.status, 0) << measured.err << model.err;
    for (const char* word :
         {"RGL", "658,928 bytes", "masked entries", "albedo R", "reciprocity error", "smallest value"})
        EXPECT_NE(measured.out.find(word), std::string::npos) << word;
    EXPECT_NE(measured.out.find("more light than it receives at θv = 85°\n"),
              std::string::npos);  // where it is extrapolated
    for (const char* word : {"2 lobes × 2 variates", "paper_white_rgb.bsdf", "objective", "albedo R"})
        EXPECT_NE(model.out.find(word), std::string::npos) << word;
}

TEST_F(Command, info_warns_of_albedos_above_one) {
    PmModel model;  // f = 0.4: an albedo of 0.4 pi
    model.lobes = model.variates = 1;
    model.coefficient = {{0.1f, 0.4f, 0.2f}};
    model.log_scale = {0}, model.centre = {{0, 0, 1}}, model.bandwidth = {0}, model.parameterization = {{1, 1}};
    ASSERT_TRUE(save_model({model, {}}, folder / "bright.srbf").ok());
    const ProgramRun info = run(folder, {"info", "bright.srbf"});
    EXPECT_EQ(info.status, 0) << info.err;
    for (const char* word : {"1.256", "warning", "more light than it receives at θv = 0°, 15°", "reciprocity error 0 %",
                             "smallest value    0.09998 1/sr"})
        EXPECT_NE(info.out.find(word), std::string::npos) << word << info.out;
}

TEST_F(Command, eval_agrees_with_the_reference_values) {
    const std::string csv = bundled_data() / "paper_white_rgb.csv";
    const ProgramRun eval = run(folder, {"eval", k_paper, "--pairs", csv});
    ASSERT_EQ(eval.status, 0) << eval.err;
    write(folder / "values.csv", eval.out);
    const auto reference = read_reference(csv), ours = read_reference(folder / "values.csv");
    ASSERT_EQ(ours.size(), reference.size());
    for (std::size_t i = 0; i < ours.size(); ++i) {
        EXPECT_EQ(ours[i].wl, reference[i].wl);
        EXPECT_EQ(ours[i].wv, reference[i].wv);
        for (int c = 0; c < 3; ++c) {
            const double a = double(ours[i].f[c]), b = double(reference[i].f[c]);
            EXPECT_TRUE(near_relative(a, b, 1e-3) || near(a, b, 1e-5)) << i << ' ' << a << ' ' << b;
        }
    }
}

TEST_F(Command, eval_keeps_order_and_text_of_rows) {
    const auto model = load_model(*fitted / "m.srbf");
    ASSERT_TRUE(model);
    // Columns in another order, others among them, quotes, a byte order mark, CRLF, no last line's end.
    write(folder / "pairs.csv",
          "\xef\xbb\xbfnote,\"wv_z\",wv_y,wv_x, wl_x ,wl_y,wl_z,r\r\n"
          "\"a, b\",1.0,0,0.000,6e-1,+0,0.8,x\r\n"
          "\r\n"
          ",\"0.8\",-.6,0,0,0,1,\r\n"
          "below,1,0,0,0.6,0,-0.8,7");
    const ProgramRun eval = run(folder, {"eval", *fitted / "m.srbf", "--pairs", "pairs.csv"});
    ASSERT_EQ(eval.status, 0) << eval.err;
    const auto row = [&](const char* text, Vec3f wl, Vec3f wv) {
        Rgb f;
        evaluate(*model, {&wl, 1}, {&wv, 1}, {&f, 1});
        return fmt::format("{},{:.9g},{:.9g},{:.9g}\n", text, f.r, f.g, f.b);
    };
    EXPECT_EQ(eval.out, std::string("wl_x,wl_y,wl_z,wv_x,wv_y,wv_z,r,g,b\n") +
                            row("6e-1,+0,0.8,0.000,0,1.0", {0.6f, 0, 0.8f}, {0, 0, 1}) +
                            row("0,0,1,0,-.6,0.8", {0, 0, 1}, {0, -0.6f, 0.8f}) + "0.6,0,-0.8,0,0,1,0,0,0\n");
}

TEST_F(Command, eval_names_the_line_at_fault) {
    const std::string header = "wl_x,wl_y,wl_z,wv_x,wv_y,wv_z\n", good = "0,0,1,0,0,1\n";
    const std::pair<std::string, std::string> bad[] = {{"", "pairs.csv: line 1"},
                                                       {"wl_x,wl_y,wl_z,wv_x,wv_y\n", "line 1: header"},
                                                       {header + good + "0,0,one,0,0,1\n", "line 3: column wl_z"},
                                                       {header + good + good + "0,0,1,0,0\n", "line 4: column wv_z"},
                                                       {header + "0,0,1,0,0,nan\n", "line 2: column wv_z"},
                                                       {header + "0,0,1,0,0,1e999\n", "line 2: column wv_z"},
                                                       {header + "0,0,1,0,0.2,1\n", "line 2: direction wv"}};
    for (const auto& [csv, named] : bad) {
        write(folder / "pairs.csv", csv);
        expect_failure(1, {"eval", *fitted / "m.srbf", "--pairs", "pairs.csv"}, named);
    }
    expect_failure(1, {"eval", *fitted / "m.srbf", "--pairs", "none.csv"}, "none.csv");
}

TEST_F(Command, bad_input_leaves_nothing_behind) {
    const std::string paper = contents(k_paper), merl = small_merl();
    write(folder / "empty", "");
    write(folder / "truncated.bsdf", paper.substr(0, paper.size() / 2));
    write(folder / "magic.bsdf", fmt::format("T{}", paper.substr(1)));
    write(folder / "size.binary", merl + "x");
    write(folder / "truncated.binary", merl.substr(0, merl.size() - 1));
    write(folder / "nan.binary", text_of(merl_file({9, 6, 8}, [](auto...) { return std::nan(""); })));
    write(folder / "truncated.srbf", contents(*fitted / "m.srbf").substr(0, 40));
    write(folder / "kept.srbf", "kept");
    std::filesystem::create_directory(folder / "a folder");
    for (const std::string name : {"missing", "empty", "truncated.bsdf", "magic.bsdf", "size.binary",
                                   "truncated.binary", "nan.binary", "truncated.srbf", "a folder"}) {
        expect_failure(1, {"fit", name, "-o", "kept.srbf", "--preview", "p.png", "--json", "r.json"}, name);
        expect_failure(1, {"info", name}, name);
        expect_failure(1, {"compare", k_paper, name, "--json", "r.json"}, name);
    }
    expect_failure(1, {"fit", *fitted / "m.srbf"}, "m.srbf: input: expected a measurement, found a fitted model");
    write(folder / "zero.binary", text_of(merl_file({9, 6, 8}, [](auto...) { return 0; })));
    expect_failure(1, {"fit", "zero.binary"}, "zero.binary: ");
}

TEST_F(Command, outputs_that_cannot_be_written_leave_nothing_behind) {
    write(folder / "small.binary", small_merl());
    std::filesystem::create_directory(folder / "a folder");
    std::filesystem::create_symlink("small.binary", folder / "link");
    const Arguments fit{"fit", "small.binary", "--lobes", "1", "--variates", "1"};
    for (const char* option : {"-o", "--preview", "--json"})
        for (const char* name : {"missing/x", "a folder", "link"})
            expect_failure(1, fit + Arguments{option, name}, name);
    expect_failure(1, fit + Arguments{"-o", "./small.binary"}, "small.binary");
    expect_failure(1, fit + Arguments{"-o", "x.png", "--preview", "./x.png"}, "x.png");
    expect_failure(1, {"compare", "small.binary", k_paper, "--json", "small.binary"}, "small.binary");
    // Full devices, of which only writing tells.
    expect_failure(1, fit + Arguments{"-o", "/dev/full", "--json", "r.json"}, "/dev/full");
    expect_failure(1, fit + Arguments{"--json", "/dev/full", "--preview", "p.png"}, "/dev/full");
    const Arguments eval{"eval", k_paper, "--pairs", bundled_data() / "paper_white_rgb.csv"};
    for (const Arguments& command : {fit, {"info", k_paper}, eval})
        expect_failure(1, command, "standard output", "/dev/full");
}

TEST_F(Command, usage_errors_of_choices) {
    expect_failure(2, {"fit", k_paper, "--budget", "160", "--target-error", "0.1"}, "not together with");
    expect_failure(2, {"fit", k_paper, "--budget", "160", "--lobes", "3"}, "not together with --lobes");
    expect_failure(2, {"fit", k_paper, "--budget", "4"}, "expected 12 to 512, found 4");
    expect_failure(2, {"fit", k_paper, "--target-error", "0"}, "--target-error");
    expect_failure(2, {"fit", k_paper, "--model", "ggx", "--lobes", "3"}, "of ggx 1 or 2");
    expect_failure(2, {"fit", k_paper, "--model", "ggx", "--form", "source"}, "only with --model pm");
    expect_failure(2, {"fit", k_paper, "--model", "su", "--budget", "100"}, "only with --model pm");
    expect_failure(2, {"fit", k_paper, "--lobes", "many"}, "expected 1 to 64, found many");
}

TEST_F(Command, usage_errors_name_what_is_wrong) {
    const std::pair<Arguments, std::string> bad[] = {
        {{}, "subcommand"},
        {{"bogus"}, "bogus"},
        {{"--bogus"}, "--bogus"},
        {{"fit"}, "INPUT"},
        {{"fit", k_paper, "two"}, "two"},
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
    for (const auto& [arguments, named] : bad) expect_failure(2, arguments, named);
    for (const char* lobes : {"0", "-1", "65", "1e9", "2.5", "abc", "", "3\n4"})
        expect_failure(2, {"fit", k_paper, "--lobes", lobes}, "--lobes");
    for (const char* variates : {"0", "9"}) expect_failure(2, {"fit", k_paper, "--variates", variates}, "--variates");
    for (const char* theta : {"0", "-5", "95", "nan", "inf"})
        expect_failure(2, {"fit", k_paper, "--max-theta", theta}, "--max-theta");
}

TEST_F(Command, help_shows_an_example) {
    for (const Arguments& of : {Arguments{}, {"fit"}, {"info"}, {"eval"}, {"compare"}, {"convert"}, {"render"}}) {
        const ProgramRun help = run(folder, of + Arguments{"--help"});
        EXPECT_EQ(help.status, 0);
        EXPECT_EQ(help.err, "");
        EXPECT_NE(help.out.find("Example"), std::string::npos) << help.out;
        EXPECT_NE(help.out.find("\n  srbf "), std::string::npos) << help.out;
    }
    const ProgramRun version = run(folder, {"--version"});
    EXPECT_EQ(version.status, 0);
    EXPECT_TRUE(version.out.starts_with("srbf 0.")) << version.out;
}

TEST_F(Command, convert_copies_and_converts) {
    // Of the format already: byte for byte.
    const std::string merl = small_merl();
    write(folder / "m.binary", merl);
    write(folder / "s.csv", std::string(k_small_csv));
    ASSERT_EQ(run(folder, {"convert", "m.binary", "-o", "copy.binary"}).status, 0);
    EXPECT_EQ(contents(folder / "copy.binary"), merl);
    ASSERT_EQ(run(folder, {"convert", k_paper, "-o", "paper.bsdf"}).status, 0);
    EXPECT_EQ(contents(folder / "paper.bsdf"), contents(k_paper));
    // A measurement, samples and a model.
    for (const std::string& input : Arguments{k_paper, "s.csv", (*fitted / "m.srbf").string()})
        for (const std::string output : {"o.binary", "o.bsdf", "o.csv"}) {
            if (output == "o.binary" && input == k_paper) continue;  // takes its time under sanitizers
            const ProgramRun made =
                run(folder, {"convert", input, "-o", output, "--threads", "1", "--directions", "9"});
            ASSERT_EQ(made.status, 0) << made.err;
            EXPECT_EQ(made.out, "");
            const auto measured = load_measured(folder / output);
            ASSERT_TRUE(measured.ok()) << message(measured.error());
            EXPECT_EQ(measured->format, output == "o.binary" ? "MERL" : output == "o.bsdf" ? "RGL" : "CSV");
        }
}

TEST_F(Command, convert_refuses) {
    write(folder / "m.binary", small_merl());
    write(folder / "a.csv", "wl_x,wl_y,wl_z,wv_x,wv_y,wv_z,value\n0,0.6,0.8,0,0,1,1\n");
    expect_failure(2, {"convert", "m.binary", "-o", "m.exr"}, "ends in .binary, .bsdf or .csv");
    expect_failure(2, {"convert", "m.binary"}, "--output");
    expect_failure(1, {"convert", "m.binary", "-o", "m.binary"}, "another file than the input");
    expect_failure(1, {"convert", "a.csv", "-o", "a.bsdf"},
                   "expected an isotropic BRDF, as RGL tables are, found an anisotropic one");
    expect_failure(1, {"convert", "none.binary", "-o", "m.csv"}, "none.binary");
    expect_failure(1, {"convert", "m.binary", "-o", "no/folder.bsdf"}, "a folder that exists");
    expect_failure(1, {"fit", "a.csv"}, "samples at different directions: expected at least 5, found 1");
}

TEST_F(Command, render_refuses) {
    write(folder / "m.binary", small_merl());
    write(folder / "no_faces.obj", "v 0 0 0\n");
    write(folder / "nan.obj", "v 0 nan 0\nf 1 1 1\n");
    write(folder / "range.ply",
          "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
          "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n3 0 1 2\n");
    const Arguments render{"render", "m.binary", "--renderer", "raster", "-o", "x.png"};
    const auto with_mesh = [&](const std::string& mesh) { return render + Arguments{"--mesh", mesh}; };
    expect_failure(1, with_mesh("no_faces.obj"), "no_faces.obj: faces of the mesh: expected one at least, found none");
    expect_failure(1, with_mesh("nan.obj"), "nan.obj: line 1: v: expected three numbers");
    expect_failure(1, with_mesh("range.ply"), "range.ply: vertex index of a face: expected below 1, found 1");
    expect_failure(1, with_mesh("missing.ply"), "missing.ply");
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
}  // namespace srbf
