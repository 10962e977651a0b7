// `srbf map`, and its files.
#include <fmt/format.h>

#include "extras/maps/npy.h"
#include "extras/maps/test/texel_values.h"
#include "program.h"
#include "properties.h"
#include "srbf/file.h"
#include "srbf/map.h"

namespace srbf::map_files_test {
namespace {

std::string npy(const std::string& header, std::size_t numbers) {
    std::string text = "\x93NUMPY";
    text += std::string("\1\0", 2) + char(header.size()) + '\0' + header;
    return text + std::string(4 * numbers, '\0');
}

TEST(Npy, HeadIsReadAndEveryTruncationIsAnError) {
    const std::string header = "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 5, 3), }\n";
    const std::string file = npy(header, 30);
    const auto head = checked(read_npy_head(as_bytes(file), file.size(), "texels.npy"));
    EXPECT_EQ(head->shape, (std::vector<std::uint64_t>{2, 5, 3}));
    EXPECT_EQ(head->data, 10 + header.size());
    for (std::size_t n = 0; n < file.size(); ++n)
        EXPECT_FALSE(read_npy_head(as_bytes(std::string_view(file).substr(0, n)), n, "texels.npy").ok()) << n;
    for (const char* bad : {"{'descr': '<f8', 'fortran_order': False, 'shape': (2, 5, 3), }",
                            "{'descr': '<f4', 'fortran_order': True, 'shape': (2, 5, 3), }",
                            "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 5, -3), }",
                            "{'descr': '<f4', 'fortran_order': False, 'shape': (99999999999, 99999999999), }",
                            "{'descr': '<f4', 'fortran_order': False, 'shape': (0, 3), }", "{}"}) {
        const std::string wrong = npy(bad, 30);
        EXPECT_FALSE(read_npy_head(as_bytes(wrong), wrong.size(), "texels.npy").ok()) << bad;
    }
}

/// A folder with texels, their pairs and masks as files.
class MapFiles : public testing::Test {
  protected:
    void SetUp() override {
        SKIP_UNDER_SANITIZERS("fits take too long");
        const SharedPairs pairs = shared_pairs();
        std::string csv = "wl_x,wl_y,wl_z,wv_x,wv_y,wv_z\n";
        for (std::size_t i = 0; i < k_pairs; ++i) {
            const Vec3f l = pairs.wl[i], v = pairs.wv[i];
            csv += fmt::format("{},{},{},{},{},{}\n", l.x, l.y, l.z, v.x, v.y, v.z);
        }
        write_text(folder / "pairs.csv", csv);
        f = blends(pairs, k_texels);
        write_npy("texels.npy", fmt::format("({}, {}, 3)", k_texels, k_pairs), {&f[0].r, 3 * f.size()});
    }
    void write_npy(const char* name, const std::string& shape, std::span<const float> numbers) {
        const std::string header = fmt::format("{{'descr': '<f4', 'fortran_order': False, 'shape': {}, }}\n", shape);
        write_text(folder / name,
                   npy(header, 0) + std::string(reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes()));
    }
    ProgramRun map(std::vector<std::string> arguments) const {
        arguments.insert(arguments.begin(), "map");
        arguments.insert(arguments.end(), {"--lobes", "3", "--variates", "2", "--threads", "2", "-o", "map.srbf"});
        return run_srbf(folder, arguments);
    }
    static constexpr std::size_t k_texels = 8;
    std::vector<Rgb> f;
    TemporaryFolder folder;
};

TEST_F(MapFiles, TexelsShareLobes) {
    const ProgramRun done = map({"texels.npy", "--pairs", "pairs.csv", "--width", "4"});
    ASSERT_EQ(done.status, 0) << done.err;
    EXPECT_CONTAINS(done.out, "8 texels of 3 shared lobes");
    const auto made = checked(read_map(as_bytes(read_text(folder / "map.srbf")), "m"));
    EXPECT_EQ(std::pair(made->width, made->height()), std::pair(std::size_t(4), std::size_t(2)));
    for (const float error : made->error) EXPECT_LT(error, 0.5f);
    EXPECT_TRUE(write_map(*made) == *read_file(folder / "map.srbf"));
    EXPECT_EQ(map({"texels.npy", "--pairs", "pairs.csv", "--width", "3"}).status, 1);
    EXPECT_EQ(map({"texels.npy", "texels.npy", "--pairs", "pairs.csv"}).status, 1);
    EXPECT_EQ(map({"pairs.csv", "--pairs", "pairs.csv"}).status, 1);
}

TEST_F(MapFiles, NumbersForNoValueAreAsGoodAsNan) {
    std::string maps[2];
    for (const float number : {std::nanf(""), -999.f}) {
        std::fill(f.end() - 8, f.end(), Rgb{number, number, number});
        write_npy("texels.npy", fmt::format("({}, {}, 3)", k_texels, k_pairs), {&f[0].r, 3 * f.size()});
        const ProgramRun done = map({"texels.npy", "--pairs", "pairs.csv"});
        ASSERT_EQ(done.status, 0) << done.err;
        EXPECT_EQ(done.err.find("-999, which stands for no value") != done.err.npos, number < 0) << done.err;
        maps[number < 0] = read_text(folder / "map.srbf");
    }
    EXPECT_EQ(maps[0], maps[1]);
}

TEST_F(MapFiles, MasksPaintMaterials) {
    const std::string paper = bundled_data() / "paper_white_rgb.bsdf",
                      film = bundled_data() / "cc_ibiza_sunset_rgb.bsdf";
    std::vector<float> fractions{1, 0, 0, 1, 0.5f, 0.5f, 0, 0};
    write_npy("masks.npy", "(1, 4, 2)", fractions);
    const ProgramRun done = map({paper, film, "--masks", "masks.npy"});
    ASSERT_EQ(done.status, 0) << done.err;
    EXPECT_CONTAINS(done.out, "4 × 1 texels of 2 materials");
    const auto made = checked(read_map(as_bytes(read_text(folder / "map.srbf")), "m"));
    const auto beta = [&](std::size_t t, std::size_t j) { return made->coefficient[t * 3 + j]; };
    for (std::size_t j = 0; j < 3; ++j) {
        EXPECT_RGB_WITHIN_RELATIVE(beta(2, j), mixed(beta(0, j), beta(1, j), 0.5f), 1e-3f, 0);
        EXPECT_EQ(beta(3, j), Rgb());
    }
    EXPECT_EQ(map({paper, "--masks", "masks.npy"}).status, 1);
    EXPECT_EQ(map({paper, "pairs.csv", "--masks", "masks.npy"}).status, 1);
    fractions[3] = -1;
    write_npy("masks.npy", "(1, 4, 2)", fractions);
    const ProgramRun refused = map({paper, film, "--masks", "masks.npy"});
    EXPECT_EQ(refused.status, 1);
    EXPECT_CONTAINS(refused.err, "share of texel 1: expected a number of at least 0, found -1");
}

}  // namespace
}  // namespace srbf::map_files_test
