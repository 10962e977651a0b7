// Statements of docs/formats.md that no other test covers: NumPy reads a model; bounds on the memory of reading.
#include <fmt/format.h>
#include <sys/resource.h>

#include "app/map_layers.h"
#include "brdf_functions.h"
#include "measured_files.h"
#include "models.h"
#include "models/bsdf/bsdf_functions.h"
#include "models/ggx/ggx_kind.h"
#include "program.h"
#include "srbf/convert.h"
#include "srbf/file.h"

namespace srbf::formats_test {
namespace {

/// Peak memory of the child processes so far [bytes].
std::uint64_t children_memory() {
    rusage usage{};
    ::getrusage(RUSAGE_CHILDREN, &usage);
    return std::uint64_t(usage.ru_maxrss) * 1024;
}

void expect_frugal(const std::string& name, std::span<const std::byte> bytes, int status = 0) {
    const TemporaryFolder folder;
    write_text(folder / name, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    const ProgramRun shown = run_srbf(folder, {"info", name});
    EXPECT_EQ(shown.status, status) << shown.err;
    EXPECT_LT(children_memory(), 4 * bytes.size() + (64 << 20)) << name;
}

/// The files are read from the smallest to the largest, since only the overall peak is known.
TEST(Formats, ReadingTakesFourTimesTheFile) {
    const Evaluate coloured = constant_brdf({0.1f, 0.2f, 0.3f});
    expect_frugal("small.csv", as_bytes(k_small_csv));
    expect_frugal("t.bin", utia_file([](int, int, int, int, int) { return 0.1; }));
    expect_frugal("t.bsdf", write_rgl(to_rgl(coloured, {8, 64, "coloured", {}, 1})));
    expect_frugal("t.csv", as_bytes(write_csv(to_samples(coloured, true, 400, 80 * k_degree))));
    // One number a sample in the file, three in memory.
    const MbsdfTable table =
        to_mbsdf(constant_brdf({0.1f, 0.1f, 0.1f}), {.polar = 150, .azimuths = 180, .metadata = {}, .threads = 1});
    ASSERT_TRUE(table.grey);
    expect_frugal("t.mbsdf", write_mbsdf(table));
    // Rows too short for real measurements: more samples than the limit are an error.
    std::string dense = "theta_l_rad,theta_v_rad,phi_v_rad,value\n";
    for (int i = 0; i < 3500000; ++i) dense += "1,1,1,1\n";
    expect_frugal("dense.csv", as_bytes(dense), 1);
    MerlTable merl;
    merl.size = k_merl_size;
    merl.cells.assign(90 * 90 * 180, Rgb{0.1f, 0.2f, 0.3f});
    expect_frugal("t.binary", write_merl(merl));
}

/// A Python interpreter that has NumPy; empty if there is none.
std::string python_with_numpy() {
    for (const std::string python : {"python3", "/usr/bin/python3"})
        if (std::system((python + " -c 'import numpy' >/dev/null 2>&1").c_str()) == 0) return python;
    return {};
}

TEST(Formats, NumpyReadsModels) {
    const std::string python = python_with_numpy();
    if (python.empty()) GTEST_SKIP() << "no python3 with numpy (Debian: python3-numpy)";
    const TemporaryFolder folder;
    write_text(folder / "model.py", read_text(std::filesystem::path(SRBF_SOURCE_DIR) / "examples" / "read_model.py"));

    std::mt19937_64 random(1);
    std::vector<Vec3f> wl, wv;
    std::string pairs = "wl_x,wl_y,wl_z,wv_x,wv_y,wv_z\n";
    for (int i = 0; i < 200; ++i) {
        const Vec3f l = to_float(random_direction(random, 0.05)), v = to_float(random_direction(random, 0.05));
        wl.push_back(l);
        wv.push_back(v);
        pairs += fmt::format("{},{},{},{},{},{}\n", l.x, l.y, l.z, v.x, v.y, v.z);
    }
    write_text(folder / "pairs.csv", pairs);
    // Axial models of each form, of colours and of spectra.
    for (const PmForm form : k_forms)
        for (const int wavelengths : {0, 5}) {
            const RandomModelOptions options{true, form != PmForm::gaussian || wavelengths > 0, 4, 3, 300, form};
            const Model model{
                rounded(wavelengths > 0 ? spectral_model(random, options, wavelengths) : random_model(random, options)),
                {}};
            ASSERT_TRUE(save_model(model, folder / "m.srbf").ok());
            const std::string command =
                fmt::format("cd '{}' && {} model.py m.srbf pairs.csv > out.csv", folder.path.string(), python);
            ASSERT_EQ(std::system(command.c_str()), 0);
            const Channels expected = channels(model);
            std::vector<float> f(expected.count() * wl.size());
            expected.evaluate(wl, wv, f);
            std::istringstream out(read_text(folder / "out.csv"));
            for (std::size_t i = 0; i < f.size(); ++i) {
                std::string number;
                std::getline(out, number, (i + 1) % expected.count() > 0 ? ',' : '\n');
                EXPECT_WITHIN(std::atof(number.c_str()), f[i], 1e-3 * double(f[i]) + 1e-9);
            }
            std::string remainder;
            EXPECT_FALSE(std::getline(out, remainder));
        }
}

/// Values far beyond 16-bit floats, whose largest is 65504, are kept by a writer, or refused by it: none cuts them off.
TEST(Formats, LargeValuesAreKeptOrRefused) {
    const TemporaryFolder folder;
    const auto refused = [&](const Model& model) {
        const auto saved = save_model(model, folder / "x.srbf");
        EXPECT_FALSE(saved.ok() || std::filesystem::exists(folder / "x.srbf"));
        if (!saved) {
            EXPECT_CONTAINS(message(saved.error()), "at most 65504, the largest 16-bit float, found");
        }
    };
    std::mt19937_64 random(1);
    PmModel pm = random_model(random, {.lobes = 1, .variates = 1, .max_bandwidth = 2});
    pm.coefficient = {{1e6f, 1, 1}};
    refused({pm, {}});
    refused({GgxModel{{0.1f, 0.1f, 1e6f}, {GgxModel::Lobe{}}}, {}});
    BsdfModel bsdf;
    bsdf.part[0] = std::make_shared<const Model>(Model{pm, {}});
    refused({bsdf, {}});
    TexelMap map = random_map(random, {.lobes = 2}, 3, 2);
    EXPECT_TRUE(check_layers(map, "map").ok());
    map.coefficient[1].g = 1e6f;
    EXPECT_FALSE(check_layers(map, "map").ok());

    // f of 10⁷ by a log scale.
    pm.coefficient = {{100, 100, 100}}, pm.log_scale = {11.5f};
    ASSERT_TRUE(save_model({pm, {}}, folder / "m.srbf").ok());
    write_text(folder / "pairs.csv", "wl_x,wl_y,wl_z,wv_x,wv_y,wv_z\n0,0.6,0.8,0.6,0,0.8\n");
    const auto red = [&](const std::string& file) {
        const std::string rows = run_srbf(folder, {"eval", file, "--pairs", "pairs.csv"}).out;
        std::size_t column = rows.find('\n') + 1;
        for (int comma = 0; comma < 6; ++comma) column = rows.find(',', column) + 1;
        return std::atof(rows.c_str() + column);
    };
    const double expected = red("m.srbf");
    EXPECT_GT(expected, 1e5);
    for (const std::string output : {"o.csv", "o.binary", "o.bsdf", "o.mbsdf"}) {
        run_ok(folder, {"convert", "m.srbf", "-o", output});
        EXPECT_WITHIN(red(output), expected, 0.1 * expected) << output;
    }
    // Facets have no scale.
    const ProgramRun fit =
        run_srbf(folder, {"fit", "o.binary", "--model", "ggx", "--objective", "raw", "-o", "g.srbf"});
    EXPECT_EQ(fit.status, 1);
    EXPECT_CONTAINS(fit.err, "the largest 16-bit float");
}

}  // namespace
}  // namespace srbf::formats_test
