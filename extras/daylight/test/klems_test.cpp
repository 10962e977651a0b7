// Matrices of patches: bases, look-up, beams, a real roller shade, and refused files.
#include "extras/daylight/klems.h"
#include "bad_texts.h"
#include "brdf/parts.h"
#include "extras/daylight/test/bsdf_files.h"
#include "measured/formats.h"
#include "measured/tables.h"
#include "peaks.h"
#include "srbf/file.h"
#include "temporary_folder.h"

namespace srbf::klems_test {
namespace {

Result<Measured> read(const std::string& text) { return read_measured(as_bytes(text), "f"); }

/// Radiance's bases have 145, 77 and 41 patches. The patches cover the hemisphere: their projected solid angles sum
/// to π.
TEST(Klems, BasesCoverTheHemisphere) {
    for (const auto& [name, count] :
         {std::pair("LBNL/Klems Full", 145), {"LBNL/Klems Half", 77}, {"lbnl/klems quarter", 41}}) {
        const auto measured = checked(read(
            bsdf_xml("", matrix_xml("Reflection Front", name, std::size_t(count), [](auto, auto) { return 0.25; }))));
        const auto& part = *table_as<KlemsTable>(*std::get<BsdfTable>(measured->table).band().part[0]);
        const AngleBasis& basis = part.incident;
        ASSERT_EQ(basis.patches(), std::size_t(count));
        double sum = 0;
        for (std::size_t r = 0; r < basis.rings.size(); ++r)
            sum += basis.projected_solid_angle(r) * basis.rings[r].azimuths;
        EXPECT_WITHIN(sum, k_pi, 1e-6);
        EXPECT_WITHIN(value(*measured, {0, 0.6f, 0.8f}, {0, 0, 1}).r, 0.25, 1e-7);
        // Every point of a patch lies in the patch.
        std::mt19937_64 random(1);
        for (std::size_t p = 0; p < basis.patches(); ++p)
            for (int k = 0; k < 20; ++k) {
                const double s = 0.001 + 0.998 * uniform(random), t = 0.001 + 0.998 * uniform(random);
                EXPECT_EQ(basis.patch_of(to_float(basis.point_of(p, s, t))), p);
            }
    }
}

TEST(Klems, LooksUpPatchesOnBothSides) {
    const auto measured = checked(read(small_shade()));
    EXPECT_EQ(measured->format, "BSDF XML");
    const auto& table = std::get<BsdfTable>(measured->table);
    ASSERT_EQ(table.bands.size(), 2u);
    EXPECT_EQ(table.band().name, "Visible");
    EXPECT_EQ(table.description, "A shade");
    const AngleBasis basis = small_basis();
    for (std::size_t o = 0; o < basis.patches(); ++o)
        for (std::size_t i = 0; i < basis.patches(); ++i) {
            const Vec3d in = basis.point_of(i, 0.4, 0.3), out = basis.point_of(o, 0.6, 0.7);
            const Vec3f wl = to_float({in.x, -in.y, in.z}), wv = to_float({-out.x, out.y, out.z});
            const double back = 0.1 + 0.02 * double(o) + 0.001 * double(i);
            EXPECT_WITHIN(value(*measured, wl, wv).g, 0.5 * back, 1e-6);
            EXPECT_WITHIN(value(*measured, to_side(wl, -1), to_side(wv, -1)).r, back, 1e-6);
            // f excludes the beam.
            EXPECT_WITHIN(value(*measured, to_side(wl, -1), wv).r, 0.05, 1e-6);
            EXPECT_WITHIN(value(*measured, wl, to_side(wv, -1)).b, 0.05, 1e-6);
        }
    EXPECT_EQ(value(*measured, {1, 0, 0}, {0, 0, 1}), Rgb{});
    auto solar = *measured;
    ASSERT_TRUE(choose_band(solar, "solar").ok());
    EXPECT_WITHIN(value(solar, {0, 0, 1}, {0, 0, -1}).r, 0.025, 1e-6);
    EXPECT_EQ(message(choose_band(solar, "ultraviolet").error()),
              "f: band of wavelengths: expected Visible or Solar, found ultraviolet");
}

/// The peak of a patch around the direction straight through is separated as a beam. The beam's share and the
/// remaining values sum to the file's value. Reflections without a peak have no beam.
TEST(Klems, SeparatesTheBeam) {
    const auto measured = checked(read(small_shade()));
    const auto& band = std::get<BsdfTable>(measured->table).band();
    EXPECT_TRUE(band.beam[0].empty() && band.beam[1].empty());
    ASSERT_EQ(band.beam[2].theta.size(), 3u);
    for (std::size_t r = 0; r < 3; ++r)
        EXPECT_WITHIN(band.beam[2].fraction[r].g, 0.08 * std::cos(double(band.beam[2].theta[r])), 1e-6);
    EXPECT_WITHIN(fraction_at(band.beam[2], {0, 0, 1}).g, 0.08, 1e-6);
    EXPECT_WITHIN(fraction_at(band.beam[2], {1, 0, 0}).g, 0, 1e-6);
}

/// The holes of a fabric. The beam is kept for each azimuth, and at the middles of patches it equals that of the
/// file. The beam of light from the back is merged with it if both are the same along each line, and kept
/// separately if not.
TEST(Klems, BeamsDependOnAzimuth) {
    const AngleBasis basis = small_basis();
    const std::size_t n = basis.patches();
    const auto fraction = [&](std::size_t i, std::size_t shift) {
        const std::size_t ring = basis.ring_of(i), k = (i - basis.first_of(ring) + shift) % 4;
        return ring == 0 ? 0.08 : (0.02 + 0.01 * double(k)) / double(ring);
    };
    const auto matrix = [&](const char* direction, std::size_t shift) {
        return matrix_xml(direction, "small", n, [&](std::size_t o, std::size_t i) {
            return 0.001 + (o == i ? fraction(i, shift) / basis.projected_solid_angle(basis.ring_of(i)) : 0);
        });
    };
    for (const std::size_t shift : {std::size_t(2), std::size_t(1)}) {
        const auto measured = checked(
            read(bsdf_xml(small_basis_xml(), matrix("Transmission Front", 0) + matrix("Transmission Back", shift))));
        const Beams& beams = std::get<BsdfTable>(measured->table).band().beam;
        EXPECT_EQ(beams[3].empty(), shift == 2);  // rotated by 180°, the lines are the same
        EXPECT_EQ(beams[2].azimuths, (std::vector<int>{1, 4, 4}));
        for (std::size_t i = 0; i < n; ++i) {
            const Vec3d p = basis.middle_of(i);
            const Vec3f wl = to_float({p.x, -p.y, p.z});
            EXPECT_WITHIN(fraction_at(beams, Part::transmission_front, wl).g, fraction(i, 0), 1e-6);
            EXPECT_WITHIN(fraction_at(beams, Part::transmission_back, wl).g, fraction(i, shift), 1e-6);
        }
        // In a matrix that is written, each patch has its beam again, whether from a model or not.
        BsdfTable again = std::get<BsdfTable>(measured->table);
        for (const Part part : {Part::transmission_front, Part::transmission_back}) {
            KlemsTable table = *table_as<KlemsTable>(*again.band().part[std::size_t(part)]);
            const std::vector<Rgb> before = table.beam;
            add_beam(table, beams, part);
            for (std::size_t i = 0; i < n; ++i) EXPECT_WITHIN(table.beam[i].g, before[i].g, 1e-6);
        }
    }
}

/// A peak that reaches the neighbouring patches is a lobe, not a beam.
TEST(Klems, KeepsWideLobes) {
    const char* name = "LBNL/Klems Full";
    const auto uniform =
        checked(read(bsdf_xml("", matrix_xml("Transmission Front", name, 145, [](auto, auto) { return 0.1; }))));
    const AngleBasis basis = table_as<KlemsTable>(*std::get<BsdfTable>(uniform->table).band().part[2])->incident;
    const auto wide = [&](std::size_t o, std::size_t i) {
        const Vec3d a = basis.point_of(o, 0.5, 0.5), b = basis.point_of(i, 0.5, 0.5);
        return 0.02 + std::exp(50 * (dot(a, b) - 1));
    };
    const auto measured = checked(read(bsdf_xml("", matrix_xml("Transmission Front", name, basis.patches(), wide))));
    EXPECT_TRUE(std::get<BsdfTable>(measured->table).band().beam[2].empty());
}

/// With "Rows", the rows belong to incident patches. Transmission in one direction serves both, by reciprocity.
TEST(Klems, ReadsRowsAndOneWayOnly) {
    const std::size_t n = small_basis().patches();
    const auto f = [](std::size_t o, std::size_t i) { return 1 + 0.1 * double(o) + 0.01 * double(i); };
    const auto transposed = [&](std::size_t o, std::size_t i) { return f(i, o); };
    const auto a = checked(read(bsdf_xml(small_basis_xml(), matrix_xml("Transmission Front", "small", n, f)))),
               b = checked(
                   read(bsdf_xml(small_basis_xml(), matrix_xml("Transmission Front", "small", n, transposed), "Rows")));
    std::mt19937_64 random(2);
    for (int i = 0; i < 200; ++i) {
        const Vec3f wl = to_float(random_direction(random)), wv = to_float(random_direction(random));
        EXPECT_EQ(value(*a, wl, wv), value(*b, wl, wv));
        EXPECT_EQ(value(*a, wl, wv), value(*a, wv, wl));
        EXPECT_EQ(value(*a, wl, wv) == Rgb{}, wl.z * wv.z > 0);  // no reflection
    }
}

/// Names of bands and bases become single lines of text, whatever the file contains. A file that is written has the
/// same bands.
TEST(Klems, NamesAreReadAsTheyAreWritten) {
    const std::size_t n = small_basis().patches();
    const auto f = [](auto...) { return 0.1; };
    for (const auto& [one, two, name] : std::initializer_list<std::array<std::string, 3>>{
             {"Vi\1sible", "Visible", "Vi sible"},
             {"Vi\n sible", "Visible", "Vi  sible"},
             {"&#1; A &amp; B &lt;", "A &amp;amp; B", "A & B <"},
             {std::string(99, 'a') + " b", std::string(99, 'a') + "c", std::string(99, 'a')},
             {std::string(40, '&') + "1", std::string(40, '&') + "2", std::string(40, '&') + "1"}}) {
        const std::string text = bsdf_xml(small_basis_xml(), matrix_xml("Reflection Front", "small", n, f, one) +
                                                                 matrix_xml("Reflection Front", "small", n, f, two));
        const auto table = read_bsdf_xml(as_bytes(text), "f");
        ASSERT_TRUE(table.ok()) << one;
        ASSERT_EQ(table->bands.size(), 2u);
        EXPECT_EQ(table->bands[0].name, name);
        const auto again = checked(read_bsdf_xml(as_bytes(write_bsdf_xml(*table)), "f"));
        ASSERT_EQ(again->bands.size(), 2u);
        for (std::size_t b = 0; b < 2; ++b) EXPECT_EQ(again->bands[b].name, table->bands[b].name);
    }
    // A band without a name is the visible one.
    const std::string unnamed = matrix_xml("Reflection Front", "small", n, f, ""),
                      visible = matrix_xml("Reflection Front", "small", n, f);
    EXPECT_CONTAINS(error_text(read(bsdf_xml(small_basis_xml(), unnamed + visible))), "one matrix or tree in a band");
}

/// Bands of a coloured BSDF are joined: R, G and B; Visible with CIE-X and CIE-Z, whose equal values are white;
/// wavelengths.
TEST(Klems, ColoursAreOfSeveralBands) {
    const auto file = [](std::initializer_list<std::pair<const char*, double>> bands) {
        std::string blocks;
        for (const auto& [name, f] : bands)
            blocks += matrix_xml(
                "Reflection Front", "small", 9, [f = f](auto, auto) { return f; }, name);
        return bsdf_xml(small_basis_xml(), blocks);
    };
    const auto colour_of = [](const Result<Measured>& measured) {
        return value(*measured, {0, 0.6f, 0.8f}, {0, 0, 1});
    };
    for (const auto& text :
         {file({{"R", 0.1}, {"G", 0.2}, {"B", 0.3}}), file({{"Blue", 0.3}, {"red", 0.1}, {"Green", 0.2}}),
          file({{"Visible", 0.4}, {"B", 0.3}, {"R", 0.1}, {"G", 0.2}, {"Solar", 0.5}})}) {
        const auto measured = checked(read(text));
        EXPECT_EQ(colour_of(measured), (Rgb{0.1f, 0.2f, 0.3f}));
        const auto again = checked(read(write_bsdf_xml(std::get<BsdfTable>(measured->table))));
        EXPECT_EQ(colour_of(again), (Rgb{0.1f, 0.2f, 0.3f}));
    }
    const auto white = checked(read(file({{"Visible", 0.2}, {"CIE-X", 0.2}, {"CIE-Z", 0.2}}))),
               red = checked(read(file({{"CIE-X", 0.3}, {"CIE-Z", 0.1}, {"Visible", 0.2}}))),
               flat = checked(read(file({{"650", 0.2}, {"450", 0.2}, {"550", 0.2}}))),
               rising = checked(read(file({{"0.65", 0.3}, {"0.45", 0.1}, {"0.55", 0.2}})));
    for (const auto* measured : {&white, &flat}) EXPECT_RGB_WITHIN(colour_of(*measured), grey(0.2), 1e-4);
    EXPECT_WITHIN(luminance(colour_of(red)), 0.2, 1e-4);
    EXPECT_EQ(std::get<BsdfTable>(red->table).bands.size(), 1u);
    for (const auto* measured : {&red, &rising}) {
        EXPECT_GT(colour_of(*measured).r, colour_of(*measured).g);
        EXPECT_GT(colour_of(*measured).g, colour_of(*measured).b);
    }
    // Bands with other patches or parts stay separate. Laser lines are not a colour.
    for (const auto& text : {file({{"R", 0.1}, {"G", 0.2}}), file({{"632", 0.1}, {"905", 0.2}, {"1550", 0.3}})}) {
        const auto measured = checked(read(text));
        EXPECT_EQ(colour_of(measured), (Rgb{0.1f, 0.1f, 0.1f}));
    }
}

TEST(Klems, IsotropyIsDetected) {
    const AngleBasis basis = small_basis();
    const auto is_isotropic_if = [&](bool relative) {
        const auto measured =
            read(bsdf_xml(small_basis_xml(),
                          matrix_xml("Reflection Front", "small", basis.patches(), [&](std::size_t o, std::size_t i) {
                              return 1 + 0.2 * std::cos(basis.azimuth_of(o) - (relative ? basis.azimuth_of(i) : 0.5));
                          })));
        return is_isotropic(*measured);
    };
    EXPECT_TRUE(is_isotropic_if(true));
    EXPECT_FALSE(is_isotropic_if(false));
}

TEST(Klems, RefusesBadFiles) {
    const std::string good = small_shade();
    EXPECT_EQ(error_text(read(good)), "");
    expect_errors(
        read, good,
        {{"0.05", "1e99", "within the range of floats, found '1e99'"},
         {"0.05", "nan", "found 'nan'"},
         {"0.05", "x", "found 'x'"},
         {"0.05,", "0.05, 1,", "81 numbers, found more"},
         {"0.05,", "", "81 numbers, found 80"},
         {"Transmission Front", "Sideways", "Reflection, Front or Back, found 'Sideways'"},
         {"Transmission Front", "Transmission Back", "transmission_back: expected one matrix or tree in a band"},
         {"<ColumnAngleBasis>small", "<ColumnAngleBasis>large", "found 'large'"},
         {"Columns", "TensorTree3", "AngleBasis of a tensor tree: expected LBNL/Shirley-Chiu"},
         {"Columns", "Diagonals", "found 'Diagonals'"},
         {"<nPhis>4", "<nPhis>0", "nPhis: expected 1 to 4096, found 0"},
         {"<nPhis>4", "<nPhis>1e9", "found 1e+09"},
         {"<nPhis>4", "<nPhis>2.5", "found 2.5"},
         {"<UpperTheta>20", "<UpperTheta>-20", "bounds of a ring"},
         {"<UpperTheta>90", "<UpperTheta>80", "expected rings to 90 degrees"},
         {"<Optical>", "<Optics>", "XML: expected a well-formed file"},
         {"</WindowElement>", "", "XML: expected a well-formed file"},
         {"<WindowElement ", "<!DOCTYPE x [<!ENTITY a \"b\">]><WindowElement ", "no document type"}});
    // Deeply nested elements are not read recursively.
    std::string deep = "<?xml version=\"1.0\"?><WindowElement>";
    EXPECT_CONTAINS(error_text(read(deep + std::string(1 << 18, '<'))), "tags and attributes");
    for (int i = 0; i < 60000; ++i) deep += "<a>";
    EXPECT_CONTAINS(error_text(read(deep)), "well-formed");
    for (int i = 0; i < 60000; ++i) deep += "</a>";
    EXPECT_CONTAINS(error_text(read(deep + "</WindowElement>")), "Optical");
    expect_truncations_refused(read, good, 3, 97);
}

/// A real roller shade: its column sums with the beam separated, compared with sums computed independently.
TEST(Klems, SumsOfARollerShadeAgreeWithIndependentOnes) {
    const auto path = shared_data() / "klems" / "2011-SA1.xml";
    if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
    const auto measured = checked(load_measured(path));
    EXPECT_TRUE(is_isotropic(*measured));
    const auto& band = std::get<BsdfTable>(measured->table).band();
    // The file's directional-hemispherical sums at 0° and 82.5°, computed independently.
    const double expected[k_parts][2] = {{0.48246, 0.64137}, {0.56, 0.71018}, {0.09587, 0.05868}, {0.09432, 0.01227}};
    for (std::size_t p = 0; p < k_parts; ++p) {
        const auto& table = *table_as<KlemsTable>(*band.part[p]);
        for (int k = 0; k < 2; ++k) {
            const std::size_t ring = k ? 8 : 0, i = table.incident.first_of(ring);
            double sum = table.beam.empty() ? 0 : double(table.beam[i].g);
            for (std::size_t o = 0; o < table.outgoing.patches(); ++o)
                sum += double(table.cell(o, i).g) * table.outgoing.projected_solid_angle(table.outgoing.ring_of(o));
            EXPECT_WITHIN(sum, expected[p][k], 1e-5) << k_part_names[p];
        }
    }
    EXPECT_TRUE(band.beam[0].empty() && band.beam[1].empty());
    EXPECT_WITHIN(fraction_at(band.beam[2], {0, 0, 1}).g, 0.0489, 2e-4);  // sold as 5 % open
}

TEST(Klems, KeepsTheHighlight) {
    expect_peaks_kept([](const Evaluate& brdf) {
        const Measured part{"f", "BSDF XML", 0, as_evaluated_table(to_klems(brdf, klems_basis(KlemsBasis::quarter)))};
        BsdfTable bsdf{{{}}, 0, {}};
        bsdf.bands[0].part[std::size_t(Part::transmission_front)] = std::make_shared<const Measured>(part);
        return std::vector<Measured>{part, {"f", "BSDF", 0, bsdf}};
    });
}

}  // namespace
}  // namespace srbf::klems_test
