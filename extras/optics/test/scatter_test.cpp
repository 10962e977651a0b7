// Files of Zemax, Speos and OpenMATERIAL, and goniometer columns: values, round trips, and refused files.
#include "extras/optics/scatter.h"

#include <fmt/format.h>

#include "bad_texts.h"
#include "brdf/colour.h"
#include "brdf/directions.h"
#include "brdf/parts.h"
#include "measured/tables.h"
#include "peaks.h"
#include "srbf/file.h"
#include "srbf/load.h"

namespace srbf::scatter_test {
namespace {

const auto read = [](const std::string& text, const ReadOptions& options = {}) {
    return read_measured(as_bytes(text), "f", options);
};

/// A lobe several degrees wide around the mirror direction, over a floor that rises with the cosine of the viewer.
double lobe(Vec3f wl, Vec3f wv) { return 0.02 * double(wv.z) + 0.5 * std::exp(60 * (double(dot(mirror(wl), wv)) - 1)); }
/// The lobe, or an anisotropic modulation of it.
Evaluate lobe_brdf(bool is_isotropic = true) {
    return pairwise([is_isotropic](Vec3f wl, Vec3f wv) {
        return grey(lobe(wl, wv) * (is_isotropic ? 1 : 1 + 0.5 * double(wl.x) * double(wv.y)));
    });
}
/// The green value for angles in degrees.
double green_at(const Measured& measured, double theta_l, double phi_l, double theta_v, double phi_v) {
    return double(value(measured, direction_at(theta_l, phi_l), direction_at(theta_v, phi_v)).g);
}
std::string speos_of(const ScatterTable& table) {
    const ScatterTable* const tables[] = {&table};
    return write_speos(tables);
}

const std::string k_zemax =
    "# made by hand\nSource  Measured\nSymmetry  PlaneSymmetrical\nSpectralContent  Monochrome\nScatterType  BRDF\n"
    "SampleRotation  1\n0\nAngleOfIncidence  2\n0\t60\nScatterAzimuth  3\n0\t90\t180\nScatterRadial  3\n0\t30\t90\n"
    "\nMonochrome\nDataBegin\nTIS 0.1\n1\t2\t0\n1\t3\t4\n1\t4\t5\nTIS 9\n2\t4\t0\n2\t6\t8\n2\t8\t10\nDataEnd\n";

/// Radial angles are measured from the mirror direction; azimuth 180 points towards grazing; zeros are gaps.
TEST(Zemax, LooksUpAboutTheMirrorDirection) {
    const auto measured = checked(read(k_zemax));
    EXPECT_EQ(measured->format, "Zemax");
    EXPECT_TRUE(is_isotropic(*measured));
    EXPECT_EQ(table_as<ScatterTable>(*measured)->masked, 2u);
    const auto f_at = [&](double theta_l, double theta_v, double phi) {
        return green_at(*measured, theta_l, 180, theta_v, phi);
    };
    EXPECT_WITHIN(f_at(60, 60, 0), 2, 1e-4);    // the mirror direction
    EXPECT_WITHIN(f_at(60, 30, 0), 4, 1e-3);    // towards the normal
    EXPECT_WITHIN(f_at(60, 75, 0), 5, 1e-3);    // towards grazing, half way to 30°
    EXPECT_WITHIN(f_at(30, 30, 0), 1.5, 1e-4);  // between the angles of incidence
    EXPECT_WITHIN(f_at(0, 30, 90), 3, 1e-3);
    EXPECT_WITHIN(f_at(0, 30, 270), 3, 1e-3);  // mirrored
    EXPECT_WITHIN(f_at(60, 0, 0), 4, 1e-3);    // one of the surrounding nodes is a gap
    // The values are the same after rotation of both directions about the normal.
    std::mt19937_64 random(1);
    for (int i = 0; i < 100; ++i) {
        const Vec3f wl = to_float(random_direction(random, 0.1)), wv = to_float(random_direction(random, 0.1));
        const float f = value(*measured, wl, wv).g, g = value(*measured, rotate(wl, 0.9), rotate(wv, 0.9)).g;
        EXPECT_TRUE(near(f, g, 1e-3) || (std::isnan(f) && std::isnan(g))) << f << " " << g;
    }
}

/// Outside the measured cone f is unknown, not extrapolated.
TEST(Zemax, HasNoValuesBeyondItsAngles) {
    std::string text =
        "Source Measured\nSymmetry PlaneSymmetrical\nSpectralContent Monochrome\nScatterType BRDF\n"
        "SampleRotation 1\n0\nAngleOfIncidence 2\n0 30\nScatterAzimuth 4\n0 60 120 180\nScatterRadial 3\n0 15 30\n"
        "Monochrome\nDataBegin\n";
    for (int k = 0; k < 2; ++k) text += "TIS 0.4\n0.5 0.5 0.5\n0.5 0.5 0.5\n0.5 0.5 0.5\n0.5 0.5 0.5\n";
    const auto measured = checked(read(text + "DataEnd\n"));
    const auto& table = *table_as<ScatterTable>(*measured);
    // ∫ cosθ over a cone of half angle α about θ is π sin²α cosθ.
    EXPECT_WITHIN(scatter_integral(table, table.slices[0]), 0.5 * k_pi * 0.25, 0.003);
    EXPECT_WITHIN(scatter_integral(table, table.slices[1]), 0.5 * k_pi * 0.25 * std::sqrt(0.75), 0.003);
    const auto f_at = [&](double theta_l, double theta_v) { return green_at(*measured, theta_l, 180, theta_v, 0); };
    EXPECT_WITHIN(f_at(0, 29.9), 0.5, 1e-6);
    EXPECT_TRUE(std::isnan(f_at(0, 30.1)));
    EXPECT_WITHIN(f_at(20, -9.9), 0.5, 1e-6);
    EXPECT_TRUE(std::isnan(f_at(20, -10.1)));
    EXPECT_WITHIN(f_at(50, 79.9), 0.5, 1e-6);  // the same as at the last angle of incidence
    EXPECT_TRUE(std::isnan(f_at(50, 80.1)));
    // Scans of half of the azimuths do not determine the others.
    const auto half = checked(read(replaced(text, "0 60 120 180", "0 20  40  60") + "DataEnd\n"));
    EXPECT_WITHIN(double(value(*half, {0, 0, 1}, to_float(spherical(0.3, -1.0))).g), 0.5, 1e-6);
    EXPECT_TRUE(std::isnan(value(*half, {0, 0, 1}, to_float(spherical(0.3, 1.2))).g));
}

/// Around the normal, the angles of the viewer decide what was measured, also for light beyond the last angle of
/// incidence.
TEST(Speos, HasNoValuesBeyondItsAngles) {
    ScatterTable table;
    table.rotation = {0}, table.first = {0, 1};
    const std::vector<float> polar{0, float(70 * k_degree)}, azimuth{0, float(k_pi), float(2 * k_pi)};
    table.slices.push_back({float(30 * k_degree), polar, azimuth, std::vector<float>(6, 0.2f)});
    const auto measured = checked(read(speos_of(table)));
    for (const double theta_l : {0.0, 30.0, 80.0})
        for (const double phi : {0.0, 90.0, 180.0})
            for (const double theta_v : {5.0, 40.0, 69.9, 70.1}) {
                const double f = green_at(*measured, theta_l, 180, theta_v, phi);
                EXPECT_TRUE(theta_v > 70 ? std::isnan(f) : near(f, 0.2, 1e-3)) << theta_l << ' ' << theta_v << ' ' << f;
            }
}

/// Three blocks of CIE tristimulus values form a colour. The case of names does not matter.
TEST(Zemax, ColoursAreTristimulusValues) {
    std::string text = k_zemax;
    const auto data = text.find("\nMonochrome\nDataBegin");
    const std::string block = text.substr(data + 12);
    text = text.substr(0, data) + "\nTristimulusX\n" + block + "TristimulusY\n" + block + "\nTristimulusZ\n" + block;
    text = replaced(replaced(text, "Monochrome", "XYZ"), "PlaneSymmetrical", "ASymmetrical");
    const auto measured = checked(read(text));
    const auto& table = *table_as<ScatterTable>(*measured);
    EXPECT_EQ(table.masked, 2u);
    const Vec3f wl = direction_at(60, 180);
    const Rgb f = value(*measured, wl, mirror(wl)), expected = to_rgb(Xyz{2, 2, 2});
    EXPECT_RGB_WITHIN_RELATIVE(f, expected, 1e-5, 0);
    EXPECT_WITHIN_RELATIVE(scatter_integral(table, table.slices[1], 1), scatter_integral(table, table.slices[1], 2),
                           1e-9);
    const std::string written = write_zemax(table);
    const auto again = checked(read(written));
    EXPECT_EQ(write_zemax(*table_as<ScatterTable>(*again)), written);
    EXPECT_EQ(table_as<ScatterTable>(*again)->channels, 3u);
    EXPECT_CONTAINS(error_text(read(text.substr(0, text.find("TristimulusZ")))), "TristimulusZ, found the end");
}

/// f = 0.1 (1 + 0.8 cos 2(φ_l − 30°)) depends on the light's azimuth only, to test the sense of rotation of each
/// format.
double f_of_light_azimuth(double phi_l) { return 0.1 * (1 + 0.8 * std::cos(2 * (phi_l - 30 * k_degree))); }

TEST(Scatter, RotationsAreOfTheFormats) {
    // In Speos, a rotation is 180° − φ_l, from the plane of incidence to the anisotropy vector. Rotations up to
    // 180° repeat.
    ScatterTable table;
    const std::vector<float> polar{0, float(k_pi / 2)}, azimuth{0, float(2 * k_pi)};
    table.first = {0};
    for (int degrees = 0; degrees <= 180; degrees += 15) {
        table.rotation.push_back(float(degrees * k_degree));
        const auto f = float(f_of_light_azimuth((180 - degrees) * k_degree));
        table.slices.push_back({0, polar, azimuth, {f, f, f, f}});
        table.first.push_back(std::uint32_t(table.slices.size()));
    }
    const auto speos = checked(read(speos_of(table)));
    const auto f_at = [](const Measured& measured, double phi_l) {
        return double(value(measured, to_float(spherical(0.5, phi_l * k_degree)), to_float(spherical(0.3, 1.0))).g);
    };
    EXPECT_WITHIN(f_at(*speos, 30), 0.18, 1e-4);
    EXPECT_WITHIN(f_at(*speos, 120), 0.02, 1e-4);
    for (const double phi : {10.0, 75.0, 200.0, 290.0, 350.0})
        EXPECT_WITHIN(f_at(*speos, phi), f_of_light_azimuth(phi * k_degree), 4e-3) << phi;
    // In Zemax, a rotation is φ_l − 90°, from x to the normal of the plane of incidence.
    table.about_mirror = true;
    for (std::size_t r = 0; r < table.rotation.size(); ++r)
        for (std::uint32_t k = table.first[r]; k < table.first[r + 1]; ++k) {
            table.slices[k].polar.back() = float(k_pi);
            std::ranges::fill(table.slices[k].f, float(f_of_light_azimuth(double(table.rotation[r]) + k_pi / 2)));
        }
    const auto zemax = checked(read(write_zemax(table)));
    for (const double phi : {30.0, 75.0, 200.0, 290.0, 350.0})
        EXPECT_WITHIN(f_at(*zemax, phi), f_of_light_azimuth(phi * k_degree), 4e-3) << phi;
    // Rotations up to 90° are also mirrored, together with the viewer.
    ScatterTable quarter = *table_as<ScatterTable>(*speos);
    quarter.rotation.resize(7);
    quarter.first.resize(8);
    quarter.slices.resize(quarter.first.back());
    for (ScatterTable::Slice& slice : quarter.slices)
        slice.azimuth = {0, float(k_pi / 2), float(k_pi), float(1.5 * k_pi), float(2 * k_pi)},
        slice.f = {1, 2, 3, 4, 1, 1, 2, 3, 4, 1};
    const auto f_quarter = [&](double phi_l, double relative) {
        return double(value(quarter, to_float(spherical(0.5, phi_l)), to_float(spherical(0.5, phi_l + relative))).g);
    };
    EXPECT_WITHIN(f_quarter(2.0, -k_pi / 2), f_quarter(2.0 + k_pi, -k_pi / 2), 1e-4);
    EXPECT_WITHIN(f_quarter(2.0, -k_pi / 2), f_quarter(-2.0, k_pi / 2), 1e-4);
    EXPECT_GT(std::abs(f_quarter(2.0, -k_pi / 2) - f_quarter(-2.0, -k_pi / 2)), 1);
}

/// Tables of a function have its values. A table that is written is read as the same table and written again as the
/// same bytes.
TEST(Scatter, WriteReadIdentity) {
    SKIP_UNDER_SANITIZERS("takes too long");
    for (const bool about_mirror : {true, false})
        for (const bool isotropic : {true, false}) {
            const Evaluate brdf = lobe_brdf(isotropic);
            ScatterTable table = to_scatter(brdf, about_mirror, isotropic, 1);
            std::mt19937_64 random(2);
            double error = 0, sum = 0;
            for (int i = 0; i < 300; ++i) {
                const Vec3f wl = to_float(random_direction(random, 0.2)), wv = to_float(random_direction(random, 0.2));
                Rgb f;
                brdf(std::span(&wl, 1), std::span(&wv, 1), std::span(&f, 1));
                const Rgb looked_up = value(table, wl, wv);
                error += std::abs(double(looked_up.g - f.g));
                sum += double(f.g);
            }
            EXPECT_LT(error, 0.05 * sum) << about_mirror << isotropic;
            if (!isotropic) {
                table.slices.resize(table.first[2]);
                table.first.resize(3);
                table.rotation.resize(2);
            }
            const std::string text = about_mirror ? write_zemax(table) : speos_of(table);
            const auto again = checked(read(text));
            const auto& reread = *table_as<ScatterTable>(*again);
            ASSERT_EQ(reread.slices.size(), table.slices.size());
            for (std::size_t s = 0; s < reread.slices.size(); ++s) {
                ASSERT_EQ(reread.slices[s].f.size(), table.slices[s].f.size());
                for (std::size_t k = 0; k < reread.slices[s].f.size(); ++k) {
                    const float a = reread.slices[s].f[k], b = table.slices[s].f[k];
                    EXPECT_TRUE(std::isnan(a) ? !(b > 0) : near_relative(a, b, 1e-6)) << a << " " << b;
                }
            }
            EXPECT_TRUE((about_mirror ? write_zemax(reread) : speos_of(reread)) == text);
        }
}

/// Transmission is a part of its own. Its angles, 90 to 180°, are mirrored at the surface.
TEST(Speos, TransmissionIsAPart) {
    ScatterTable reflected = to_scatter(lobe_brdf(), false, true, 1), transmitted = reflected;
    transmitted.transmission = true;
    for (auto& slice : transmitted.slices)
        for (float& f : slice.f) f *= 0.5f;
    const ScatterTable* const both[] = {&reflected, &transmitted};
    const auto measured = checked(read(write_speos(both)));
    std::mt19937_64 random(3);
    for (int i = 0; i < 100; ++i) {
        const Vec3f wl = to_float(random_direction(random, 0.1)), wv = to_float(random_direction(random, 0.1));
        const double front = double(value(*measured, wl, wv).g),
                     through = double(value(*measured, wl, to_side(wv, -1)).g);
        EXPECT_WITHIN_RELATIVE(through, 0.5 * front, 1e-3);
    }
}

/// A Lambertian BSDF by wavelength, with `fraction` and `percent` for each. Transmission is half of reflection.
std::string spectral_speos(const std::vector<std::array<double, 2>>& share_and_percent, bool passes) {
    std::string text = fmt::format("OPTIS - brdf surface file v8.0\n0\nby hand\n5\n-----\n1\t{:d}\n1\n2\t{}\n0 60\n",
                                   passes, share_and_percent.size());
    for (std::size_t k = 0; k < share_and_percent.size(); ++k) text += fmt::format("{} ", 450 + 200 * k);
    for (int side = 0; side < 1 + int(passes); ++side)
        for (int incidence = 0; incidence < 2; ++incidence)
            for (const auto& [fraction, percent] : share_and_percent) {
                const double part = side == 0 ? 1 : 0.5;
                text += fmt::format("\n{}\n3\t2\n\t0\t360", part * percent);
                for (int row = 0; row < 3; ++row)
                    text += fmt::format("\n{}\t{}\t{}", 90 * side + 45 * row, part * fraction, part * fraction);
            }
    return text + "\n";
}

TEST(Speos, ReadsFilesByWavelength) {
    const Vec3f wl = to_float(spherical(0.5, 0.3)), wv = to_float(spherical(0.7, 2.8));
    const auto one = checked(read(spectral_speos({{0.3, 30}}, true) + "End of file\n"));
    EXPECT_EQ(one->format, "Speos");
    EXPECT_WITHIN_RELATIVE(value(*one, wl, wv).g, 0.3 / k_pi, 1e-3);
    EXPECT_WITHIN_RELATIVE(value(*one, wl, to_side(wv, -1)).g, 0.15 / k_pi, 1e-3);
    // Values are relative to each percentage. The end may be missing.
    const auto relative = checked(read(spectral_speos({{7, 30}}, false)));
    EXPECT_TRUE(is_isotropic(*relative));
    EXPECT_WITHIN_RELATIVE(value(*relative, wl, wv).g, 0.3 / k_pi, 0.01);
    // Blue and red wavelengths give the mean, tinted.
    const auto two = checked(read(spectral_speos({{0.1, 10}, {0.3, 30}}, false)));
    const Rgb f = value(*two, wl, wv);
    EXPECT_GT(f.r, f.g);
    EXPECT_GT(f.g, f.b);
    EXPECT_GT(f.g, 0.1f / float(k_pi));
    EXPECT_LT(f.g, 0.3f / float(k_pi));

    const std::string text = spectral_speos({{0.1, 10}, {0.3, 30}}, true);
    EXPECT_CONTAINS(
        error_text(read(text.substr(0, text.rfind("\n3\t2")) + "\n3\t2\n\t0\t180\n90 1 1\n135 1 1\n180 1 1\n")),
        "those of the first wavelength");
    expect_truncations_refused(read, text, 5, 29);
}

TEST(Scatter, RefusesBadFiles) {
    expect_errors(
        read, k_zemax,
        {{"PlaneSymmetrical", "Round", "one of PlaneSymmetrical, Asymmetrical, Asymmetrical4D, found 'Round'"},
         {"Monochrome\nS", "RGB\nS", "one of Monochrome, XYZ"},
         {"Monochrome\nS", "XYZ\nS", "TristimulusX, as XYZ, found 'Monochrome'"},
         {"AngleOfIncidence  2", "AngleOfIncidence  3", "a number, found 'ScatterAzimuth'"},
         {"0\t60", "60\t0", "rising ones"},
         {"0\t60", "0\t91", "rising ones from 0 to 90"},
         {"0\t90\t180", "0\t90\t270", "angles to 180"},
         {"TIS 9", "9", "TIS before the values"},
         {"2\t6\t8", "2\tx\t8", "found 'x'"},
         {"2\t6\t8", "2\t1e30\t8", "value: expected one in the range"},
         {"ScatterRadial  3", "ScatterRadial  99999999", "between 1 and"},
         {"DataEnd", "", "expected DataEnd"},
         {"SampleRotation  1\n0\n", "", "fewer"}});
    expect_truncations_refused(read, k_zemax, 3);
    ScatterTable table = to_scatter(lobe_brdf(), false, true, 1);
    table.slices.resize(1), table.first = {0, 1};
    const std::string speos = speos_of(table);
    ASSERT_EQ(error_text(read(speos)), "");
    expect_truncations_refused(read, speos.substr(0, 300));
    expect_truncations_refused(read, speos, 13, 97);
    EXPECT_CONTAINS(error_text(read(replaced(speos, "\n0\n", "\n1\n"))), "0, a file of text");
}

const std::string k_columns =
    "# a scan\n# phi theta phi theta f\n30.0  -180.0  -30.0  0.0  1e-4\n30.0  -180.0  30.0  0.0  2\n30 -180 10 0 0.5\n";

/// Columns are named by the user. A plane of incidence at any azimuth is that of an isotropic surface. Also floors
/// and reflectance factors.
TEST(Columns, AreNamed) {
    const ReadOptions options{"theta_l_deg,phi_l_deg,theta_v_deg,phi_v_deg,532nm", {}, 0};
    const auto measured = checked(read(k_columns, options));
    EXPECT_TRUE(is_isotropic(*measured));
    ASSERT_EQ(wavelengths(*measured).size(), 1u);
    EXPECT_EQ(wavelengths(*measured)[0], 532);
    const Vec3f wl = direction_at(30, 180);
    const Rgb peak = value(*measured, wl, direction_at(30, 0));
    EXPECT_WITHIN(peak.r, 2, 1e-3);
    EXPECT_TRUE(peak.r == peak.g && peak.g == peak.b);  // a single wavelength has no colour
    EXPECT_WITHIN(value(*measured, wl, wl).g, 1e-4, 1e-6);
    const auto bounded = checked(read(k_columns, {options.columns, Quantity::factor, 1e-4f}));
    EXPECT_EQ(std::get<ScatteredSamples>(bounded->table).masked, 1u);
    EXPECT_WITHIN(value(*bounded, wl, direction_at(30, 0)).g, 2 / k_pi, 1e-3);
    EXPECT_NE(error_text(read(k_columns)), "");
    EXPECT_CONTAINS(error_text(read(k_columns, {"theta_l_deg,value", {}, 0})), "--columns: expected");
    EXPECT_CONTAINS(error_text(read(k_columns, {options.columns + ",more", {}, 0})), "6 numbers, found 5");
    EXPECT_CONTAINS(error_text(read(k_columns, {options.columns, {}, 5})), "at least one above the floor");
    EXPECT_CONTAINS(error_text(read(k_zemax, {"", Quantity::factor, 0})), "samples, for --quantity");
}

const std::string k_openmaterial =
    R"({"$schema": "OpenMATERIAL-3D/material_brdf_schema.json", "metadata": {"name": "asphalt"},
 "brdf": {"wavelengths": [9.05e-07, 1.55e-6], "receiverSolidAngles": [{"wavelength": 9.05e-07, "solidAngle": 0.0002},
 {"solidAngle": 0.0003, "wavelength": 1.55e-6}], "lookupTable": [[9.05e-07, 0.5, 0.5, 0, 0.1], [9.05e-07, 0.5, 0.5, 3.0, 0.2],
 [9.05e-07, 0.5, 0.7, 0, null], [1.55e-6, 0.5, 0.5, 0, 0.3], [1.55e-6, 0.5, 0.5, 3.0, 0.4], [1.55e-6, 0.5, 0.7, 0, 0.5]]}})";

