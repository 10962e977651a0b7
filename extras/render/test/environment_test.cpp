// Environment maps: their files, and importance sampling.
#include "extras/render/environment.h"

#include "extras/render/exr.h"
#include "properties.h"
#include "srbf/file.h"
#include "statistics.h"
#include "temporary_folder.h"

namespace srbf::environment_test {
namespace {

/// A picture of smooth, coloured light with a bright texel.
Image texels(int width, int height) {
    Image image(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            image.at(x, y) = {0.25f + 0.5f * float(x) / float(width), 0.5f, float(y) / float(height)};
    image.at(width / 3, height / 4) = {40, 30, 20};
    return image;
}

std::array<unsigned char, 4> encoded(Rgb c) {
    const float peak = std::max({c.r, c.g, c.b});
    if (peak <= 0) return {0, 0, 0, 0};
    int exponent = 0;
    std::frexp(peak, &exponent);
    const auto mantissa = [&](float x) { return static_cast<unsigned char>(std::ldexp(x, 8 - exponent)); };
    return {mantissa(c.r), mantissa(c.g), mantissa(c.b), static_cast<unsigned char>(exponent + 128)};
}
/// A Radiance file, its rows flat or as runs and literals.
std::string hdr(const Image& image, bool runs) {
    std::string file = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y " + std::to_string(image.height) + " +X " +
                       std::to_string(image.width) + "\n";
    for (int y = 0; y < image.height; ++y) {
        if (runs) file += {2, 2, char(image.width >> 8), char(image.width & 255)};
        for (std::size_t c = 0; c < (runs ? 4u : 1u); ++c)
            for (int x = 0; x < image.width;) {
                if (!runs) {
                    for (const unsigned char byte : encoded(image.at(x, y))) file += char(byte);
                    ++x;
                    continue;
                }
                const unsigned char first = encoded(image.at(x, y))[c];
                int length = 1;
                while (x + length < image.width && length < 127 && encoded(image.at(x + length, y))[c] == first)
                    ++length;
                if (length > 1)
                    file += {char(128 + length), char(first)};
                else
                    file += {char(1), char(first)};
                x += length;
            }
    }
    return file;
}

void expect_near(const Image& a, const Image& b, double tolerance) {
    ASSERT_EQ(a.width, b.width);
    ASSERT_EQ(a.height, b.height);
    for (std::size_t i = 0; i < a.pixels.size(); ++i)
        ASSERT_RGB_WITHIN(a.pixels[i], b.pixels[i],
                          tolerance * (1 + double(std::max({b.pixels[i].r, b.pixels[i].g, b.pixels[i].b}))));
}

TEST(Environment, RadianceFilesAreRead) {
    const Image image = texels(24, 12);
    for (const bool runs : {false, true}) {
        const std::string file = hdr(image, runs);
        const auto read = checked(read_hdr(as_bytes(file), "a.hdr"));
        expect_near(*read, image, 1.0 / 128);
        EXPECT_TRUE(read_environment(as_bytes(file), "a.hdr").ok());
    }
}

TEST(Environment, EveryTruncationIsAnError) {
    for (const bool runs : {false, true}) {
        const std::string file = hdr(texels(9, 4), runs);
        for (std::size_t length = 0; length < file.size(); ++length) {
            const auto read = read_environment(as_bytes(file.substr(0, length)), "a.hdr");
            ASSERT_FALSE(read.ok()) << length;
            EXPECT_EQ(message(read.error()).rfind("a.hdr: ", 0), 0u);
            EXPECT_LACKS(message(read.error()), "\n");
        }
    }
}

TEST(Environment, SpoiltBytesAreErrorsOrOtherPictures) {
    for (const bool runs : {false, true}) {
        const std::string file = hdr(texels(9, 4), runs);
        for (std::size_t at = 0; at < file.size(); ++at)
            for (const int by : {1, 0x80, 0xff}) {
                std::string spoilt = file;
                spoilt[at] = char(spoilt[at] ^ by);
                const auto read = read_environment(as_bytes(spoilt), "a.hdr");
                if (read) {
                    EXPECT_LE(read->texels().pixels.size(), 1000u);
                }
            }
    }
}

TEST(Environment, SizesBeyondTheFileAreErrorsBeforeAnythingIsAllocated) {
    for (const char* size : {"-Y 60000 +X 60000", "-Y 9999999999 +X 9999999999", "-Y 0 +X 4", "-Y -3 +X 4", "-Y 4",
                             "+Y 4 +X 4", "-Y 4 -X 4", "", "-Y 1e3 +X 4"}) {
        const std::string file = std::string("#?RADIANCE\n\n") + size + "\n" + std::string(64, 'x');
        EXPECT_FALSE(read_hdr(as_bytes(file), "a.hdr").ok()) << size;
    }
    EXPECT_FALSE(read_hdr(as_bytes("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n1234"), "a.hdr").ok());
}

TEST(Environment, AFileOfGigabytesIsRefusedByItsHeader) {
    const TemporaryFolder folder;
    // Holes: nothing is written, and nothing of it is read.
    const auto grown = [&](const std::string& name, std::span<const std::byte> start) {
        EXPECT_TRUE(write_file(folder / name, start).ok());
        std::filesystem::resize_file(folder / name, std::uint64_t(1) << 32);
        const auto read = load_environment(folder / name);
        return read.ok() ? "read" : message(read.error());
    };
    const std::string large = "#?RADIANCE\n\n-Y 32768 +X 32768\n";
    EXPECT_CONTAINS(grown("a.hdr", as_bytes(large)), "a.hdr: at 12: resolution");
    // A header of few texels: only what they can take is read.
    EXPECT_EQ(grown("b.hdr", as_bytes("#?RADIANCE\n\n-Y 2 +X 2\n")), "read");
    EXPECT_CONTAINS(grown("c.hdr", as_bytes("nothing")), "c.hdr: at 0: first bytes");

    ASSERT_TRUE(write_exr(13, 7, channels_of(texels(13, 7)), folder / "a.exr").ok());
    auto bytes = *read_file(folder / "a.exr");
    const std::string_view name("dataWindow");
    const auto at = std::search(bytes.begin(), bytes.end(), as_bytes(name).begin(), as_bytes(name).end());
    ASSERT_NE(at, bytes.end());
    *(at + 21 + 10) = *(at + 21 + 14) = std::byte(1);  // 65536 columns and rows more
    EXPECT_CONTAINS(grown("b.exr", bytes), "dataWindow: expected 1 to 67108864 pixels, found 65549 x 65543");
}

TEST(Environment, ExrFilesAreWrittenAndReadBack) {
    const TemporaryFolder folder;
    Image image = texels(13, 7);
    image.at(3, 3) = {-2, 1e-20f, 3e30f};
    std::vector<Channel> channels = channels_of(image);
    channels.push_back({"Z", std::vector<float>(13 * 7, 4)});
    ASSERT_TRUE(write_exr(13, 7, channels, folder / "a.exr").ok());
    const auto bytes = read_file(folder / "a.exr");
    const auto read = checked(read_exr(*bytes, "a.exr"));
    EXPECT_EQ(read->pixels, image.pixels);

    for (std::size_t length = 0; length + 1 < bytes->size(); length += length < 400 ? 1 : 7)
        EXPECT_FALSE(read_exr(std::span(*bytes).first(length), "a.exr").ok()) << length;
    for (std::size_t at = 0; at < bytes->size(); at += at < 400 ? 1 : 7) {
        auto spoilt = *bytes;
        spoilt[at] ^= std::byte(0xff);
        const auto other = read_exr(spoilt, "a.exr");
        if (!other) {
            EXPECT_LACKS(message(other.error()), "\n");
        }
    }
    EXPECT_FALSE(write_exr(13, 7, channels, folder / "missing/a.exr").ok());
    EXPECT_FALSE(read_exr(as_bytes("no EXR"), "a.exr").ok());
}

TEST(Environment, ExrWithoutColourIsAnError) {
    const TemporaryFolder folder;
    const Channel depth{"Z", std::vector<float>(6, 1)};
    ASSERT_TRUE(write_exr(3, 2, std::span(&depth, 1), folder / "a.exr").ok());
    EXPECT_FALSE(read_exr(*read_file(folder / "a.exr"), "a.exr").ok());
}

TEST(Environment, NumbersThatAreNoRadianceCountAsZero) {
    Image image(4, 2, {1, 1, 1});
    image.at(0, 0).r = -1;
    image.at(1, 0) = {NAN, NAN, 1};
    image.at(2, 1).b = INFINITY;
    const Environment environment(image);
    EXPECT_EQ(environment.clamped(), 3u);
    EXPECT_EQ(environment.texels().at(0, 0), (Rgb{0, 1, 1}));
    EXPECT_EQ(environment.texels().at(1, 0), (Rgb{0, 0, 1}));
    EXPECT_EQ(environment.texels().at(2, 1), (Rgb{1, 1, 0}));
    EXPECT_EQ(Environment(Image(4, 2, {1, 2, 3})).clamped(), 0u);
}

TEST(Environment, TexelsLieWhereTheFormulaSays) {
    Image image(16, 8);
    image.at(8, 3) = {1, 1, 1};  // right of the middle, just above the horizon
    const Environment environment(image);
    const double phi = (8.5 / 16 - 0.5) * 2 * k_pi, theta = 3.5 / 8 * k_pi;
    const Vec3d w{std::sin(theta) * std::sin(phi), std::cos(theta), -std::sin(theta) * std::cos(phi)};
    EXPECT_WITHIN(double(environment.at(to_float(w)).radiance.g), 1, 1e-4);
    EXPECT_LT(w.z, 0);  // the middle is along -z, +x to its right
    EXPECT_GT(w.x, 0);
    EXPECT_EQ(environment.at({0, -1, 0}).radiance, Rgb{});
    EXPECT_EQ(environment.at({0, 0, 1}).radiance, Rgb{});
}

TEST(Environment, DrawsFollowTheDensityWhichIntegratesToOne) {
    const Environment environment(texels(12, 6));
    PolarBins bins{{0, 1, 0}, {}, 12};  // the texels
    for (int i = 0; i <= 6; ++i) bins.edge.push_back(1 - std::cos(k_pi * i / 6));
    const auto pdf = [&](Vec3d w) { return double(environment.at(to_float(w)).pdf); };
    double sum = 0;
    for (const double mass : bins.integrals(pdf, 64)) sum += mass;
    EXPECT_WITHIN(sum, 1, 1e-3);
    std::mt19937_64 random(1);
    const auto draw = [&] {
        const double u1 = uniform(random), u2 = uniform(random);
        return to_double(environment.sample(float(u1), float(u2)));
    };
    EXPECT_GT(sampler_p_value(bins, pdf, 40000, draw), 0.01);
    const Environment other(Image(12, 6, {1, 1, 1}));
    EXPECT_LT(sampler_p_value(
                  bins, [&](Vec3d w) { return double(other.at(to_float(w)).pdf); }, 40000, draw),
              1e-6);
}

TEST(Environment, AreaOfTheWarpTimesTheDensityIsOne) {
    const Environment environment(texels(12, 6));
    std::mt19937_64 random(2);
    int smooth = 0;
    for (int i = 0; i < 300; ++i) {
        const double u1 = 0.01 + 0.98 * uniform(random), u2 = 0.01 + 0.98 * uniform(random), h = 1e-3;
        const auto at = [&](double d1, double d2) {
            return to_double(environment.sample(float(u1 + d1), float(u2 + d2)));
        };
        const Vec3d by1 = (0.5 / h) * (at(h, 0) - at(-h, 0)), by2 = (0.5 / h) * (at(0, h) - at(0, -h)),
                    area = cross(by1, by2);
        const double product = std::sqrt(dot(area, area)) * double(environment.at(to_float(at(0, 0))).pdf);
        smooth += near(product, 1, 0.01);  // not where the step leads to the next texel
    }
    EXPECT_GT(smooth, 200);
}

TEST(Environment, LitTexelsAreSampled) {
    Image image(8, 4);
    image.at(0, 1) = {0, 1, 0};  // its neighbours share in it, the one across the seam too
    const Environment environment(image);
    std::mt19937_64 random(4);
    int lit = 0;
    for (int i = 0; i < 2000; ++i) {
        const auto light = environment.at(to_float(random_direction(random)));
        if (light.radiance.g > 0) {
            EXPECT_GT(light.pdf, 0);
        }
        lit += light.radiance.g > 0;
    }
    EXPECT_GT(lit, 100);
}

TEST(Environment, BlackIsDetectedAndAConstantIsUniform) {
    const Environment black(Image(5, 3)), constant(Image(7, 4, {2, 3, 4}));
    EXPECT_TRUE(black.is_black());
    EXPECT_FALSE(constant.is_black());
    EXPECT_EQ(black.at({0, 1, 0}).pdf, 0);
    std::mt19937_64 random(5);
    for (int i = 0; i < 100; ++i) {
        const Rgb c = constant.at(to_float(random_direction(random))).radiance;
        EXPECT_WITHIN(double(c.r), 2, 1e-5);
        EXPECT_WITHIN(double(c.b), 4, 1e-5);
    }
}

TEST(Environment, BundledPictureIsPartOfTheProgram) {
    const auto studio = checked(load_environment("studio"));
    EXPECT_EQ(studio->texels().width, 512);
    EXPECT_EQ(studio->texels().height, 256);
    EXPECT_EQ(studio->clamped(), 0u);
    EXPECT_FALSE(studio->is_black());
    const auto file = load_environment((bundled_data() / "studio.hdr").string());
    EXPECT_EQ(file->texels(), studio->texels());
    EXPECT_FALSE(load_environment("missing.hdr").ok());
}

}  // namespace
}  // namespace srbf::environment_test
