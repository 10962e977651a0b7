// The command line with BSDFs that reflect and transmit.
#include "base/text.h"
#include "command.h"
#include "extras/daylight/test/bsdf_files.h"
#include "models.h"
#include "models/bsdf/bsdf_functions.h"
#include "models/su/su_functions.h"
#include "srbf/load.h"

namespace srbf::bsdf_command_test {
namespace {

/// A shade and a small fit to it, made once and copied into the folder of each test.
class BsdfCommand : public ProgramTest {
  protected:
    static void SetUpTestSuite() {
        shared = std::make_unique<TemporaryFolder>();
        write_text(*shared / "shade.xml", small_shade());
        write_text(
            *shared / "pairs.csv",
            "wl_x,wl_y,wl_z,wv_x,wv_y,wv_z\n0,0,1,0,0.6,-0.8\n0,0,-1,0,0.6,0.8\n0,0,-1,0,0.6,-0.8\n0,0,1,0,0.6,0.8\n");
        fitted = run_srbf(*shared, {"fit", "shade.xml", "--lobes", "1", "--variates", "2", "--axial", "--threads", "1",
                                    "--json", "r.json"});
    }
    static void TearDownTestSuite() { shared.reset(); }
    void SetUp() override { std::filesystem::copy(shared->path, folder.path); }