TEST(OpenMaterial, RowsAreSpectra) {
    const auto measured = checked(read(k_openmaterial));
    EXPECT_EQ(measured->format, "OpenMATERIAL");
    const auto& samples = std::get<ScatteredSamples>(measured->table);
    EXPECT_EQ(samples.description, "asphalt");
    EXPECT_EQ(samples.wl.size(), 2u);
    EXPECT_EQ(samples.masked, 1u);
    EXPECT_WITHIN(samples.wavelengths[1], 1550, 1e-3);
    EXPECT_EQ(samples.spectrum, (std::vector<float>{0.1f, 0.3f, 0.2f, 0.4f}));
    EXPECT_EQ(samples.colour[0].r, samples.colour[0].b);
    EXPECT_EQ(samples.receiver, (std::vector<std::array<float, 2>>{{905, 0.0002f}, {1550, 0.0003f}}));
    const std::string written = write_openmaterial(samples);
    const auto again = checked(read(written));
    EXPECT_EQ(std::get<ScatteredSamples>(again->table).spectrum, samples.spectrum);
    EXPECT_EQ(std::get<ScatteredSamples>(again->table).receiver, samples.receiver);
    EXPECT_EQ(write_openmaterial(std::get<ScatteredSamples>(again->table)), written);
    expect_truncations_refused(read, k_openmaterial);
    expect_errors(read, k_openmaterial,
                  {{"0.1]", "0.1, 1]", ""},
                   {"0.1]", "\"x\"]", ""},
                   {", 0.1]", "]", ""},
                   {"[[9.05e-07", "[[-1", ""},
                   {"[[9.05e-07", "[[null", ""},
                   {"null", "[1]", ""},
                   {": 0.0002", ": 0", ""},
                   {": 0.0003", ": null", ""}});
    EXPECT_NE(error_text(read("{\"OpenMATERIAL\":" + std::string(100000, '['))), "");
}

