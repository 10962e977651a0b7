// MBSDF tables: look-up, metadata, NVIDIA's car paints, and invalid files.
#include "measured/readers.h"
#include "measured/tables.h"
#include "measured_files.h"
#include "srbf/convert.h"
#include "srbf/file.h"

namespace srbf::mbsdf_test {
namespace {

constexpr int k_polar = 9, k_azimuths = 13;
constexpr const char* k_reflection = "MBSDF_DATA_REFLECTION=";

/// Linear in θ_l, θ_v and φ, in units of samples, so that interpolation gives it back; negative in blue.
double function_at(double l, double v, double p, int c) {
    return (c == 2 ? -1 : 1 + c) * (1 + 0.2 * l) * (3 - 0.3 * v) * (1 + 0.1 * p);
}

MbsdfTable table() {
    return *read_mbsdf(mbsdf_file("", {mbsdf_block(k_reflection, k_polar, k_azimuths, 3, function_at)}), "t");
}

/// The position of θ = 90°, beyond the last sample, is n_θ; that of φ = 180° is that of the last sample.
TEST(Mbsdf, InterpolatesItsSamples) {
    const MbsdfTable t = table();
    EXPECT_EQ(t.masked, 0u);
    EXPECT_FALSE(t.grey);
    std::mt19937_64 random(1);
    for (int i = 0; i < 20000; ++i) {
        const double l = k_polar * 0.999 * uniform(random), v = k_polar * 0.999 * uniform(random),
                     p = (k_azimuths - 1) * uniform(random), turn = 7 * uniform(random);
        const double phi = p / (k_azimuths - 1) * k_pi * (i % 2 ? 1 : -1);
        const Vec3f wl = to_float(spherical(l / k_polar * k_pi / 2, turn));
        const Vec3f wv = to_float(spherical(v / k_polar * k_pi / 2, turn + phi));
        const Rgb f = signed_value(t, wl, wv), clamped = value(t, wl, wv);
        const double last = k_polar - 1;
        for (int c = 0; c < 3; ++c) {
            const double expected = function_at(std::min(l, last), std::min(v, last), p, c);
            EXPECT_WITHIN(f[c], expected, 2e-4 * std::abs(expected) + 1e-4);
            EXPECT_EQ(clamped[c], std::max(f[c], 0.0f));
        }
    }
    // The first index is that of the light, the second that of the viewer.
    const Vec3f up{0, 0, 1}, aside = to_float(spherical(k_pi / 4, 0.0));
    EXPECT_WITHIN(value(t, aside, up).r, function_at(4.5, 0, 0, 0), 1e-4);
    EXPECT_WITHIN(value(t, up, aside).r, function_at(0, 4.5, 0, 0), 1e-4);
    // The last azimuth is that of the mirror direction, the first that of the light.
    EXPECT_WITHIN(value(t, aside, mirror(aside)).g, function_at(4.5, 4.5, k_azimuths - 1, 1), 1e-3);
    EXPECT_WITHIN(value(t, aside, aside).g, function_at(4.5, 4.5, 0, 1), 1e-3);
}

TEST(Mbsdf, IsReadByItsContent) {
    const auto measured = checked(read_measured(small_mbsdf(), "t"));
    EXPECT_EQ(measured->format, "MBSDF");
    EXPECT_TRUE(is_isotropic(*measured));
    const auto& t = std::get<MbsdfTable>(measured->table);
    EXPECT_EQ(t.metadata, (std::vector<MbsdfTable::Entry>{{"material", "blue \"paint\""}}));
    const auto grey = checked(read_mbsdf(grey_mbsdf(), "t"));
    EXPECT_TRUE(grey->grey);
    EXPECT_EQ(grey->cells.size(), 2u * 2 * 3);
    EXPECT_EQ(grey->cells[4], (Rgb{1.25f, 1.25f, 1.25f}));
}

/// Tables of one angle are constant in it.
TEST(Mbsdf, MayHaveOneSample) {
    const auto t = checked(read_mbsdf(
        mbsdf_file("", {mbsdf_block("MBSDF_DATA=", 1, 1, 1, [](int, int, int, int) { return 0.375; })}), "t"));
    std::mt19937_64 random(3);
    for (int i = 0; i < 100; ++i) {
        const Vec3f wl = to_float(random_direction(random, 1e-4)), wv = to_float(random_direction(random, 1e-4));
        EXPECT_RGB_WITHIN(value(*t, wl, wv), (Rgb{0.375f, 0.375f, 0.375f}), 1e-6);
    }
}

TEST(Mbsdf, MasksValuesThatAreNotFinite) {
    for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
        const auto with_one_bad = [&](int i, int j, int, int c) { return i == 1 && j == 2 && c == 1 ? bad : 0.5; };
        const auto t = checked(read_mbsdf(mbsdf_file("", {mbsdf_block(k_reflection, 4, 5, 3, with_one_bad)}), "t"));
        EXPECT_EQ(t->masked, 5u);
        const auto value_at = [&](double theta_l, double theta_v) {
            return value(*t, to_float(spherical(theta_l * k_degree, 0.1)),
                         to_float(spherical(theta_v * k_degree, 2.0)));
        };
        const Rgb near_it = value_at(25, 40);
        for (int c = 0; c < 3; ++c) EXPECT_TRUE(std::isnan(near_it[c]));
        EXPECT_RGB_WITHIN(value_at(60, 10), (Rgb{0.5f, 0.5f, 0.5f}), 1e-6);
    }
    const double nan = std::nan("");
    EXPECT_EQ(error_text(read_measured(
                  mbsdf_file("", {mbsdf_block(k_reflection, 2, 2, 3, [&](int, int, int, int) { return nan; })}), "f")),
              "f: at 55: MBSDF samples: expected at least one that is finite, found none");
}

/// Every rule of the format that a file may break, and where.
TEST(Mbsdf, ReportsErrorsInOneLine) {
    const auto f = [](int, int, int, int) { return 0.5; };
    const Bytes block = mbsdf_block(k_reflection, 2, 3, 1, f),
                through = mbsdf_block("MBSDF_DATA_TRANSMISSION=", 2, 3, 1, f);
    const auto error_of = [](const Bytes& bytes) { return error_text(read_measured(bytes, "f")); };
    const auto error_of_lines = [&](const std::string& lines) { return error_of(mbsdf_file(lines, {block})); };
    EXPECT_EQ(error_of_lines("a=\"b\"\nc=\"\"\na=\"\\n\\\\\\\"\"\n"), "");
    EXPECT_EQ(error_of_lines("a\n"),
              "f: at 20: MBSDF header: expected a line key=\"value\" or the head of a block, found 'a'");
    EXPECT_CONTAINS(error_of_lines("=\"b\"\n"), "at 20: MBSDF header: expected a line key");
    EXPECT_CONTAINS(error_of_lines("a=b\n"), "at 20: MBSDF header: expected a line key");
    EXPECT_EQ(error_of_lines("a=\"b\\t\"\n"),
              "f: at 24: MBSDF header: expected one of \\n, \\\" and \\\\, found '\\t'");
    EXPECT_CONTAINS(error_of_lines("a=\"b\\\n"), "at 24: MBSDF header: expected one of");
    EXPECT_EQ(error_of_lines("a=\"b\n"),
              "f: at 24: MBSDF header: expected a quotation mark that ends the value, found the end of the line");
    EXPECT_EQ(error_of_lines("a=\"b\"c\n"),
              "f: at 25: MBSDF header: expected the end of the line after the value, found 'c'");
    EXPECT_EQ(error_of_lines("a=\"b\"\nc=\"\x1b[2J\"\n"),
              "f: at 29: MBSDF header: expected printable characters, found the byte 1b");

    Bytes next = mbsdf_file("", {block});
    next[18] = std::byte('2');
    EXPECT_EQ(error_of(next),
              "f: at 0: MBSDF file: expected the line 'NVIDIA ARC MBSDF V1', found 'NVIDIA ARC MBSDF V2'");
    EXPECT_EQ(error_of(mbsdf_file("a=\"b\"\n", {})),
              "f: at 26: MBSDF header: expected a block, headed MBSDF_DATA_REFLECTION=, found the end of the file");
    EXPECT_EQ(error_of(mbsdf_file("", {through})),
              "f: at 20: MBSDF file: expected a block of reflection, found transmission alone");
    EXPECT_EQ(error_of(mbsdf_file("", {through, block})), error_of(mbsdf_file("", {through})));
    EXPECT_EQ(error_of(mbsdf_file("", {block, block})),
              "f: at 103: after the MBSDF block of reflection: expected the end of the file, or "
              "MBSDF_DATA_TRANSMISSION=, found 83 bytes");
    EXPECT_EQ(error_text(read_measured(mbsdf_file("", {block, through, Bytes(5)}), "f")),
              "f: at 188: after the MBSDF block of transmission: expected the end of the file, found 5 bytes");
    Bytes cut = mbsdf_file("", {block, through});
    cut.pop_back();
    EXPECT_EQ(error_of(cut), "f: at 140: MBSDF block of 2 x 2 x 3 x 1 numbers: expected 48 bytes, found 47 bytes");
    cut.resize(135);
    EXPECT_EQ(
        error_of(cut),
        "f: at 128: MBSDF block: expected type and numbers of angles in 12 bytes, found the end of the file after 7");
}

TEST(Mbsdf, RefusesSizesBeyondTheFile) {
    const auto error_with = [](std::size_t number, std::uint32_t n) {
        Bytes bytes = mbsdf_file("", {mbsdf_block(k_reflection, 2, 3, 1, [](int, int, int, int) { return 0.5; })});
        std::memcpy(&bytes[43 + 4 * number], &n, sizeof n);
        return error_text(read_measured(bytes, "f"));
    };
    EXPECT_EQ(error_with(0, 2), "f: at 43: type of an MBSDF block: expected 0 (grey) or 1 (RGB), found 2");
    EXPECT_EQ(error_with(0, 1), "f: at 55: MBSDF block of 2 x 2 x 3 x 3 numbers: expected 144 bytes, found 48 bytes");
    for (const std::uint32_t n : {0u, 4097u, 0x80000000u, ~0u}) {
        EXPECT_CONTAINS(error_with(1, n),
                        "at 47: dimensions of an MBSDF block: expected each between 1 and 4096, found");
        EXPECT_CONTAINS(error_with(2, n), "at 47: dimensions of an MBSDF block");
    }
    EXPECT_CONTAINS(error_with(1, 4096), "expected 201326592 bytes, found 48 bytes");
}

/// NVIDIA's own files say where the samples stand (docs/formats.md#mbsdf).
class CarPaint : public testing::TestWithParam<const char*> {
  protected:
    void SetUp() override {
        const auto path = shared_data() / "mdl" / GetParam();
        if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
        bytes_ = *read_file(path.string());
        const auto read = checked(read_mbsdf(bytes_, path.string()));
        table_ = *read;
    }
    double sum_of_channels(std::size_t i, std::size_t j, std::size_t k) const {
        const Rgb& f = table_.cells[(i * table_.polar + j) * table_.azimuths + k];
        return double(f.r) + double(f.g) + double(f.b);
    }
    Bytes bytes_;
    MbsdfTable table_;
};

TEST_P(CarPaint, IsWrittenAgainByteForByte) {
    EXPECT_EQ(table_.polar, 45u);
    EXPECT_EQ(table_.azimuths, 90u);
    EXPECT_EQ(write_mbsdf(table_), bytes_);
}

/// The mirror direction has the last azimuth.
TEST_P(CarPaint, HasItsHighlightAtTheLastAzimuth) {
    for (std::size_t i = 6; i < 33; ++i) {
        EXPECT_GT(sum_of_channels(i, i, table_.azimuths - 1), 50 * sum_of_channels(i, i, 0)) << i;
        EXPECT_GE(sum_of_channels(i, i, table_.azimuths - 1), sum_of_channels(i, i, table_.azimuths - 2)) << i;
    }
}

INSTANTIATE_TEST_SUITE_P(Mdl, CarPaint, testing::Values("carpaint_blue.mbsdf", "carpaint_green.mbsdf"),
                         [](const auto& file) { return file.index == 0 ? "Blue" : "Green"; });

}  // namespace
}  // namespace srbf::mbsdf_test
