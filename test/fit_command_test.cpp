// `srbf fit`: its output for each kind of model and measurement, and independence of threads.
#include "command.h"
#include "errors/picture_errors.h"
#include "errors/sphere.h"
#include "measured/samples.h"
#include "models/pm/pm_functions.h"
#include "models/su/su_functions.h"
#include "srbf/file.h"
#include "srbf/measured.h"
#include "srbf/metrics.h"
#include "srbf/model.h"

namespace srbf::fit_command_test {
namespace {

class FitCommand : public SmallFit {
    void SetUp() override { SKIP_UNDER_SANITIZERS("fits take too long"); }
};
using FitTarget = ProgramTest;

TEST_F(FitCommand, WritesModelPictureAndReport) {
    ASSERT_EQ(first.status, 0) << first.err;
    EXPECT_EQ(first.err, "");  // progress only on a terminal
    EXPECT_EQ(fitted->files().size(), 3u);
    EXPECT_TRUE(read_text(*fitted / "p.png").starts_with("\x89PNG\r\n\x1a\n"));
    const auto model = checked(load_model(*fitted / "m.srbf"));
    const PmModel& pm = std::get<PmModel>(model->model);

    const Json json = report();
    ASSERT_TRUE(json.is_object());
    const Json expected = Json::parse(R"({"model": "pm", "form": "reciprocal", "lobes": 2, "variates": 2, "axial": true,
        "channels": 3, "objective": "appearance", "max_theta": 89.0, "raw_bytes": 28311552, "auxiliary_bytes": 0, "seed": 0,
        "threads": 1, "masked_samples": 0, "clamped_samples": 0})");
    EXPECT_EQ(json.value("payload_bytes", std::size_t(0)), payload_bytes(pm));
    EXPECT_CONTAINS(first.out, fmt::format("  stored    48 bytes (file {}), source file 658,928 bytes, 1 : 13,727\n",
                                           read_text(*fitted / "m.srbf").size()));
    for (const auto& [key, value] : expected.items()) EXPECT_EQ(json.value(key, Json()), value) << key;
    EXPECT_GT(json.value("fit_seconds", 0.0), 0.0);
    EXPECT_GT(json.value("load_seconds", 0.0), 0.0);
    EXPECT_NE(json.value("stop_reason", ""), "");
    EXPECT_EQ(json.value("peak", ""), "none");  // paper is matte
    EXPECT_CONTAINS(first.out, "  peak      no highlight (matte)");
    for (const std::string& name : k_measure_keys + Arguments{"albedo_error"}) {
        const double error = json.value(name, -1.0);
        EXPECT_TRUE(std::isfinite(error) && error > 0 && error < 0.5) << name << ' ' << error;
    }
    const Json pictures = json.value("pictures", Json::object());
    for (const PictureErrorName& error : k_picture_errors) EXPECT_GT(pictures.value(error.name, 0.0), 0) << error.name;
    EXPECT_GE(pictures.value("worst_delta_e_itp", 0.0), pictures.value("delta_e_itp", 1e3));
    EXPECT_EQ(pictures.value("lightings", Json::object()).size(), standard_lightings().size());
}

TEST_F(FitCommand, CompareFindsTheErrorsThatFitReports) {
    const Json fit = report();
    for (const Arguments& theta : {Arguments{}, Arguments{"--max-theta", "89"}}) {
        const ProgramRun compared =
            run_ok(*fitted, Arguments{"compare", k_paper, "m.srbf", "--json", "-", "--threads", "2"} + theta);
        const Json json = Json::parse(compared.out, nullptr, false);
        EXPECT_EQ(json.value("albedo_error", -1.0), fit.value("albedo_error", -2.0));
        EXPECT_EQ(json.value("pictures", Json(1)), fit.value("pictures", Json(2)));
        for (const std::string& key : k_measure_keys) EXPECT_EQ(json.value(key, -1.0), fit.value(key, -2.0)) << key;
    }
}

/// A report without durations, names and the number of threads.
Json without_durations(Json report) {
    for (const char* key : {"threads", "output", "source", "fit_seconds", "load_seconds", "key"}) report.erase(key);
    return report;
}

TEST_F(FitCommand, ManyFilesAreFittedAsEachOfThem) {
    write_text(folder / "small.binary", small_merl());
    write_text(folder / "broken.binary", small_merl() + "x");
    std::filesystem::copy(k_paper, folder / "small.bsdf");
    const Arguments options{"--lobes", "2", "--variates", "2", "--threads", "2"};
    const Arguments arguments =
        Arguments{"fit", "small.binary", "broken.binary", "missing", k_paper, "small.bsdf", ".", "-o", "new/models"} +
        options;
    const ProgramRun result = run_srbf(folder, arguments);
    EXPECT_EQ(result.status, 1);
    // Each file has a line on standard output or error, in order. A failure does not stop the other files.
    EXPECT_LT(result.out.find("\nsmall  "), result.out.find("\npaper_white_rgb  ")) << result.out;
    EXPECT_CONTAINS(result.out, "2 fitted");
    EXPECT_CONTAINS(result.out, "0 kept; 4 failed");
    EXPECT_EQ(std::ranges::count(result.err, '\n'), 4) << result.err;
    EXPECT_LT(result.err.find("broken.binary"), result.err.find("missing"));
    EXPECT_CONTAINS(result.err, "small.bsdf: model: expected a name of its own, found that of small.binary");
    const std::string models = folder / "new/models/";
    EXPECT_EQ(read_text(models + "paper_white_rgb.srbf"), read_text(*fitted / "m.srbf"));
    EXPECT_EQ(without_durations(Json::parse(read_text(models + "paper_white_rgb.json"), nullptr, false)),
              without_durations(report()));
    EXPECT_FALSE(std::filesystem::exists(models + "broken.srbf"));

    // A resumed run keeps complete models unchanged.
    const std::string small = read_text(models + "small.srbf");
    write_text(models + "small.srbf", small.substr(0, small.size() / 2));
    const auto written = std::filesystem::last_write_time(models + "paper_white_rgb.srbf");
    const ProgramRun resumed = run_srbf(folder, arguments + Arguments{"--resume"});
    EXPECT_CONTAINS(resumed.out, "1 fitted");
    EXPECT_CONTAINS(resumed.out, "1 kept; 4 failed");
    EXPECT_EQ(read_text(models + "small.srbf"), small);
    EXPECT_EQ(std::filesystem::last_write_time(models + "paper_white_rgb.srbf"), written);
    // It does not keep models made with other options or from another measurement.
    const Arguments resume{"fit", "small.binary", "-o", "new/models", "--resume", "--variates", "2"};
    EXPECT_CONTAINS(run_srbf(folder, resume + Arguments{"--lobes", "1"}).out, "1 fitted");
    EXPECT_CONTAINS(run_srbf(folder, resume + Arguments{"--lobes", "1"}).out, "1 kept");
    write_text(folder / "small.binary",
               as_text(merl_file({9, 6, 8}, [](int h, int, int, int) { return 0.2 + 1.0 / (h + 1); })));
    EXPECT_CONTAINS(run_srbf(folder, resume + Arguments{"--lobes", "1"}).out, "1 fitted");
}

/// `count` samples of a smooth BRDF at random pairs of directions, as CSV.
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

TEST_F(FitCommand, ChoosesTheLobesOfScatteredSamples) {
    write_text(folder / "samples.csv", smooth_samples(40));
    const ProgramRun fit = run_ok(folder, {"fit", "samples.csv", "--variates", "1", "--form", "source", "--objective",
                                           "raw", "--max-theta", "70", "--json", "-"});
    const Json json = Json::parse(fit.out, nullptr, false);
    EXPECT_EQ(json.value("folds", 0), 5);
    EXPECT_LT(json.value("heldout_squared_error_ratio", 1.0), 0.1);
    EXPECT_GE(json.value("heldout_squared_error_ratio", 0.0), json.value("squared_error_ratio", 1.0));
    // The largest number of lobes that 4/5 of 3 × 40 values determine: 2 J (3 + 1) + 4 bytes at most 96.
    EXPECT_EQ(json.value("lobes", 0), 9);
    run_ok(folder, {"compare", "samples.csv", "samples.srbf"});
}

/// Smooth samples at five wavelengths, in Cornell's format.
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

TEST_F(FitCommand, FitsSpectra) {
    write_text(folder / "s.brdf", smooth_spectra());
    const ProgramRun fit = run_ok(folder, {"fit", "s.brdf", "--channels", "spectral", "--lobes", "2", "--variates", "2",
                                           "--objective", "raw", "--max-theta", "75", "--json", "-"});
    const Json json = Json::parse(fit.out, nullptr, false);
    EXPECT_EQ(json.value("channels", 0), 5);
    EXPECT_EQ(json.value("payload_bytes", 0), 2 * (2 * (5 + 2 + 1 + 4) + 4));
    EXPECT_EQ(json.value("raw_bytes", 0), 8 * 8 * 7 * 5 * 4);
    EXPECT_LT(json.value("squared_error_ratio", 1.0), 0.02);
    EXPECT_LT(json.value("heldout_squared_error_ratio", 1.0), 0.03);
    EXPECT_CONTAINS(run_srbf(folder, {"info", "s.srbf"}).out, "5, 400 to 700 nm");

    // The model is evaluated at wavelengths unless colours are requested, the measurement only on request.
    write_text(folder / "pairs.csv", "wl_x,wl_y,wl_z,wv_x,wv_y,wv_z\n0,0,1,0.6,0,0.8\n0.6,0,0.8,-0.6,0,0.8\n");
    const std::string directions = "wl_x,wl_y,wl_z,wv_x,wv_y,wv_z", nm = ",400nm,450.5nm,500nm,600nm,700nm\n";
    for (const Arguments& arguments :
         {Arguments{"s.srbf"}, {"s.srbf", "--channels", "spectral"}, {"s.brdf", "--channels", "spectral"}}) {
        const ProgramRun eval = run_ok(folder, Arguments{"eval", "--pairs", "pairs.csv"} + arguments);
        EXPECT_TRUE(eval.out.starts_with(directions + nm)) << eval.out;
        // The output is a measurement at wavelengths again.
        const auto samples = checked(read_csv(as_bytes(eval.out), "e", {}));
        ASSERT_EQ(samples->spectrum.size(), 10u);
        for (std::size_t c = 0; c < 5; ++c)
            EXPECT_WITHIN(samples->spectrum[5 + c], 0.02 * double(c + 1) + 0.3, 0.06) << c;
    }
    for (const Arguments& arguments : {Arguments{"s.brdf"}, {"s.srbf", "--channels", "rgb"}}) {
        const ProgramRun eval = run_srbf(folder, Arguments{"eval", "--pairs", "pairs.csv"} + arguments);
        EXPECT_TRUE(eval.out.starts_with(directions + ",r,g,b\n")) << eval.out;
    }
}

TEST_F(FitTarget, IsReachedByTheLastSizeAlone) {
    const ProgramRun fit = run_ok(folder, {"fit", k_paper, "--target-delta-e", "6", "-o", "b.srbf", "--json", "-"});
    const Json json = Json::parse(fit.out, nullptr, false), path = json["path"];
    EXPECT_TRUE(json.value("reached", false));
    ASSERT_GE(path.size(), 1u);
    for (std::size_t i = 0; i < path.size(); ++i) EXPECT_EQ(path[i].value("error", 0.0) <= 6, i + 1 == path.size());
    EXPECT_EQ(path.back()["lobes"], json["lobes"]);
    EXPECT_EQ(path.back()["error"], json["mean_pictures"]["delta_e_itp"]);
}

TEST_F(FitCommand, ViewByViewModelsFitScatteredSamples) {
    write_text(folder / "samples.csv", smooth_samples(600));
    const ProgramRun fit = run_ok(folder, {"fit", "samples.csv", "--model", "su", "--lobes", "3", "--directions", "96",
                                           "--objective", "raw", "--max-theta", "70", "--json", "-"});
    const Json json = Json::parse(fit.out, nullptr, false);
    // The error of interpolation is larger, because the samples are 10° apart.
    EXPECT_LT(json.value("squared_error_ratio", 1.0), 0.02);
    EXPECT_GT(json.value("squared_error_ratio", 0.0), 0.0);
    EXPECT_LT(json.value("heldout_squared_error_ratio", 1.0), 0.03);
    EXPECT_EQ(json.value("folds", 0), 5);
}

const Arguments k_fit_su{"fit", k_paper, "--model", "su", "--directions", "200", "--lobes", "2", "--objective", "raw"};

TEST_F(FitCommand, ViewByViewModelsAreReadByTheOtherCommands) {
    run_ok(folder, k_fit_su + Arguments{"-o", "su.srbf", "--with-index", "parabolic", "--json", "r.json"});
    const Json json = Json::parse(read_text(folder / "r.json"), nullptr, false);
    const Json expected = Json::parse(R"({"model": "su", "form": "source", "lobes": 2, "variates": 1, "axial": false,
        "discretise": "view", "directions": 200, "interpolation": "rotated", "index": "parabolic", "channels": 3,
        "objective": "raw", "max_theta": 80.0, "raw_bytes": 480000, "payload_bytes": 4800, "auxiliary_bytes": 1050176,
        "masked_samples": 0, "clamped_samples": 0, "empty_directions": 0})");
    for (const auto& [key, value] : expected.items()) EXPECT_EQ(json.value(key, Json()), value) << key;
    EXPECT_GT(json.value("fit_seconds", 0.0), 0.0);