/// In older versions of the format, zenith angles reach −π/2: negative ones are in the other half of the plane.
/// Other angles are refused.
TEST(OpenMaterial, NegativeZenithAnglesAreOnTheOtherSideOfThePlane) {
    const std::string viewer = "0.5, 0.5, 3.0", negative = "0.5, -0.5, 0.0";  // of two wavelengths
    const auto measured = checked(read(replaced(replaced(k_openmaterial, viewer, negative), viewer, negative)));
    const auto& samples = std::get<ScatteredSamples>(measured->table);
    ASSERT_EQ(samples.wl.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
        const bool is_mirror = dot(mirror(samples.wl[i]), samples.wv[i]) > 0.999f;
        EXPECT_EQ(samples.spectrum[2 * i], is_mirror ? 0.2f : 0.1f);
        EXPECT_EQ(is_mirror, dot(samples.wl[i], samples.wv[i]) < 0.9f);
    }
    EXPECT_EQ(std::get<ScatteredSamples>(read(write_openmaterial(samples))->table).spectrum, samples.spectrum);
    expect_errors(
        read, k_openmaterial,
        {{"[9.05e-07, 0.5, 0.7", "\n[9.05e-07, 45, 0.7", "line 5: angle: expected -1.571 to 1.571 rad in column 2"},
         {"0.5, 0.7, 0, null", "0.5, 1.6, 0, null", "line 4: angle: expected -1.571 to 1.571 rad in column 3"},
         {"0.5, 0.7, 0, null", "0.5, 0.7, 180, null", "in column 4 of a row, found 180"},
         {"0.5, 0.7, 0, null", "0.5, null, 0, null", "in column 3 of a row, found nan"}});
}