    inline static std::unique_ptr<TemporaryFolder> shared;
    inline static ProgramRun fitted;
};

TEST_F(BsdfCommand, FitsAndEvaluatesBothSides) {
    ASSERT_EQ(fitted.status, 0) << fitted.err;
    const Json report = Json::parse(read_text(folder / "r.json"));
    EXPECT_EQ(report["model"], "bsdf");
    EXPECT_EQ(report["band"], "Visible");
    ASSERT_EQ(report["parts"].size(), 4u);
    EXPECT_EQ(report["parts"][3]["answered_by"], "transmission_front");
    EXPECT_EQ(report["parts"][2]["hemispherical"].size(), 3u);
    const auto model = checked(load_brdf(folder / "shade.srbf"));
    EXPECT_TRUE(is_two_sided(*model));
    EXPECT_EQ(report["payload_bytes"], payload_bytes(std::get<Model>(*model)));

    const ProgramRun values = run_ok(folder, {"eval", "shade.srbf", "--pairs", "pairs.csv"});
    std::vector<double> green;
    for (Lines lines(values.out); auto line = lines.next();) {
        std::vector<std::string_view> fields;
        split_fields(*line, fields);
        ASSERT_EQ(fields.size(), 9u);
        if (lines.number() > 1) green.push_back(*to_number<double>(fields[7]));
    }
    ASSERT_EQ(green.size(), 4u);
    EXPECT_WITHIN(green[0], 0.05, 2e-3);
    EXPECT_WITHIN(green[1], 0.05, 2e-3);
    EXPECT_WITHIN_RELATIVE(green[2], 2 * green[3], 0.1);

    const ProgramRun info = run_srbf(folder, {"info", "shade.srbf"}),
                     file_info = run_srbf(folder, {"info", "shade.xml"});
    EXPECT_CONTAINS(info.out, "transmission_back: by reciprocity");
    EXPECT_CONTAINS(info.out, "transmission: 0.08002 at 0°");
    EXPECT_CONTAINS(file_info.out, "Visible (here), Solar");
    const ProgramRun solar =
        run_srbf(folder, {"fit", "shade.xml", "--band", "solar", "--lobes", "1", "--axial", "--json", "-"});
    EXPECT_EQ(Json::parse(solar.out)["band"], "Solar") << solar.err;
    expect_failure(1, {"fit", "shade.xml", "--band", "x"}, "shade.xml: band of wavelengths: expected Visible or Solar");
    expect_failure(1, {"fit", k_paper, "--band", "Solar"}, "expected a measurement in bands");
}

TEST_F(BsdfCommand, ComparesConvertsAndExports) {
    ASSERT_EQ(fitted.status, 0) << fitted.err;
    const ProgramRun compared = run_ok(folder, {"compare", "shade.xml", "shade.srbf", "--json", "-"});
    const Json errors = Json::parse(compared.out);
    for (const std::string_view part : k_part_names)
        EXPECT_LT(errors[std::string(part)]["heldout_squared_error_ratio_cosine"], 0.2) << part;
    EXPECT_LT(errors["transmission_back"]["heldout_squared_error_ratio_cosine"], 1e-4);
    for (const char* output : {"o.csv", "o.mbsdf"})
        expect_failure(1, {"convert", "shade.srbf", "-o", output}, "expected a BSDF without beams");
    for (const char* output : {"o.binary", "o.bsdf"})
        expect_failure(1, {"convert", "shade.srbf", "-o", output}, "expected a BRDF");
    run_ok(folder, {"export", "shade.srbf", "--to", "c", "-o", "shade.h"});
    const std::string code = read_text(folder / "shade.h");
    if (is_built({"html"})) {
        run_ok(folder, {"export", "shade.srbf", "--to", "html", "-o", "shade.html"});
        EXPECT_CONTAINS(read_text(folder / "shade.html"), "name='behind'");
    }
    expect_failure(1, {"export", "shade.srbf", "--to", "html", "--reference", "shade.xml", "-o", "x.html"},
                   "expected a measurement of a BRDF");
    for (const char* function :
         {"shade_bsdf(", "shade_beam(", "shade_reflection_front_brdf", "shade_transmission_front_brdf"})
        EXPECT_CONTAINS(code, function);
    EXPECT_LACKS(code, "shade_sample(");
    if (!is_built({"three"})) return;
    BsdfModel film;  // each part takes seconds
    film.part[std::size_t(Part::transmission_front)] = random_part(1, {.lobes = 1});
    ASSERT_TRUE(save_model({film, {}}, folder / "film.srbf").ok());
    run_ok(folder, {"export", "film.srbf", "--to", "three", "-o", "film.js"});
    EXPECT_CONTAINS(read_text(folder / "film.js"), "class FilmTransmissionFrontMaterial");
}

TEST_F(BsdfCommand, FitsViewByViewAndByLambertAndGgx) {
    for (const std::string model : {"su", "ggx"}) {
        std::vector<std::string> fit{"fit",           "shade.xml", "--model", model,    "-o",
                                     model + ".srbf", "--threads", "1",       "--json", model + ".json"};
        if (model == "su") fit.insert(fit.end(), {"--directions", "96", "--lobes", "2"});
        run_ok(folder, fit);
        const Json report = Json::parse(read_text(folder / (model + ".json")));
        ASSERT_EQ(report["parts"].size(), 4u);
        for (const Json& part : report["parts"])  // the matrix is piecewise constant
            EXPECT_LT(part["squared_error_ratio"], 0.05) << model << part["part"];
        const auto loaded = checked(load_brdf(folder / (model + ".srbf")));
        EXPECT_EQ(report["payload_bytes"], payload_bytes(std::get<Model>(*loaded)));
        const auto& part = std::get<BsdfModel>(std::get<Model>(*loaded).model).part[0];
        ASSERT_TRUE(part);
        EXPECT_EQ(std::holds_alternative<SuModel>(part->model), model == "su");
        for (const std::vector<std::string>& command :
             {std::vector<std::string>{"export", model + ".srbf", "--to", "c", "-o", model + ".h"},
              {"export", model + ".srbf", "--to", "html", "-o", model + ".html"},
              {"render", model + ".srbf", "--size", "16x12", "--spp", "1", "-o", model + ".png"}}) {
            if (!is_built(command)) continue;
            run_ok(folder, command);
        }
        EXPECT_EQ(std::filesystem::exists(folder / (model + "_reflection_front.data")), model == "su");
    }
    expect_failure(1, {"export", "su.srbf", "--to", "c", "--with", "sampling", "-o", "x.h"},
                   "expected a model that is not view by view");
}

TEST_F(BsdfCommand, RefusesModelsOfOneSide) {
    expect_failure(1, {"fit", "shade.xml", "--model", "openpbr", "-o", "x.srbf"},
                   "shade.xml: model: expected pm, su or ggx, since a surface of OpenPBR scatters light to one side");
    expect_failure(2, {"fit", "shade.xml", "--model", "openpbr", "--channels", "spectral", "-o", "x.srbf"},
                   "--channels");
}

TEST_F(BsdfCommand, FitsAShadeAmongOtherFiles) {
    write_text(folder / "other.xml", small_shade());
    write_text(folder / "bad.xml", small_shade().substr(0, 2000));
    const std::vector<std::string> command{"fit", "shade.xml", "other.xml", "bad.xml", k_paper,
                                           "-o",  "models",    "--lobes",   "1",       "--variates",
                                           "2",   "--axial",   "--threads", "2",       "--resume"};
    const ProgramRun first = run_srbf(folder, command), second = run_srbf(folder, command);
    EXPECT_EQ(first.status, 1);
    EXPECT_CONTAINS(first.err, "bad.xml");
    EXPECT_CONTAINS(first.out, "3 fitted");
    EXPECT_CONTAINS(second.out, "3 kept");
    // The model is the same as when fitted alone, except for its provenance.
    const auto alone = checked(load_model(folder / "shade.srbf")),
               among = checked(load_model(folder / "models/shade.srbf"));
    EXPECT_EQ(write_model({alone->model, {}}), write_model({among->model, {}}));
    const Json report = Json::parse(read_text(folder / "models/other.json"));
    EXPECT_EQ(report["parts"].size(), 4u);
}

TEST_F(BsdfCommand, AShadeLetsLightIntoARoom) {
    if (!is_built({"render"})) GTEST_SKIP() << "without srbf render";
    ASSERT_EQ(fitted.status, 0) << fitted.err;
    run_ok(folder, {"render", "shade.xml", "shade.srbf", "--scene", "room", "--size", "24x16", "--spp", "16", "-o",
                    "room.exr"});
    expect_failure(2, {"render", "shade.xml", "--scene", "garden", "-o", "x.png"}, "--scene");
}

}  // namespace
}  // namespace srbf::bsdf_command_test
