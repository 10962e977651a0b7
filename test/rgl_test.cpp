// RGL measurements: agreement with the authors' loader, the formula, and the warp.
#include <map>

#include "brdf/colour.h"
#include "measured/formats/warp.h"
#include "measured/readers.h"
#include "measured/tables.h"
#include "measured_files.h"

namespace srbf::rgl_test {
namespace {

const RglTable& bundled_rgl(const std::string& name) { return std::get<RglTable>(bundled(name + "_rgb").table); }

const std::vector<std::string> k_bundled{"paper_white", "cc_ibiza_sunset"};

/// Expects each row within 1e-4, or 2e-6 absolute, of the value from the authors' own loader.
void expect_agreement(const std::filesystem::path& measurement, const std::filesystem::path& reference) {
    const auto measured = checked(load_measured(measurement.string()));
    EXPECT_EQ(measured->format, "RGL");
    EXPECT_EQ(measured->bytes, std::filesystem::file_size(measurement));
    const auto rows = read_reference(reference);
    ASSERT_GE(rows.size(), 500u);
    for (const auto& [wl, wv, expected] : rows) {
        const Rgb f = value(*measured, wl, wv);
        EXPECT_RGB_WITHIN_RELATIVE(f, expected, 1e-4, 2e-6) << measurement;
    }
}

TEST(Rgl, AgreesWithTheAuthorsLoader) {
    for (const auto& name : k_bundled)
        expect_agreement(bundled_data() / (name + "_rgb.bsdf"), bundled_data() / (name + "_rgb.csv"));
}

TEST(Rgl, AgreesWithTheAuthorsLoaderOnAllMeasurements) {
    const auto folder = shared_data() / "rgl";
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not here";
    for (const char* name :
         {"cc_ibiza_sunset", "cg_sunflower", "colodur_napoli_4f", "paper_white", "vch_golden_yellow"})
        expect_agreement(folder / (name + std::string("_rgb.bsdf")),
                         folder / "reference" / (name + std::string("_rgb.csv")));
}

TEST(Rgl, ComputesItsFormula) {
    const auto table = checked(read_rgl(tensor_file(simple_rgl()), "simple"));
    EXPECT_EQ(table->description, "test");
    std::mt19937_64 random(3);
    for (int i = 0; i < 5000; ++i) {
        const Vec3d wl = random_direction(random, 0.01), wv = random_direction(random, 0.01), h = wl + wv;
        const double u_h = std::sqrt(std::acos(normalize(h).z) * 2 / k_pi), u_l = std::sqrt(std::acos(wl.z) * 2 / k_pi);
        const double azimuth = std::remainder(std::atan2(h.y, h.x) - std::atan2(wl.y, wl.x), 2 * k_pi);
        const double scale = (1 + u_h) / (4 * (1 - u_l / 2) * wv.z), w_y = (azimuth + k_pi) / (2 * k_pi);
        const Rgb f = signed_value(*table, to_float(wl), to_float(wv));
        EXPECT_WITHIN(f.r, scale * u_h, 1e-4 * scale);
        EXPECT_WITHIN(f.g, scale * w_y, 1e-4 * scale);
        EXPECT_WITHIN(f.b, scale * (u_h - 0.5), 1e-4 * scale);
        const Rgb clamped = value(*table, to_float(wl), to_float(wv));
        EXPECT_EQ(clamped.b, std::max(f.b, 0.0f));
        EXPECT_EQ(clamped.r, f.r);
    }
}

TEST(Rgl, ColourIsTheValueIfThereIsNoJacobian) {
    auto fields = simple_rgl();
    field(fields, "jacobian").numbers[0] = std::byte(0);
    const auto plain = checked(read_rgl(tensor_file(fields), "plain"));
    std::mt19937_64 random(8);
    for (int i = 0; i < 2000; ++i) {
        const Vec3d wl = random_direction(random, 0.01), wv = random_direction(random, 0.01), h = wl + wv;
        const double u_h = std::sqrt(std::acos(normalize(h).z) * 2 / k_pi);
        const Rgb f = signed_value(*plain, to_float(wl), to_float(wv));
        EXPECT_WITHIN(f.r, u_h / wv.z, 1e-4 / wv.z);
        EXPECT_WITHIN(f.b, (u_h - 0.5) / wv.z, 1e-4 / wv.z);
    }
}

/// A synthetic file, since no spectral file is available.
TEST(Rgl, SpectraBecomeColours) {
    const auto spectral = read_rgl(tensor_file(spectral_rgl()), "spectral"),
               rgb = read_rgl(tensor_file(simple_rgl()), "rgb");
    ASSERT_TRUE(spectral.ok()) << message(spectral.error());
    EXPECT_EQ(spectral->wavelengths, (std::vector<float>{450, 550, 600}));
    const auto weights = rgb_weights(spectral->wavelengths);
    std::mt19937_64 random(9);
    for (int i = 0; i < 2000; ++i) {
        const Vec3f wl = to_float(random_direction(random, 0.05)), wv = to_float(random_direction(random, 0.05));
        // simple_rgl's channels are the spectrum at the three wavelengths.
        const Rgb channels = signed_value(*rgb, wl, wv), f = signed_value(*spectral, wl, wv);
        const std::vector<float> spectrum{channels.r, channels.g, channels.b};
        const Rgb expected = to_rgb(spectrum, weights);
        EXPECT_RGB_WITHIN_RELATIVE(f, expected, 1e-4, 0.0001);
        std::vector<float> looked_up(3);
        signed_spectrum(*spectral, wl, wv, looked_up);
        EXPECT_RGB_WITHIN_RELATIVE(looked_up, spectrum, 1e-4, 0.0001);
    }
    const Measured measured{"", "", 0, *spectral};
    const Vec3f below{0.6f, 0, -0.8f}, above{0.6f, 0, 0.8f}, mirrored = mirror(above);
    std::vector<float> f(3, -1.0f);
    spectra(measured).evaluate({&above, 1}, {&below, 1}, f);
    EXPECT_EQ(f, (std::vector<float>{0, 0, 0}));
    signed_spectra(measured).evaluate({&above, 1}, {&mirrored, 1}, f);
    EXPECT_LT(f[2], -0.1f);
    spectra(measured).evaluate({&above, 1}, {&mirrored, 1}, f);
    EXPECT_EQ(f[2], 0);
    EXPECT_TRUE(wavelengths(measured_of(*rgb)).empty());
}

/// A synthetic file, since no anisotropic file is available. Expected values are the formula of `anisotropic_rgl`
/// in double.
TEST(Rgl, AnisotropicTablesComputeTheirFormula) {
    std::mt19937_64 random(10);
    for (const int symmetry : {1, 2, 4}) {
        const auto table = checked(read_rgl(tensor_file(anisotropic_rgl(symmetry)), "anisotropic"));
        EXPECT_EQ(table->symmetry, symmetry);
        EXPECT_FALSE(is_isotropic(measured_of(*table)));
        for (int i = 0; i < 5000; ++i) {
            Vec3d wl = random_direction(random, 0.01), wv = random_direction(random, 0.01);
            const Rgb f = signed_value(*table, to_float(wl), to_float(wv));
            // Reduced by symmetry: rotated by π, or mirrored at both axes.
            if (symmetry == 2 && wl.y > 0) {
                wl = mirror(wl);
                wv = mirror(wv);
            }
            if (symmetry == 4 && wl.y > 0) {
                wl.y = -wl.y;
                wv.y = -wv.y;
            }
            if (symmetry == 4 && wl.x > 0) {
                wl.x = -wl.x;
                wv.x = -wv.x;
            }
            const Vec3d h = normalize(wl + wv);
            const double u_h = std::sqrt(std::acos(h.z) * 2 / k_pi), u_l = std::sqrt(std::acos(wl.z) * 2 / k_pi);
            const double t_h = (std::atan2(h.y, h.x) + k_pi) / (2 * k_pi),
                         t_l = (std::atan2(wl.y, wl.x) + k_pi) / (2 * k_pi);
            const double scale = (1 + u_h + t_h) / (4 * (1 - u_l / 2 + t_l / 4) * wv.z);
            const double theta_nodes[] = {0, 0.7, 1.55}, theta = std::min(std::acos(wl.z), 1.55);
            const double j =
                theta < 0.7 ? theta / 0.7 : 1 + (theta - theta_nodes[1]) / (theta_nodes[2] - theta_nodes[1]);
            EXPECT_WITHIN(f.r, scale * u_h, 1e-4 * scale);
            EXPECT_WITHIN(f.g, scale * t_h, 1e-4 * scale);
            EXPECT_WITHIN(f.b, scale * (1 + t_l * 4 * symmetry / 2 + j), 1e-3 * scale);
        }
    }
}

TEST(Rgl, WarpMapsTheSquareToItselfWithItsDensity) {
    std::mt19937_64 random(4);
    for (const auto& name : k_bundled) {
        const RglTable& table = bundled_rgl(name);
        for (int i = 0; i < 20000; ++i) {
            const Slices slices = slices_at(table.theta_l, float(k_pi / 2 * uniform(random)));
            const Warped any = unwarp(table.visible, slices, float(uniform(random)), float(uniform(random)));
            EXPECT_TRUE(any.x >= 0 && any.x <= 1 && any.y >= 0 && any.y <= 1 && any.density >= 0);
            // Within a cell the warp is quadratic, so a central difference is the exact derivative.
            const float cells_x = float(table.visible.width - 1), cells_y = float(table.visible.height - 1);
            const float x = (std::floor(float(uniform(random)) * cells_x) + 0.5f) / cells_x, dx = 0.4f / cells_x;
            const float y = (std::floor(float(uniform(random)) * cells_y) + 0.5f) / cells_y, dy = 0.4f / cells_y;
            const double along_x =
                double(unwarp(table.visible, slices, x + dx, y).x) - double(unwarp(table.visible, slices, x - dx, y).x);
            const double along_y =
                double(unwarp(table.visible, slices, x, y + dy).y) - double(unwarp(table.visible, slices, x, y - dy).y);
            const double jacobian = along_x * along_y / (4 * double(dx) * double(dy));
            const double density = double(unwarp(table.visible, slices, x, y).density);
            EXPECT_WITHIN(jacobian, density, 1e-3 * (0.1 + density));
        }
    }
}

TEST(Rgl, WarpStaysInTheSquareWithoutDensity) {
    auto fields = simple_rgl();
    field(fields, "vndf") = float_field("vndf", {1, 3, 4, 5}, [](std::size_t i) { return i % 20 < 5 ? 1.0f : 0.0f; });
    const auto table = checked(read_rgl(tensor_file(fields), "f"));
    std::mt19937_64 random(7);
    for (int i = 0; i < 5000; ++i) {
        const Slices slices = slices_at(table->theta_l, float(2 * uniform(random)));
        const Warped w = unwarp(table->visible, slices, float(uniform(random)), float(uniform(random)));
        EXPECT_TRUE(w.x >= 0 && w.x <= 1 && w.y >= 0 && w.y <= 1 && w.density >= 0);
        const Vec3f wl = direction_with_extremes(random), wv = direction_with_extremes(random);
        EXPECT_TRUE(satisfies_contract(value(*table, wl, wv), wl, wv, false));
    }
}

TEST(Rgl, IsIsotropicAndBounded) {
    std::mt19937_64 random(5);
    for (const auto& name : k_bundled) {
        const RglTable& table = bundled_rgl(name);
        for (int i = 0; i < 30000; ++i) {
            const Vec3f wl = direction_with_extremes(random), wv = direction_with_extremes(random);
            const Rgb f = value(table, wl, wv);
            ASSERT_TRUE(satisfies_contract(f, wl, wv, false));
            const double angle = 6 * uniform(random);
            const Vec3f rotated_l = rotate(wl, angle), rotated_v = rotate(wv, angle);
            const Rgb rotated = value(table, rotated_l, rotated_v);
            const double sine_h = std::hypot(double(wl.x + wv.x), double(wl.y + wv.y));
            if (wl.z < 0.02f || wv.z < 0.02f || wl.z > 0.999f || sine_h < 0.05) continue;
            EXPECT_RGB_WITHIN_RELATIVE(rotated, f, 1e-3, 1e-5);
        }
        for (const float z : {1e-30f, 1e-42f})
            EXPECT_TRUE(is_finite(value(table, {1, 0, z}, {-1, 0, z})) &&
                        is_finite(value(table, {1, 0, z}, {0, 1, z})));
    }
}

TEST(Rgl, BatchesAgreeWithSingleValues) {
    std::mt19937_64 random(11);
    std::vector<RglTable> tables;
    for (const auto& name : k_bundled) tables.push_back(bundled_rgl(name));
    tables.push_back(*read_rgl(tensor_file(simple_rgl()), "s"));
    tables.push_back(*read_rgl(tensor_file(anisotropic_rgl()), "a"));
    for (const RglTable& table : tables) {
        float largest = 0;
        for (const Rgb& c : table.colour.nodes)
            largest = std::max({largest, std::abs(c.r), std::abs(c.g), std::abs(c.b)});
        for (const std::size_t count : {std::size_t(0), std::size_t(1), std::size_t(37), std::size_t(20000)}) {
            std::vector<Vec3f> wl, wv;
            for (std::size_t i = 0; i < count; ++i) {
                wl.push_back(direction_with_extremes(random));
                wv.push_back(i % 5 == 0   ? mirror(wl.back())
                             : i % 7 == 0 ? to_float(random_direction(random))
                                          : direction_with_extremes(random));
            }
            std::vector<Rgb> f(count);
            evaluate_signed(table, wl, wv, f);
            for (std::size_t i = 0; i < count; ++i) {
                const Rgb expected = signed_value(table, wl[i], wv[i]);
                const double z = std::max(1e-9, double(wv[i].z));
                for (int c = 0; c < 3; ++c)
                    EXPECT_WITHIN(f[i][c], expected[c],
                                  1e-4 * std::abs(double(expected[c])) + 1e-5 * double(largest) / z);
            }
        }
    }
}

/// Along the normal, which has no azimuth, the value of a table is the mean over the azimuths near it.
TEST(Tables, HaveTheirMeanAlongTheNormal) {
    MbsdfTable mbsdf;
    mbsdf.polar = 4;
    mbsdf.azimuths = 5;
    for (int i = 0; i < 80; ++i) mbsdf.cells.push_back({1, 1 + float(i % 5), 1});
    const RglTable film = bundled_rgl("cc_ibiza_sunset"), turned = *read_rgl(tensor_file(anisotropic_rgl()), "t");
    for (const Measured& measured : {measured_of(film), measured_of(turned), measured_of(mbsdf)}) {
        const Vec3f normal{0, 0, 1}, w = to_float(spherical(0.9, 0.2));
        Rgb mean, f;
        for (int k = 0; k < 64; ++k)
            mean.g += signed_value(measured, to_float(spherical(1e-4, 2 * k_pi * k / 64)), w).g / 64;
        signed_evaluator(measured)({&normal, 1}, {&w, 1}, {&f, 1});
        EXPECT_WITHIN_RELATIVE(f.g, mean.g, 0.02);
        EXPECT_EQ(signed_value(measured, normal, w), f);
    }
}

}  // namespace
}  // namespace srbf::rgl_test