/// Two points with two polarizations each, at one wavelength, and a third point with twice the uncertainty. Ignored
/// data are nested.
const std::string k_bird =
    R"({"metadata": {"schema": "brdf_json_schema_v1.0.json", "description": "spectralon", "data": {"BRDF": {"values": ["no"]}}},
 "data": {"theta_i": {"unit": "deg", "values": [45, 45, 45, 45, 30]}, "phi_i": {"unit": "deg", "values": [90, 90, 90, 90, 90]},
 "theta_r": {"unit": "rad", "values": [0.5, 0.5, 1, 1, 0.25]}, "phi_r": {"unit": "\u00b0", "values": [270, 270, 0, 0, 0]},
 "wavelength_i": {"unit": "\u03bcm", "values": [0.55, 0.55, 0.55, 0.55, 0.55]},
 "polarization_i": {"notation": "inStokes", "values": [[1, 1, 0, 0], [1, -1, 0, 0], [1, 1, 0, 0], [1, -1, 0, 0], [1, 0, 0, 0]]},
 "BRDF": {"unit": "1/sr", "values": [0.25, 0.35, 0.5, 0.7, 0.4]},
 "uBRDF": {"unit": "%", "values": [1, 1, 1, 1, 2]}}})";

TEST(Bird, PointsAreSamplesOfMeanPolarization) {
    const auto measured = checked(read(k_bird));
    EXPECT_EQ(measured->format, "BiRD");
    const auto& samples = std::get<ScatteredSamples>(measured->table);
    EXPECT_EQ(samples.description, "spectralon");
    EXPECT_TRUE(samples.isotropic);
    ASSERT_EQ(samples.wl.size(), 3u);  // in ascending order of the light's angle
    EXPECT_WITHIN(samples.wavelengths[0], 550, 1e-3);
    constexpr float f[] = {0.4f, 0.3f, 0.6f};
    const Vec3d wv[] = {spherical(0.25, 0.0), spherical(0.5, -k_pi / 2), spherical(1.0, 0.0)};
    const auto index_of = [&](const Vec3d& w) {
        return std::size_t(std::ranges::max_element(samples.wv, {}, [&](Vec3f v) { return dot(w, to_double(v)); }) -
                           samples.wv.begin());
    };
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_WITHIN(double(dot(wv[k], to_double(samples.wv[index_of(wv[k])]))), 1, 1e-6);
        EXPECT_WITHIN(samples.spectrum[index_of(wv[k])], f[k], 1e-6);
        EXPECT_WITHIN(samples.weight[index_of(wv[k])], k == 0 ? 0.4 : 1, 1e-6);  // 2 / (1 + 2²)
    }
    expect_truncations_refused(read, k_bird);
    expect_errors(read, k_bird,
                  {{"[45, 45, 45, 45, 30]", "[45]", ""},
                   {"[45, 45", "[null, 45", ""},
                   {"[45, 45", "[[45], 45", ""},
                   {"\"rad\"", "\"grad\"", ""},
                   {"\"1/sr\"", "\"\"", ""},
                   {"theta_r", "theta_s", ""},
                   {"0.25,", "\"0.25\",", ""}});
    EXPECT_NE(error_text(read("{\"theta_i\":" + std::string(100000, '['))), "");
}