    const auto model = checked(load_model(folder / "su.srbf"));
    const SuModel& su = std::get<SuModel>(model->model);
    EXPECT_EQ(su.index, index_texture(su, DirectionMap::parabolic));

    const ProgramRun compared = run_ok(folder, {"compare", k_paper, "su.srbf", "--json", "-"});
    const Json compared_json = Json::parse(compared.out, nullptr, false);
    for (const std::string& key : k_measure_keys)
        EXPECT_EQ(compared_json.value(key, -1.0), json.value(key, -2.0)) << key;
    EXPECT_EQ(compared_json.value("pairs", 0), 165 * 165);  // 165 of the 200 directions are within 80 degrees

    const ProgramRun info = run_ok(folder, {"info", "su.srbf"});
    for (const char* word : {"2 lobes × 200 sampled directions", "4,800 bytes", "parabolic", "albedo R"})
        EXPECT_CONTAINS(info.out, word);

    write_text(folder / "pairs.csv", "wl_x,wl_y,wl_z,wv_x,wv_y,wv_z\n0,0.6,0.8,0,0,1\n");
    const ProgramRun eval = run_ok(folder, {"eval", "su.srbf", "--pairs", "pairs.csv"});
    std::vector<Rgb> f(1);
    const Vec3f wl[] = {{0, 0.6f, 0.8f}}, wv[] = {{0, 0, 1}};
    evaluator (*model)(wl, wv, f);
    EXPECT_CONTAINS(eval.out, fmt::format("0,0,1,{:.9g},{:.9g},{:.9g}\n", f[0].r, f[0].g, f[0].b));
}

TEST_F(FitCommand, ViewByViewModelsRefuseOptionsOfOthers) {
    // There is one lobe more than there are directions within 80 degrees.
    expect_failure(1, {"fit", k_paper, "--model", "su", "--directions", "16", "--lobes", "14", "--objective", "raw"},
                   "paper_white_rgb.bsdf: directions with data in sampled view 0: expected none or at least 14");
    write_text(folder / "zero.binary", as_text(merl_file({9, 6, 8}, [](auto...) { return 0; })));
    expect_failure(1, {"fit", "zero.binary", "--model", "su", "--directions", "64"}, "zero.binary: values");
    expect_failure(2, k_fit_su + Arguments{"--variates", "2"}, "--variates: only with --model pm");
    expect_failure(2, {"fit", k_paper, "--with-index", "cube"}, "--with-index: only with --model su");
    expect_failure(2, k_fit_su + Arguments{"--interpolation", "8"}, "--interpolation");
    for (const char* directions : {"7", "8193", "x"})
        expect_failure(2, {"fit", k_paper, "--model", "su", "--directions", directions}, "--directions");
}

}  // namespace
}  // namespace srbf::fit_command_test
