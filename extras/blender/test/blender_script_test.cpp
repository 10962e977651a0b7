// Scripts for Blender that `srbf export` writes.
#include "command.h"
#include "models.h"

namespace srbf::blender_script_test {
namespace {

class BlenderScript : public ProgramTest {
  protected:
    void SetUp() override {
        std::mt19937_64 random(1);
        const Model model{random_model(random, {.lobes = 1, .variates = 1, .max_bandwidth = 20}), {}};
        for (const char* name : {"a", "b"}) ASSERT_TRUE(save_model(model, folder / (std::string(name) + ".srbf")).ok());
        ASSERT_TRUE(save_model({OpenPbrModel{}, {}}, folder / "surface.srbf").ok());
        ASSERT_TRUE(save_model({lobe_bsdf_with_beams(), {}}, folder / "bsdf.srbf").ok());
    }
};

TEST_F(BlenderScript, HasTablesOfEachMaterial) {
    write_text(folder / "m.binary", small_merl());
    const ProgramRun result =
        run_ok(folder, {"export", "a.srbf", "m.binary", "--to", "blender", "--terms", "1", "-o", "o.py"});
    EXPECT_CONTAINS(result.out, "a: ΔE_ITP");
    const std::string script = read_text(folder / "o.py");
    EXPECT_CONTAINS(script, "(\"a\", 24, 1, [");
    EXPECT_CONTAINS(script, "(\"m\", 24, 1, [");
    if (std::system("python3 -c '' > /dev/null 2>&1") != 0) GTEST_SKIP();
    // Three rows of 24 texels; all shapes and weights are in their ranges. Without Blender nothing is made.
    write_text(folder / "check.py",
               "import o\n"
               "for name, columns, terms, numbers in o._MEASURED:\n"
               "    assert len(numbers) == 3 * columns * (2 * terms + 1)\n"
               "    shapes, others = numbers[:3 * columns], numbers[3 * columns:]\n"
               "    assert all(0 < r <= 1 and -1 < a < 1 for r, a in zip(shapes[1::3], shapes[2::3]))\n"
               "    assert min(others) >= 0\n");
    EXPECT_EQ(std::system(fmt::format("cd '{}' && python3 -B check.py", folder.path.string()).c_str()), 0);
}

TEST_F(BlenderScript, OtherInputIsRefused) {
    const auto refused = [&](const Arguments& arguments, const std::string& words) {
        const ProgramRun result = run_srbf(folder, Arguments{"export"} + arguments + Arguments{"-o", "o"});
        EXPECT_NE(result.status, 0);
        EXPECT_CONTAINS(result.err, words);
    };
    refused({"surface.srbf", "--to", "blender"}, "--to principled");
    refused({"bsdf.srbf", "--to", "blender"}, "transmission");
    refused({"a.srbf", "--to", "glsl", "--terms", "2"}, "is for --to blender and osl");
    refused({"a.srbf", "--to", "blender", "--terms", "9"}, "--terms");
    refused({"a.srbf", "b.srbf", "--to", "osl"}, "one shader");
    refused({"surface.srbf", "b.srbf", "--to", "blender"}, "--to principled");
}

}  // namespace
}  // namespace srbf::blender_script_test