const std::string k_fred =
    "type bsdf_data\nformat angles=deg bsdf=value scale=2\n10 0\n0 0 0.5\n10 0 3\n10 180 1\n30 0\n30 0 4\n";

/// Lines of two numbers are lights. Their mirror direction is at azimuth 0.
TEST(Fred, LinesAreLightsAndSamples) {
    const auto measured = checked(read(k_fred));
    EXPECT_EQ(measured->format, "FRED");
    EXPECT_TRUE(is_isotropic(*measured));
    for (const double theta : {10 * k_degree, 30 * k_degree}) {
        const Vec3f wl = to_float(spherical(theta, 1.0));
        EXPECT_WITHIN(value(*measured, wl, mirror(wl)).g, theta > 0.2 ? 8 : 6, 1e-3);
    }
    EXPECT_CONTAINS(error_text(read("type bsdf_data\n0 0 1\n")), "a line of the light before it");
    EXPECT_CONTAINS(error_text(read("type bsdf_data\n0 0\n1\n")), "two of a light");
    EXPECT_CONTAINS(error_text(read("type bsdf_data\n0 0\n1 2 3 4\n")), "two of a light");
    EXPECT_CONTAINS(error_text(read("type bsdf_data\nformat angles=turns\n0 0\n1 2 3\n")), "angles=deg or rad");
    EXPECT_NE(error_text(read("type bsdf_data\n0 0\n")), "");
}

/// In the plane of incidence a light has one number and a sample two. Negative angles are on the light's side.
TEST(Fred, ReadsScansInThePlaneOfIncidence) {
    const auto measured = checked(
        read("type bsdf_data\nformat angles=deg bsdf=value scale=1\n15\n-15 0.2\n15 3\n45\n-45 0.1\n0 0.5\n45 4\n"));
    EXPECT_EQ(measured->format, "FRED");
    EXPECT_TRUE(is_isotropic(*measured));
    const auto& samples = std::get<ScatteredSamples>(measured->table);
    ASSERT_EQ(samples.wl.size(), 5u);
    for (const double theta : {15 * k_degree, 45 * k_degree}) {
        const Vec3f wl = to_float(spherical(theta, 1.0));
        EXPECT_WITHIN(value(*measured, wl, mirror(wl)).g, theta < 0.5 ? 3 : 4, 1e-3);
        EXPECT_WITHIN(value(*measured, wl, wl).g, theta < 0.5 ? 0.2 : 0.1, 1e-3);
    }
    const auto mirrored = checked(read("type bsdf_data\n-45\n45 0.1\n-45 4\n"));
    const Vec3f wl = to_float(spherical(45 * k_degree, 1.0));
    EXPECT_WITHIN(value(*mirrored, wl, mirror(wl)).g, 4, 1e-3);
    EXPECT_CONTAINS(error_text(read("type bsdf_data\n15\n-15 0.2 3\n")),
                    "line 3: numbers: expected one of a light or two");
    EXPECT_CONTAINS(error_text(read("type bsdf_data\n15 0\n400 0 3\n")), "line 3: polar angle");
}

/// Files of instruments: one sample in a file for Zemax and in its counterpart for Speos. Integrals are compared
/// with ones computed independently.
TEST(Scatter, FilesOfInstrumentsHaveTheirIntegrals) {
    const auto folder = shared_data() / "optics";
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no " << folder;
    const auto zemax = checked(load_measured(folder / "test_13_planesymmetric_brdf_zemax.bsdf")),
               speos = checked(load_measured(folder / "test_13_planesymmetric_brdf_speos_reference.anisotropicbsdf")),
               sensor = checked(load_measured(folder / "IMX455.bsdf"));
    EXPECT_FALSE(is_isotropic(*sensor));
    const auto& table = *table_as<ScatterTable>(*zemax);
    EXPECT_WITHIN(scatter_integral(table, table.slices[0]), 0.1309,
                  0.001);  // the file states 0.1345, over all directions
    // The Speos file was made from the other with a factor for each incidence, so the directions agree.
    std::mt19937_64 random(4);
    for (const double incidence : {15.0, 30.0, 60.0}) {
        const Vec3f wl = to_float(spherical(incidence * k_degree, 0.0)), mirrored = mirror(wl);
        const double factor = double(value(*speos, wl, mirrored).g) / double(value(*zemax, wl, mirrored).g);
        EXPECT_TRUE(factor > 1 && factor < 1.25);
        double error = 0, sum = 0;
        for (int i = 0; i < 500; ++i) {
            const Vec3f wv = to_float(random_direction(random, 0.5));
            const double a = factor * double(value(*zemax, wl, wv).g), b = double(value(*speos, wl, wv).g);
            if (std::isfinite(a) && std::isfinite(b)) {
                error += std::abs(a - b);
                sum += a;
            }
        }
        EXPECT_LT(error, 0.02 * sum) << incidence;
    }
    EXPECT_CONTAINS(message(load_measured(folder / "R_test.anisotropicbsdf").error()), "a file of text");
    EXPECT_TRUE(load_measured(folder / "aniso_bsdf.anisotropicbsdf").ok());
    EXPECT_TRUE(load_measured(folder / "AnoBlackEC1onAlum.txt").ok());
}

TEST(Scatter, KeepsTheHighlight) {
    expect_peaks_kept([](const Evaluate& brdf) {
        return std::vector<Measured>{{"f", "Zemax", 0, as_evaluated_table(to_scatter(brdf, true, true))},
                                     {"f", "Speos", 0, as_evaluated_table(to_scatter(brdf, false, true))}};
    });
}

}  // namespace
}  // namespace srbf::scatter_test
