// Scattered samples and the text formats that store them.
#include <map>

#include "brdf/colour.h"
#include "measured/formats.h"
#include "measured/readers.h"
#include "measured/samples.h"
#include "measured/tables.h"
#include "measured_files.h"
#include "srbf/convert.h"
#include "srbf/file.h"
#include "srbf/metrics.h"

namespace srbf::scattered_test {
namespace {

Result<ScatteredSamples> read_csv(std::span<const std::byte> bytes, const std::string& file_name) {
    return srbf::read_csv(bytes, file_name, {});
}
Result<ScatteredSamples> read(Result<ScatteredSamples> (*reader)(std::span<const std::byte>, const std::string&),
                              std::string_view text) {
    return build_index(reader(as_bytes(text), "f"));
}
void expect_error(Result<ScatteredSamples> (*reader)(std::span<const std::byte>, const std::string&),
                  std::string_view text, std::string_view part) {
    EXPECT_CONTAINS(error_text(read(reader, text)), part);
}
bool near_direction(Vec3f a, Vec3d b) { return near(a.x, b.x, 1e-6) && near(a.y, b.y, 1e-6) && near(a.z, b.z, 1e-6); }

TEST(Cornell, ReadsSpectra) {
    const auto s = checked(read(read_cornell, k_small_cornell));
    EXPECT_EQ(s->description, "Blue paint");
    EXPECT_TRUE(s->isotropic);
    EXPECT_EQ(s->wavelengths, (std::vector<float>{450, 550, 650}));
    ASSERT_EQ(s->wl.size(), 3u);
    EXPECT_TRUE(near_direction(s->wl[0], spherical(0.1, 0.0)));  // i is the light
    EXPECT_TRUE(near_direction(s->wv[0], spherical(0.2, 3.0)));
    EXPECT_EQ(s->spectrum, (std::vector<float>{0.3f, 0.2f, 0.1f, 0.31f, 0.21f, 0.11f, 3, 2, 1}));
    const auto weights = rgb_weights(s->wavelengths);
    EXPECT_EQ(s->colour[1], to_rgb(std::span(s->spectrum).subspan(3, 3), weights));
}

TEST(Cornell, ReportsErrors) {
    expect_error(read_cornell, "x\n", "line 1: number of wavelengths: expected between 1 and 4096, found 'x'");
    expect_error(read_cornell, "0\n", "number of wavelengths");
    expect_error(read_cornell, "2\n400\n", "wavelength 2 of 2: expected a number, found the end of the file");
    expect_error(read_cornell, "2\n400 400\n", "wavelengths: expected increasing ones");
    expect_error(read_cornell, "1\n400\n0.1 0 0.1 0\n",
                 "number 5 of a sample of 5: expected a number, found the end of");
    expect_error(read_cornell, "1\n400\n0.1 0 0.1 0 1\n0.1 0 zero 0 1\n", "line 4: number 3 of a sample of 5");
    expect_error(read_cornell, "1\n400\n", "samples: expected at least one");
    expect_error(read_cornell, "1\n400\n1.6 0 0 0 1\n0 0 0 0 nan\n", "found 2 that are not");
}

TEST(Astm, ReadsColumnsByName) {
    const auto s = checked(read(read_astm, k_small_astm));
    EXPECT_EQ(s->description, "Blue");
    EXPECT_TRUE(s->isotropic && s->wavelengths.empty() && s->spectrum.empty());
    ASSERT_EQ(s->wl.size(), 3u);
    EXPECT_EQ(s->colour[1], (Rgb{-0.01f, 0.21f, 0.31f}));
    EXPECT_TRUE(near_direction(s->wv[1], spherical(1.0, 0.5)));

    const auto other = checked(read(read_astm, "VARS Y,theta_s,theta_i,phi_s,phi_i\n0.5,0.1,0.2,0.3,0.4\n"));
    EXPECT_EQ(other->colour[0], (Rgb{0.5f, 0.5f, 0.5f}));
    EXPECT_TRUE(other->isotropic);  // there is only one azimuth of the light
    EXPECT_TRUE(near_direction(other->wl[0], spherical(0.2, 0.4)) && near_direction(other->wv[0], spherical(0.1, 0.3)));

    const auto xyz = checked(read(read_astm, "VARS theta_i,theta_s,phi_s,X,Y,Z\n0.2,0.1,0.3,0.95047,1,1.08883\n"));
    for (int c = 0; c < 3; ++c) EXPECT_WITHIN(xyz->colour[0][c], 1, 2e-4);
}

TEST(Astm, ReportsErrors) {
    expect_error(read_astm, "", "a line VARS");
    expect_error(read_astm, "VARS theta_i,phi_s,R,G,B\n", "a column theta_s");
    expect_error(read_astm, "VARS theta_i,theta_s,phi_s,R,G\n",
                 "values R,G,B or X,Y,Z or one column, found 2 from 'R'");
    expect_error(read_astm, "VARS theta_i,theta_i,theta_s,phi_s,Y\n", "'theta_i' again");
    expect_error(read_astm, "VARS theta_i,theta_s,phi_s,Y\n1,1,1\n", "line 2: sample: expected 4 numbers, found 3");
    expect_error(read_astm, "VARS theta_i,theta_s,phi_s,Y\n1,a,1,1\n", "line 2: theta_s: expected a number, found 'a'");
    expect_error(read_astm, "NUM_POINTS 2\nVARS theta_i,theta_s,phi_s,Y\n1,1,1,1\n",
                 "samples: expected 2 (NUM_POINTS), found 1");
    expect_error(read_astm, "LAB_NAME x\n1,2,3\n", "a line VARS before the samples");
}

/// A parameterization of ALTA: its numbers for a pair of directions. ALTA names the view first.
struct AltaCase {
    std::string name;
    std::vector<double> numbers;
    Vec3d view, light;
};

/// The numbers of a random pair of directions in each of ALTA's parameterizations, computed from the directions by
/// ALTA's definitions.
std::vector<AltaCase> alta_cases(std::mt19937_64& random) {
    const Vec3d v = random_direction(random, 0.05);
    Vec3d l = random_direction(random, 0.05);
    const auto theta = [](Vec3d w) { return std::acos(w.z); };
    const auto phi = [](Vec3d w) { return std::atan2(w.y, w.x); };
    const Vec3d h = normalize(l + v);
    std::vector<AltaCase> cases{
        {"CARTESIAN", {v.x, v.y, v.z, l.x, l.y, l.z}, v, l},
        {"SPHERICAL_TL_PL_TV_PV", {theta(l), phi(l), theta(v), phi(v)}, v, l},
        {"STEREOGRAPHIC", {v.x / (1 + v.z), v.y / (1 + v.z), l.x / (1 + l.z), l.y / (1 + l.z)}, v, l},
    };
    // Half vector: θ_d and φ_d of the viewer in the frame that rotates h to the normal.
    const auto in_half_frame = [&](Vec3d w) {
        const double c = std::cos(phi(h)), s = std::sin(phi(h));
        const Vec3d a{c * w.x + s * w.y, c * w.y - s * w.x, w.z};
        return Vec3d{h.z * a.x - std::sin(theta(h)) * a.z, a.y, std::sin(theta(h)) * a.x + h.z * a.z};
    };
    const Vec3d d = in_half_frame(v);
    cases.push_back({"RUSIN_TH_PH_TD_PD", {theta(h), phi(h), theta(d), phi(d)}, v, l});

    // Isotropic parameterizations: the light has azimuth 0.
    const double light_azimuth = phi(l);
    const auto rotated = [&](Vec3d w) {
        return Vec3d{std::cos(light_azimuth) * w.x + std::sin(light_azimuth) * w.y,
                     std::cos(light_azimuth) * w.y - std::sin(light_azimuth) * w.x, w.z};
    };
    const Vec3d tv = rotated(v), tl = rotated(l);
    const auto projected = [&](Vec3d w) { return std::pair(theta(w) * std::cos(phi(w)), theta(w) * std::sin(phi(w))); };
    const auto [x, y] = projected(tv);
    cases.push_back({"ISOTROPIC_TL_TV_PROJ_DPHI", {theta(l), x, y}, tv, tl});
    cases.push_back({"ISOTROPIC_TV_PROJ_DPHI", {x, y}, tv, Vec3d{0, 0, 1}});
    const double dphi = phi(l) - phi(v);
    cases.push_back(
        {"ISOTROPIC_TV_TL_DPHI", {theta(v), theta(l), dphi}, spherical(theta(v), 0.0), spherical(theta(l), dphi)});
    const Vec3d back = normalize(tv + mirror(tl));  // bisects the viewer and the reflected light
    if (dot(back, tv) > 0.05) {
        const auto [kx, ky] = projected(back);
        cases.push_back({"SCHLICK_TL_TK_PROJ_DPHI", {theta(l), kx, ky}, tv, tl});
    }
    const double between = std::acos(std::min(1.0, dot(v, l)));
    const double cos_at_l = (tv.z - tl.z * std::cos(between)) / (std::sin(theta(l)) * std::sin(between));
    const double sin_at_l = tv.y / std::sin(between);
    cases.push_back({"RETRO_TL_TVL_PROJ_DPHI", {theta(l), between * cos_at_l, between * sin_at_l}, tv, tl});
    // Stark and Neumann: half vector (l + v)/2 and back vector (l − v)/2. The azimuth of the back vector is
    // relative to the half vector.
    const Vec3d half = 0.5 * (l + v), b = 0.5 * (l - v);
    const auto horizontal_length = [](Vec3d w) { return std::hypot(w.x, w.y); };
    const double angle = phi(b) - phi(half), c = std::cos(phi(half)), s = std::sin(phi(half));
    const auto relative_to_half = [&](Vec3d w) { return Vec3d{c * w.x + s * w.y, c * w.y - s * w.x, w.z}; };
    cases.push_back(
        {"STARK_3D", {horizontal_length(half), std::sqrt(dot(b, b)), angle}, relative_to_half(v), relative_to_half(l)});
    // ALTA exchanges the two directions in Neumann's parameterization.
    cases.push_back({"NEUMANN_3D",
                     {horizontal_length(half), horizontal_length(b), angle},
                     relative_to_half(l),
                     relative_to_half(v)});
    return cases;
}

TEST(Alta, ReadsItsParameterizations) {
    std::mt19937_64 random(1);
    std::map<std::string, int> reads;
    for (int i = 0; i < 200; ++i)
        for (const auto& [name, numbers, view, light] : alta_cases(random)) {
            std::string text = "#DIM " + std::to_string(numbers.size()) + " 1\n#PARAM_IN " + name + "\n";
            for (const double x : numbers) text += fmt::format("{:.17g} ", x);
            const auto s = read(read_alta, text + "0.25\n");
            ASSERT_TRUE(s.ok()) << name << ' ' << message(s.error());
            EXPECT_TRUE(near_direction(s->wv[0], view)) << name << ' ' << i;
            EXPECT_TRUE(near_direction(s->wl[0], light)) << name << ' ' << i;
            EXPECT_TRUE(s->isotropic) << name;  // one pair shows no change
            ++reads[name];
        }
    EXPECT_EQ(reads.size(), 11u);
    // These parameterizations omit a dimension; the remaining ones agree.
    const auto read_two = [&](const std::string& name, double a, double b) {
        return *read(read_alta, "#DIM 2 1\n#PARAM_IN " + name + "\n" + fmt::format("{} {} 1\n", a, b));
    };
    for (const auto& [name, theta_h, theta_d] : {std::tuple("RUSIN_TH_TD", 0.3, 0.7), {"COS_TH_TD", 0.3, 0.7}}) {
        const bool cosines = name[0] == 'C';
        const auto s = read_two(name, cosines ? std::cos(theta_h) : theta_h, cosines ? std::cos(theta_d) : theta_d);
        const Vec3f h = s.wl[0] + s.wv[0], d = s.wl[0] - s.wv[0];
        EXPECT_WITHIN(std::atan2(std::hypot(h.x, h.y), h.z), theta_h, 1e-6);
        EXPECT_WITHIN(std::asin(0.5 * std::sqrt(double(dot(d, d)))), theta_d, 1e-6);
    }
    for (const char* name : {"STARK_2D", "NEUMANN_2D"}) {
        const auto s = read_two(name, 0.4, 0.3);
        const Vec3f h = s.wl[0] + s.wv[0], d = s.wl[0] - s.wv[0];
        EXPECT_WITHIN(0.5f * std::hypot(h.x, h.y), 0.4, 1e-6);
        EXPECT_WITHIN(0.5f * std::hypot(d.x, d.y), 0.3, 1e-6);
    }
}

TEST(Alta, ReadsHeadersAndOutputs) {
    const auto s = checked(read(read_alta, k_small_alta));
    EXPECT_EQ(s->description, "Tape");
    ASSERT_EQ(s->wl.size(), 3u);
    EXPECT_EQ(s->colour[2], (Rgb{2.5f, 2.5f, 2.5f}));  // the error bar is ignored
    const auto with_cosine = checked(read(read_alta,
                                          "#DIM 6 3\n#PARAM_IN CARTESIAN\n#PARAM_OUT INV_STERADIAN_COSINE_FACTOR\n"
                                          "0.6 0 0.8 0 0 1 0.4 0.8 1.6\n"));
    for (int c = 0; c < 3; ++c) EXPECT_WITHIN(with_cosine->colour[0][c], 0.5 * (1 << c), 1e-6);

    expect_error(read_alta, "#DIM 2 1\n#PARAM_IN X\n", "line 2: #PARAM_IN: expected one of CARTESIAN, SPHERICAL");
    expect_error(read_alta, "#DIM 2 1\n#PARAM_IN CARTESIAN\n1 1 1\n", "6 inputs for CARTESIAN");
    expect_error(read_alta, "#PARAM_IN CARTESIAN\n1 1 1\n", "a line #DIM before");
    expect_error(read_alta, "#DIM 6 2\n#PARAM_IN CARTESIAN\n1 1 1 1 1 1 1 1\n", "1 or 3 outputs");
    expect_error(read_alta, "#DIM 6 1\n#PARAM_IN CARTESIAN\n0 0 1 0 0 1\n",
                 "line 3: number 7 of 7: expected a number, found the end of the line");
    expect_error(read_alta, "#DIM 6 1\n#FORMAT binary\n", "#FORMAT: expected text");
}

// If lights or viewers have one azimuth, only differences of azimuths are known, and few samples tell no more.
TEST(Csv, IsIsotropicUnlessRotationsChangeValues) {
    const auto is_isotropic = [](const std::string& text) {
        const auto s = read(read_csv, text);
        EXPECT_TRUE(s.ok()) << message(s.error());
        return s.ok() && s->isotropic;
    };
    const std::string angles = "theta_l_deg,phi_l_deg,theta_v_deg,phi_v_deg,value\n";
    EXPECT_TRUE(is_isotropic(angles + "10,180,20,0,1\n60,180,20,180,2\n60,-180,30,0,2\n"));
    EXPECT_TRUE(is_isotropic(angles + "0,0,20,0,1\n60,77,20,180,2\n"));  // a direction along the normal has no azimuth
    EXPECT_TRUE(is_isotropic(angles + "10,0,20,0,1\n60,180,20,180,2\n"));
    const std::string vectors = "wl_x,wl_y,wl_z,wv_x,wv_y,wv_z,value\n";
    EXPECT_TRUE(is_isotropic(vectors + "0,0,1,0.6,0,0.8,1\n0,-0.6,0.8,0,0.6,0.8,2\n0,-0.8,0.6,0,0.6,0.8,2\n"));
    EXPECT_TRUE(is_isotropic(vectors + "0,0.6,0.8,0,0.6,0.8,2\n0,-0.6,0.8,0,0.6,0.8,2\n"));
}

TEST(Csv, ReadsNamedColumns) {
    const auto s = checked(read(read_csv, k_small_csv));
    EXPECT_TRUE(s->isotropic);  // as its header states
    ASSERT_EQ(s->wl.size(), 3u);
    EXPECT_EQ(s->masked, 1u);
    EXPECT_TRUE(near_direction(s->wl[1], spherical(70 * k_degree, 90 * k_degree)));
    EXPECT_TRUE(near_direction(s->wv[1], spherical(70 * k_degree, 270 * k_degree)));
    EXPECT_EQ(s->colour[2], (Rgb{0.4f, 0.5f, 0.5f}));

    const auto vectors = checked(read(read_csv, "wv_x,wv_y,wv_z,wl_x,wl_y,wl_z,value\n0.6,0,0.8,0,0.6,0.8,2\n"));
    EXPECT_TRUE(vectors->isotropic);  // there is only one azimuth of the light
    EXPECT_EQ(vectors->wl[0], (Vec3f{0, 0.6f, 0.8f}));
    EXPECT_EQ(vectors->colour[0], (Rgb{2, 2, 2}));

    const auto spectrum =
        checked(read(read_csv, "theta_l_rad,theta_v_rad,phi_v_rad,450nm,nm550,600.5nm\n0.1,0.2,3,0.5,0.5,0.5\n"));
    EXPECT_EQ(spectrum->wavelengths, (std::vector<float>{450, 550, 600.5f}));
    for (int c = 0; c < 3; ++c) EXPECT_WITHIN(spectrum->colour[0][c], 0.5, 1e-5);
}

/// In every format, a number outside the range of its unit is an error that names its position. A direction below
/// the horizon is masked.
TEST(Angles, OutOfTheRangeOfTheirUnitAreErrors) {
    const std::string csv = "theta_l_rad,phi_l_rad,theta_v_rad,phi_v_rad,value\n0.1,0,0.2,0,1\n";
    const std::string degrees = "theta_l_deg,phi_l_deg,theta_v_deg,phi_v_deg,value\n1,0,2,0,1\n";
    const std::string astm = "VARS theta_i,phi_i,theta_s,phi_s,Y\n0.1,0,0.2,0,1\n";
    const std::string cornell = "1\n550\n0.1 0 0.2 0 1\n";
    expect_error(
        read_csv, csv + "0.1,0,10,0,1\n",
        "line 3: column 3, theta_v_rad: expected a polar angle within 3.142 radians (--columns names angles in "
        "degrees), found 10");
    expect_error(read_csv, csv + "0.1,0,0.2,30,1\n", "column 4, phi_v_rad: expected an azimuth within 12.57 radians");
    expect_error(read_csv, degrees + "400,0,1,0,1\n",
                 "line 3: column 1, theta_l_deg: expected a polar angle within 180");
    expect_error(read_csv, degrees + "-999,0,1,0,1\n", "theta_l_deg");
    expect_error(read_astm, astm + "10,0,0.1,0,1\n", "line 3: column 1, theta_i: expected a polar angle within 3.142");
    expect_error(read_astm, astm + "0.1,0,0.1,80,1\n", "line 3: column 4, phi_s: expected an azimuth");
    expect_error(read_cornell, cornell + "0.1 0 10 0 1\n", "line 4: number 3 of a sample of 5: expected a polar angle");
    for (const auto& [name, row] : std::initializer_list<std::pair<std::string, std::string>>{
             {"4 1\n#PARAM_IN SPHERICAL_TL_PL_TV_PV", "10 0 0.1 0"},
             {"3 1\n#PARAM_IN ISOTROPIC_TV_TL_DPHI", "0.1 10 0"},
             {"3 1\n#PARAM_IN ISOTROPIC_TL_TV_PROJ_DPHI", "0.1 0 10"},
             {"4 1\n#PARAM_IN RUSIN_TH_PH_TD_PD", "0.1 0 10 0"},
             {"3 1\n#PARAM_IN RUSIN_TH_TD_PD", "0.1 0.1 180"},
             {"3 1\n#PARAM_IN SCHLICK_TL_TK_PROJ_DPHI", "10 0 0"}})
        expect_error(read_alta, "#DIM " + name + "\n" + row + " 1\n", "line 3: number ");
    const auto below = checked(read(read_csv, csv + "0.1,0,1.6,0,1\n3.1,0,0.2,0,1\n-0.1,0,0.2,0,1\n"));
    EXPECT_EQ(below->masked, 2u);
    EXPECT_EQ(below->wl.size(), 2u);
}

/// In every format, a value far below 0 that encodes a missing value is masked and noted. Noise and saturated
/// colours remain values.
TEST(ScatteredSamples, MaskMissingValues) {
    const std::string angles = "theta_l_deg,phi_l_deg,theta_v_deg,phi_v_deg,";
    const auto rows = [](const std::string& header, const std::vector<std::string>& values,
                         const std::string& end = "") {
        std::string text = header;
        for (std::size_t i = 0; i < values.size(); ++i)
            text += fmt::format("0.1,0,0.{},0,{}{}\n", i + 1, values[i], end);
        return text;
    };
    const auto masked = [&](auto reader, const std::string& text) {
        const auto s = read(reader, text);
        EXPECT_TRUE(s.ok()) << message(s.error());
        if (!s) return std::size_t(0);
        const auto tells = [](const std::string& note) { return note.find("stands for no value") != note.npos; };
        EXPECT_EQ(std::ranges::any_of(s->notes, tells), s->masked > 0);
        for (const float f : s->spectrum) EXPECT_GT(f, -1);
        for (const Rgb& f : s->colour) EXPECT_GT(f.g, -100);
        return std::size_t(s->masked);
    };
    EXPECT_EQ(masked(read_csv, rows(angles + "value\n", {"-999", "0.2", "-999", "0.3", "-0.01"})), 2u);
    EXPECT_EQ(masked(read_csv, rows(angles + "value\n", {"-9999", "0.2", "-999", "0.3", "2"})), 2u);
    EXPECT_EQ(masked(read_csv, rows(angles + "value\n", {"-1", "0.2", "-1", "0.3"})), 2u);
    // The number is in the unit of the file: reflectance factors near 1, per cent.
    EXPECT_EQ(masked(read_csv, rows(angles + "brf\n", {"-1", "0.95", "-1", "0.93", "-0.02"})), 2u);
    EXPECT_EQ(masked(read_csv, rows(angles + "brf (%)\n", {"-999", "40.5", "41", "39.5"})), 1u);
    EXPECT_EQ(masked(read_csv, rows(angles + "value\n", {"9999", "0.2", "9999", "0.3"})), 2u);
    EXPECT_EQ(masked(read_csv, rows(angles + "value\n", {"65535", "0.2", "65535", "-999", "0.3"})), 3u);
    EXPECT_EQ(masked(read_csv, rows(angles + "r,g,b\n", {"-999,-999,-999", "0.2,0.1,-0.01", "0.2,0.2,0.2"})), 1u);
    EXPECT_EQ(masked(read_csv, rows(angles + "x,y,z\n", {"-999,-999,-999", "0.2,0.1,0.1", "0.2,0.2,0.2"})), 1u);
    EXPECT_EQ(masked(read_csv, rows(angles + "500nm,600nm\n", {"-999,0.1", "0.2,0.1", "0.2,0.2"})), 1u);
    EXPECT_EQ(masked(read_astm, rows("VARS theta_i,phi_i,theta_s,phi_s,Y\n", {"-999", "0.2", "0.3"})), 1u);
    EXPECT_EQ(
        masked(read_alta, "#DIM 3 1\n#PARAM_IN ISOTROPIC_TV_TL_DPHI\n0.1 0.1 0 -99\n0.1 0.2 0 -99\n0.2 0.2 0 1\n"), 2u);
    EXPECT_EQ(masked(read_cornell, "2\n500 600\n0.1 0 0.1 0 -999 -999\n0.1 0 0.2 0 1 1\n"), 1u);
    // A peak that occurs once, a saturated plateau, noise around 0, also quantised; an out-of-gamut colour at a
    // highlight.
    EXPECT_EQ(masked(read_csv, rows(angles + "value\n", {"9999", "0.2", "0.3", "0.2"})), 0u);
    EXPECT_EQ(masked(read_csv, rows(angles + "value\n", {"9999", "9999", "9998", "0.2"})), 0u);
    EXPECT_EQ(masked(read_csv, rows(angles + "value\n", {"-1", "1", "3", "0", "2"})), 0u);
    EXPECT_EQ(masked(read_csv, rows(angles + "value\n", {"-0.25", "-0.25"})), 0u);
    EXPECT_EQ(masked(read_csv, rows(angles + "value\n", {"-0.3", "0.1", "-0.1", "-0.3", "0.2", "-0.2"})), 0u);
    EXPECT_EQ(masked(read_csv, rows(angles + "r,g,b\n", {"-9,100,200", "-9,100,200", "0.1,0.1,0.1", "0.1,0.1,0.1"})),
              0u);
}

/// No format reads such a number as a value: it is masked, or excluded by a rule of the format.
TEST(Formats, MasksNumbersThatStandForNoValue) {
    const TableSource source{[](auto wl, auto wv, auto f) {
                                 for (std::size_t i = 0; i < f.size(); ++i) {  // the detector hides the light
                                     const float value = wl[i].z < 0.8f && dot(wl[i], wv[i]) > 0.8f ? -999 : 0.25f;
                                     f[i] = {value, value, value};
                                 }
                             },
                             true};
    auto rgl = simple_rgl();
    field(rgl, "rgb") = float_field("rgb", {1, 3, 3, 4, 3}, [](std::size_t i) { return i % 12 == 5 ? -999.f : 0.25f; });
    const auto text = [](std::string_view words) { return Bytes(as_bytes(words).begin(), as_bytes(words).end()); };
    std::string bird = "{\"data\":{";
    for (const char* angle : {"theta_i", "phi_i", "theta_r", "phi_r"})
        bird += fmt::format("\"{}\":{{\"unit\":\"deg\",\"values\":[0,0,10,10]}},", angle);
    bird +=
        "\"wavelength_i\":{\"unit\":\"nm\",\"values\":[500,500,500,500]},\"BRDF\":{\"unit\":\"1/"
        "sr\",\"values\":[0.25,-999,0.25,0.5";
    const std::map<std::string_view, Bytes> read_alone{
        {"RGL", tensor_file(rgl)},
        {"UTIA", utia_file([](int l, int, int v, int, int) { return l == 3 && v == 3 ? -999 : 0.25; })},
        {"ALTA", text("#DIM 3 1\n#PARAM_IN ISOTROPIC_TV_TL_DPHI\n#PARAM_OUT INV_STERADIAN_COSINE_FACTOR\n"
                      "0.1 0.1 0 -999\n0.3 0.2 0 -999\n0.2 0.2 0 .25\n")},
        {"ASTM E1392", text("VARS theta_i,theta_s,phi_s,Y\n0.1,0.1,0,-999\n0.2,0.1,0,0.25\n")},
        {"Cornell", text("1\n500\n0.1 0 0.1 0 -999\n0.1 0 0.2 0 .25\n")},
        {"FRED", text("type bsdf_data\nformat angles=deg bsdf=value scale=0.1\n30 0\n10 0 .25\n20 0 -999\n")},
        {"BiRD", text(bird + "]}}}")}};
    for (const Format& format : formats()) {
        const auto known = read_alone.find(format.name);
        ASSERT_TRUE(known != read_alone.end() || format.write) << "read_alone lacks a file of " << format.name;
        const Bytes bytes = known != read_alone.end() ? known->second : *format.write(source, {});
        const auto measured = read_measured(bytes, "f");
        ASSERT_TRUE(measured.ok()) << format.name << ' ' << message(measured.error());
        EXPECT_EQ(measured->format, format.name);
        std::mt19937_64 random(1);
        for (int i = 0; i < 300; ++i) {
            const Vec3f wl = to_float(random_direction(random, 0.5)), wv = to_float(random_direction(random, 0.5));
            const Rgb f = signed_value(*measured, wl, wv);
            EXPECT_FALSE(f.g < -2 || f.g > 4) << format.name << ' ' << f.g;
        }
    }
    const std::vector<Vec3f> up(3, {0, 0, 1}), light{{0, 0, 1}, {0, 0.6f, 0.8f}, {0, 0, -1}};
    const auto samples = valid_samples(light, up, std::vector<Rgb>{{-999, -999, -999}, {1, 2, 3}, {1, 2, 3}}, true);
    EXPECT_EQ(samples.masked, 2u);
    EXPECT_EQ(samples.wl, std::vector<Vec3f>(1, light[1]));
    EXPECT_EQ(samples.notes.size(), 1u);
}

/// A text is read in other encodings too, and errors name the type of other files.
TEST(Formats, OtherEncodingsAndFilesAreRecognised) {
    const std::string text = "theta_i (°),theta_o (°),phi (°),brdf\n10,20,30,1\n20,30,40,2\n";
    const auto expected = read(read_csv, text);
    std::string cr = text, little = "\xff\xfe", big = "\xfe\xff";
    std::ranges::replace(cr, '\n', '\r');
    for (const char c : text)
        if (c != '\xc2')  // "°" is U+00B0, "\xc2\xb0" in UTF-8
            little += {c, '\0'}, big += {'\0', c};
    for (const std::string& other : {cr, little, big}) {
        const auto measured = checked(read_measured(as_bytes(other), "f"));
        EXPECT_EQ(std::get<ScatteredSamples>(measured->table).wv, expected->wv);
    }
    const auto polarized = tensor_file({float_field("M", {1}, [](std::size_t) { return 1.f; })});
    const std::string tensor(reinterpret_cast<const char*>(polarized.data()), polarized.size());
    for (const auto& [bytes, words] : std::initializer_list<std::pair<std::string, std::string>>{
             {"\xd0\xcf\x11\xe0\xa1\xb1", "save the sheet as CSV"},
             {"PK\x03\x04..[Content_Types].xml", "save the sheet as CSV"},
             {"PK\x03\x04..", "a ZIP archive; unpack it"},
             {"\x1f\x8b..", "gunzip"},
             {"<?xml version=\"1.0\"?>\n<!DOCTYPE html>\n<HTML>", "a web page, not a file of data"},
             {"#ALTA FUNC HEADER\n#DIM 2 1\n", "a function that ALTA fitted"},
             {tensor, "Mueller matrices of a polarized one"}}) {
        const auto measured = read_measured(as_bytes(bytes), "f");
        EXPECT_CONTAINS(error_text(measured), words);
    }
}

/// A function of both polar angles and the azimuth between viewer and light, written as a table in a text format.
struct WrittenTable {
    std::string header, separator = ",", decimal = ".";
    std::string angles;  ///< their format in a row, with the names below
    Quantity quantity = Quantity::bsdf;
    double unit = 1;

    static double f(double theta_l, double theta_v, double phi) {
        const Vec3d wl = spherical(theta_l * k_degree, 0.0), wv = spherical(theta_v * k_degree, phi * k_degree);
        const Vec3d h = normalize(wl + wv);
        return 0.2 + 2 * std::pow(h.z, 40);
    }
    /// The angles of a sample: θ_l, θ_v, and the viewer's azimuth relative to the light [degrees].
    std::string row(double l, double v, double phi) const {
        const double detector = phi == 180 ? v : -v,  // positive on the mirror's side of the plane of incidence
            phase = std::acos(dot(spherical(l * k_degree, 0.0), spherical(v * k_degree, phi * k_degree))) / k_degree;
        return fmt::format(fmt::runtime(angles), fmt::arg("l", l), fmt::arg("v", v), fmt::arg("phi", phi),
                           fmt::arg("l_rad", l * k_degree), fmt::arg("v_rad", v * k_degree),
                           fmt::arg("phi_rad", phi * k_degree), fmt::arg("from_mirror", phi - 180),
                           fmt::arg("opposite", phi + 180), fmt::arg("detector", detector),
                           fmt::arg("aspecular", l - detector), fmt::arg("phase", phase));
    }
    std::string text(bool in_plane) const {
        std::string content = header + "\n";
        for (const double l : {10., 30., 50.})
            for (const double v : {0., 10., 30., 50., 70.})
                for (const double phi : {0., 60., 120., 180.}) {
                    if (in_plane && phi != 0 && phi != 180) continue;
                    double value = f(l, v, phi);
                    if (quantity == Quantity::factor) value *= k_pi;
                    if (quantity == Quantity::cosine) value *= std::cos(v * k_degree);
                    value /= unit;
                    std::string line = row(l, v, phi) + fmt::format(" {:.6f}\n", value);
                    for (std::string::size_type position = 0; (position = line.find('.', position)) != line.npos;
                         position += decimal.size())
                        line.replace(position, 1, decimal);
                    for (std::string::size_type position = 0; (position = line.find(' ', position)) != line.npos;
                         position += separator.size())
                        line.replace(position, 1, separator);
                    content += line;
                }
        return content;
    }
};

/// The samples are those of a `WrittenTable`.
void expect_written(const ScatteredSamples& samples, const std::string& header) {
    EXPECT_TRUE(samples.isotropic);
    for (std::size_t i = 0; i < samples.wl.size(); ++i) {
        const double h = double(normalize(samples.wl[i] + samples.wv[i]).z);
        EXPECT_WITHIN(samples.colour[i].g, 0.2 + 2 * std::pow(h, 40), 1e-4) << header;
    }
}

/// The same function is read from names, units, separators and azimuths as instruments and spreadsheets write them.
TEST(Csv, ReadsCommonLayouts) {
    const std::string degrees = "{l} 0 {v} {phi}", radians = "{l_rad:.6f} 0 {v_rad:.6f} {phi_rad:.6f}";
    constexpr Quantity factor = Quantity::factor, bsdf = Quantity::bsdf;
    struct Case {
        WrittenTable table;
        std::string note, columns = {};
        bool in_plane = false;
        Quantity quantity = Quantity::stated;
    };
    const Case cases[] = {
        {{"theta_l_deg;phi_l_deg;theta_v_deg;phi_v_deg;value", ";", ",", degrees}, "decimal comma"},
        {{"theta_l_deg\tphi_l_deg\ttheta_v_deg\tphi_v_deg\tvalue", "\t", ",", degrees}, "decimal comma"},
        {{"theta_l_deg phi_l_deg theta_v_deg phi_v_deg value", " ", ".", degrees}, ""},
        {{"Instrument: X\nDate; 5 May\n\ntheta_l_deg,phi_l_deg,theta_v_deg,phi_v_deg,value", ",", ".", degrees}, ""},
        {{"# theta_i phi_i theta_o phi_o brdf", " ", ".", degrees}, "light: theta_i, phi_i; viewer: theta_o, phi_o"},
        {{"theta-in,phi-in,theta-out,phi-out,BRDF", ",", ".", degrees}, "angles are in degrees"},
        {{"Theta_i [rad],Phi_i [rad],Theta_s [rad],Phi_s [rad],BRDF [1/sr]", ",", ".", radians}, "viewer: Theta_s"},
        {{"theta_i,phi_i,theta_r,phi_r,f_r", ",", ".", radians}, "angles are in radians"},
        {{"θi (°),φi (°),θr (°),φr (°),BRDF (sr^-1)", ",", ".", degrees}, "light: θi"},
        {{"incident_zenith,incident_azimuth,view_zenith,view_azimuth,L_o,brdf", ",", ".", "{l} 0 {v} {phi} 7"},
         "not read: L_o"},
        {{"phi_i,theta_i,phi_o,theta_o,brdf", ",", ".", "{l} 180 {v} {opposite}"}, "phi_i and phi_o are polar angles"},
        {{"theta_l_deg,theta_v_deg,dphi_deg,value", ",", ".", "{l} {v} {phi}"}, "viewer: theta_v_deg, dphi_deg"},
        {{"theta_l_deg,theta_v_deg,phi_v_deg,value", ",", ".", "{l} {v} {phi}"}, "azimuth of the light is not stated"},
        {{"theta_l_deg,theta_v_deg,phi_v_deg,value", ",", ".", "{l} {v} {from_mirror}"}, "", "phi_l_deg=180"},
        {{"no header", " ", ".", "{l} {v} {from_mirror}"}, "", "theta_l_deg,theta_v_deg,phi_v_deg,value,phi_l_deg=180"},
        {{"no header", ";", ",", degrees}, "decimal comma", "theta_l_deg,phi_l_deg,theta_v_deg,phi_v_deg,value"},
        {.table = {"aoi_deg,detector_angle_deg,brdf", ",", ".", "{l} {detector}"},
         .note = "mirror side",
         .in_plane = true},
        {.table = {"theta_i,theta_s,brdf", ",", ".", "-{l} {detector}"}, .note = "mirror side", .in_plane = true},
        {{"theta_i,phi_i,theta_o,phi_o,reflectance factor", ",", ".", degrees, Quantity::factor},
         "reflectance factors"},
        {{"theta_i,phi_i,theta_o,phi_o,ccBRDF", ",", ".", degrees, Quantity::cosine}, "f cosθ"},
        {.table = {"theta_i,phi_i,theta_o,phi_o,brdf", ",", ".", degrees, Quantity::cosine},
         .note = "light",
         .quantity = Quantity::cosine},
        {.table = {"theta_i,phi_i,theta_o,phi_o,brdf", ",", ".", degrees, Quantity::factor},
         .note = "light",
         .quantity = Quantity::factor},
        {{"sun_zenith,sun_azimuth,sensor_zenith,sensor_azimuth,reflectance", ",", ".", degrees, factor}, "factors"},
        {{"to-sun zenith,to-sun azimuth,to-sensor zn,to-sensor az,R550", ",", ".", degrees, factor}, "factors"},
        {{"src_z,src_a,view_z,view_a,550", ",", ".", degrees}, "viewer: view_z, view_a"},
        {{"theta_src,phi_src,theta_d,phi_d,0.55 µm", ",", ".", degrees}, "viewer: theta_d, phi_d"},
        {{"sza,vza,raa,BRF_670", ",", ".", "{l} {v} {phi}", factor}, "relative azimuth of 0 is taken as backward"},
        {{"theta_i,phi_i,theta_o,phi_o,BRF (%)", ",", ".", degrees, factor, 0.01}, "units of 0.01"},
        {{"theta_i,phi_i,theta_o,phi_o,BRDF [1e-3/sr]", ",", ".", degrees, bsdf, 1e-3}, "units of 0.001"},
        {{"theta_i,phi_i,theta_o,phi_o,f\n°,°,°,°,10^-3 sr^-1", ",", ".", degrees, bsdf, 1e-3}, "units of 0.001"},
        {{"theta_i,phi_i,theta_o,phi_o,x,y,z,brdf", ",", ".", "{l} 0 {v} {phi} 12.5 3 0"}, "not read: x, y, z"},
        {{"theta_i,phi_i,theta_o,phi_o,brdf_s,brdf_p", ",", ".", "{l} 0 {v} {phi} 0", bsdf, 0.5}, "means of both"},
        {{"incidence,emission,phase,brdf", ",", ".", "{l} {v} {phase:.6f}"}, "viewer: emission, phase"},
        {.table = {"theta_i_deg,aspecular_angle_deg,brdf", ",", ".", "{l} {aspecular}"},
         .note = "from the mirror direction",
         .in_plane = true},
        {{",,,,\ntheta_i,phi_i,theta_o,phi_o,brdf\n,,,,", ",", ".", degrees}, "light"},
    };
    const auto csv = std::ranges::find(formats(), "CSV", &Format::name);
    for (const auto& [table, note, columns, in_plane, quantity] : cases) {
        const std::string text = table.text(in_plane);
        EXPECT_TRUE(csv->recognise(as_bytes(text)) || columns.find("theta") != columns.npos) << text;
        const auto measured = read_measured(as_bytes(text), "f", {columns, quantity, 0});
        ASSERT_TRUE(measured.ok()) << message(measured.error()) << '\n' << text;
        const auto& s = std::get<ScatteredSamples>(measured->table);
        EXPECT_EQ(s.wl.size(), in_plane ? 30u : 60u) << text;
        expect_written(s, table.header);
        std::string notes;
        for (const std::string& line : s.notes) notes += line + "\n";
        EXPECT_EQ(notes.empty(), note.empty()) << notes;
        EXPECT_CONTAINS(notes, note);
    }
}

TEST(Csv, RefusesAmbiguousColumns) {
    expect_error(read_csv, "theta_i,phi_i,theta_o,phi_o,brdf\n0.1,0,0.2,0,1\n", "angles with their unit");
    expect_error(read_csv, "theta_l_deg,theta_v_deg,phi_v_deg,r,g,b,r\n1,1,1,1,1,1,9\n",
                 "columns 4 and 7, 'r' and 'r'");
    expect_error(read_csv, "theta_l_deg,theta_i_deg,theta_v_deg,phi_v_deg,value\n", "'theta_l_deg' and 'theta_i_deg'");
    expect_error(read_csv, "theta_l_deg,theta_v_deg,value\n-30,30,1\n30,30,1\n",
                 "phi_l_deg=0,phi_v_deg=0 in --columns");
    const std::string angles = "theta_l_deg,theta_v_deg,phi_v_deg,";
    expect_error(read_csv, angles + "wavelength,r,g,b\n1,2,3,500,1,1,1\n1,2,3,600,1,1,1\n",
                 "line 3: wavelength: expected one in all rows, or one value in a row, or a column for each as 532nm");
    expect_error(read_csv, angles + "value,brdf\n", "found 'value' and 'brdf'");
    expect_error(read_csv, angles + "brdf,550nm\n", "found 'brdf' and '550nm'");
    expect_error(read_csv, angles + "BRDF [dB]\n", "found the unit of 'BRDF [dB]'");
    expect_error(read_csv, "angle_deg,reflectance_percent\n", "theta_both_deg");
    expect_error(read_csv, "theta_v_deg,phi_v_deg,value\n1,2,3\n", "theta_l_deg=30 in --columns, found no theta_l");
    for (const char* wrong : {"phi_l=180", "phi_l_deg=x", "theta_l_deg=400", "value=1", "theta_l_deg=1"}) {
        const auto measured =
            read_measured(as_bytes("theta_l_deg,theta_v_deg,phi_v_deg,value\n1,2,3,4\n"), "f", {wrong, {}, 0});
        ASSERT_FALSE(measured.ok()) << wrong;
        EXPECT_CONTAINS(error_text(measured), "f: --columns: expected");
    }
    const auto isotropic = checked(read_measured(as_bytes("# isotropic\n10 0 20 0 1\n10 90 20 0 1\n"), "f",
                                                 {"theta_l_deg,phi_l_deg,theta_v_deg,phi_v_deg,value", {}, 0}));
    EXPECT_TRUE(is_isotropic(*isotropic));
}

/// Layouts with a row for each wavelength, with one angle for light and viewer, and of multi-angle instruments.
TEST(Csv, ReadsOtherLayouts) {
    const auto rows =
        checked(read(read_csv,
                     "theta_i_deg,theta_r_deg,phi_deg,wavelength [um],BRDF\n10,20,30,0.45,1\n10,20,30,0.55,2\n"
                     "10,40,30,0.45,3\n10,40,30,0.55,4\n"));
    EXPECT_EQ(rows->wavelengths, (std::vector<float>{450, 550}));
    EXPECT_EQ(rows->spectrum, (std::vector<float>{1, 2, 3, 4}));
    EXPECT_TRUE(near_direction(rows->wv[1], spherical(40 * k_degree, 30 * k_degree)));
    const auto lidar = checked(read(read_csv, "theta_both_deg,reflectance_percent\n10,200\n20,100\n"));
    EXPECT_EQ(lidar->wl, lidar->wv);
    EXPECT_WITHIN(lidar->colour[1].g, 1 / k_pi, 1e-6);
    const auto angles = checked(read(read_csv, "45as-15,45as15,45as110\n1,2,3\n"));
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_TRUE(near_direction(angles->wl[i], spherical(45 * k_degree, k_pi)));
        EXPECT_TRUE(near_direction(angles->wv[i], spherical((i == 0 ? 60 : i == 1 ? 30 : -65) * k_degree, 0.0)));
        EXPECT_WITHIN(angles->colour[i].g, double(i + 1) / k_pi, 1e-6);
    }
    const auto small =
        checked(read(read_csv, "theta_l_deg,theta_v_deg,phi_v_deg,value\n0.5,1.4,3,1\n0.5,1,3,N/A\n#N/A,1,3,1\n"));
    EXPECT_EQ(small->masked, 1u);  // the last row is a comment
    EXPECT_CONTAINS(small->notes[0], "all polar angles are within 1.4 degrees: radians?");
}

TEST(Csv, ReportsErrors) {
    expect_error(read_csv, "", "names of columns, found an empty file");
    expect_error(read_csv, "theta_l,phi_l,theta_v,phi_v,r,g,b\n", "angles with their unit");
    expect_error(read_csv, "theta_l_deg,phi_l_deg,theta_v_deg,r,g,b\n", "no phi_v");
    expect_error(read_csv, "theta_l_deg,theta_v_deg,phi_v_deg,a,b\n", "values in columns r,g,b");
    expect_error(read_csv, "theta_l_deg,theta_v_deg,phi_v_deg,600nm,500nm\n", "increasing wavelengths");
    expect_error(read_csv, "theta_l_deg,theta_v_deg,phi_v_deg,value\n1,2,3\n",
                 "line 2: sample: expected 4 numbers, found 3");
    expect_error(read_csv, "theta_l_deg,theta_v_deg,phi_v_deg,value\n1,2,3,x\n",
                 "line 2: column 4: expected a number, found 'x'");
    expect_error(read_csv, "wl_x,wl_y,wl_z,wv_x,wv_y,wv_z,value\n0,0,1,0,1,1,1\n",
                 "line 2: direction wv: expected length 1");
}

/// Samples of a smooth BRDF at random pairs of directions.
ScatteredSamples samples_of(const std::function<Rgb(Vec3d, Vec3d)>& f, int count, bool isotropic, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    ScatteredSamples s;
    s.isotropic = isotropic;
    for (int i = 0; i < count; ++i) {
        const Vec3d wl = random_direction(random, 0.1), wv = random_direction(random, 0.1);
        s.wl.push_back(to_float(wl));
        s.wv.push_back(to_float(wv));
        s.colour.push_back(f(wl, wv));
    }
    make_index(s);
    return s;
}

/// A file of one angle of the light, which stands in its header, as goniophotometers of pab write it.
Measured scan_at(int theta, std::string_view angles, std::string_view value = "BSDF") {
    std::string text = fmt::format("#sample_name \"paint\"\n#date 2026-11-{} 10:30\n", theta);
    text += fmt::format(fmt::runtime(angles), theta) + fmt::format("\n#format: theta phi {}\n", value);
    for (int i = 0; i < 6; ++i) text += fmt::format("{} {} 0.{}{}\n", 12 * i, 60 * i, theta, i);
    return *read_measured(as_bytes(text), fmt::format("d/{}.txt", theta));
}

TEST(Joined, HasTheSamplesOfAllFilesAndTheAnglesOfTheirHeaders) {
    for (const char* angles :
         {"#intheta {}\n#inphi 30", "#incident_angle\t{}\t30", "# Incidence (deg) = {}\n# phi_i: 30°"}) {
        const auto all =
            checked(join_measurements(std::array{scan_at(10, angles), scan_at(30, angles), scan_at(50, angles)}));
        EXPECT_EQ(all->source, "10.txt, 30.txt, 50.txt");
        const auto& s = std::get<ScatteredSamples>(all->table);
        EXPECT_CONTAINS(s.notes[0],
                        "3 files as one sample: incidence 10, 30, 50 degrees; the same grey, value: BSDF, ");
        EXPECT_CONTAINS(s.notes[0], "sample_name \"paint\"; different ");
        EXPECT_CONTAINS(s.notes[0], " date");
        EXPECT_TRUE(s.isotropic);
        ASSERT_EQ(s.wl.size(), 18u);
        for (std::size_t i = 0; i < 18; ++i) {
            const double theta = double(10 + 20 * (i / 6)) * k_degree, viewer = double(12 * (i % 6)) * k_degree;
            EXPECT_TRUE(near_direction(s.wl[i], spherical(theta, 30 * k_degree))) << angles;
            EXPECT_TRUE(near_direction(s.wv[i], spherical(viewer, 5 * viewer))) << angles;
        }
        EXPECT_WITHIN(value(*all, s.wl[7], s.wv[7]).g, 0.301, 1e-6);
    }
}

TEST(Joined, RefusesFilesOfDifferentSamples) {
    const Measured first = scan_at(10, "#intheta {}"), table{"d/m.binary", "MERL", 0, MerlTable{}};
    for (const Measured& other : {scan_at(30, "#intheta {}", "BTDF"), scan_at(30, "#intheta {}", "DSF"),
                                  scan_at(30, "#intheta {}", "BRF(%)"), scan_at(30, "#intheta {}", "532nm"), table})
        for (const auto& files : {std::array{first, other}, std::array{other, first}}) {
            const std::string said = message(join_measurements(files).error());
            EXPECT_CONTAINS(said, "one sample: expected ");
            EXPECT_CONTAINS(said, "10.txt");
            EXPECT_CONTAINS(said, other.source.substr(2));
        }
}

TEST(ScatteredSamples, InterpolationPassesThroughItsSamples) {
    std::mt19937_64 random(3);
    for (const bool isotropic : {true, false}) {
        const auto s = samples_of(
            [&](Vec3d, Vec3d) {
                return Rgb{float(uniform(random)), float(uniform(random)), -float(uniform(random))};
            },
            2000, isotropic, 4);
        for (std::size_t i = 0; i < s.wl.size(); ++i) {
            const Rgb f = signed_value(s, s.wl[i], s.wv[i]);
            EXPECT_RGB_WITHIN(f, s.colour[i], 1e-4);
            EXPECT_EQ(value(s, s.wl[i], s.wv[i]).b, 0);
            if (!isotropic) continue;
            const Rgb rotated = signed_value(s, rotate(s.wl[i], 2.0), rotate(s.wv[i], 2.0));
            EXPECT_RGB_WITHIN(rotated, s.colour[i], 2e-2);
        }
    }
}

TEST(ScatteredSamples, InterpolationConverges) {
    // For a smooth BRDF the error falls as the number of samples grows.
    std::mt19937_64 random(6);
    const auto glossy = [](Vec3d wl, Vec3d wv) {
        const Vec3d h = normalize(wl + wv);
        return Rgb{float(0.3 + 3 * std::pow(h.z, 30)), 0.2f, float(0.1 + wl.z * wv.z)};
    };
    double last = 1;
    for (const int count : {500, 4000, 32000}) {
        const auto s = samples_of(glossy, count, true, 7);
        double difference = 0, total = 0;
        for (int i = 0; i < 4000; ++i) {
            const Vec3d wl = random_direction(random, 0.2), wv = random_direction(random, 0.2);
            const Rgb f = value(s, to_float(wl), to_float(wv)), g = glossy(wl, wv);
            for (int c = 0; c < 3; ++c) {
                difference += std::pow(double(f[c]) - double(g[c]), 2);
                total += double(g[c]) * double(g[c]);
            }
        }
        EXPECT_LT(difference / total, count == 500 ? 0.05 : last / 3) << count;
        last = difference / total;
    }
    EXPECT_LT(last, 2e-3);
}

/// Few and many samples: anywhere, in one plane, of one light, and near the horizon.
TEST(ScatteredSamples, InterpolationKeepsConstantsAndStaysWithinTheSamples) {
    std::mt19937_64 random(5);
    const auto pair = [&](int kind) {
        const double phi = 6 * uniform(random), theta_l = kind < 3 ? 1.5 * uniform(random) : 1.5;
        return std::pair(to_float(spherical(kind == 2 ? 0.5 : theta_l, kind == 0 || kind == 3 ? phi : k_pi)),
                         to_float(spherical(1.55 * uniform(random), kind == 1 ? 0 : 6 * uniform(random))));
    };
    for (const int count : {1, 2, 7, 12, 60, 700})
        for (int kind = 0; kind < 8; ++kind) {
            ScatteredSamples constant, any;
            constant.isotropic = any.isotropic = kind < 4;
            std::array<float, 2> f_range{9, 0}, fa_range{9, 0};
            for (int i = 0; i < count; ++i) {
                const auto [wl, wv] = pair(kind % 4);
                const auto f = float(uniform(random));
                for (ScatteredSamples* s : {&constant, &any}) s->wl.push_back(wl), s->wv.push_back(wv);
                constant.colour.push_back({0.1f, 0.2f, 0.3f}), any.colour.push_back({f, f, f});
                const auto add = [](auto& range, float x) { range = {std::min(range[0], x), std::max(range[1], x)}; };
                add(f_range, f);
                add(fa_range, f * wl.z * wv.z);
            }
            make_index(constant);
            make_index(any);
            for (int i = 0; i < 100; ++i) {
                const Vec3f wl = to_float(random_direction(random, 1e-4)),
                            wv = to_float(random_direction(random, 1e-4));
                ASSERT_EQ(value(constant, wl, wv), (Rgb{0.1f, 0.2f, 0.3f})) << count << ' ' << kind;
                const float f = value(any, wl, wv).r, area = wl.z * wv.z;
                ASSERT_GE(f, 0.999f * std::min(f_range[0], fa_range[0] / area)) << count << ' ' << kind;
                ASSERT_LE(f, 1.001f * std::max(f_range[1], fa_range[1] / area)) << count << ' ' << kind;
            }
        }
}

TEST(ScatteredSamples, SpectraBetweenSamplesHaveTheirColour) {
    std::mt19937_64 random(21);
    ScatteredSamples samples;
    samples.wavelengths = {450, 500, 600, 650};
    const auto weights = rgb_weights(samples.wavelengths);
    for (int i = 0; i < 200; ++i) {
        samples.wl.push_back(to_float(random_direction(random, 0.1)));
        samples.wv.push_back(to_float(random_direction(random, 0.1)));
        const std::vector<float> f{float(uniform(random)), 0.3f, float(uniform(random)), samples.wl.back().z};
        samples.spectrum.insert(samples.spectrum.end(), f.begin(), f.end());
        samples.colour.push_back(to_rgb(f, weights));
    }
    make_index(samples);
    std::vector<float> f(4);
    for (int i = 0; i < 500; ++i) {
        const Vec3f wl = i < 200 ? samples.wl[std::size_t(i)] : to_float(random_direction(random, -0.1)),
                    wv = i < 200 ? samples.wv[std::size_t(i)] : to_float(random_direction(random, -0.1));
        signed_spectrum(samples, wl, wv, f);
        const Rgb expected = to_rgb(f, weights), colour = signed_value(samples, wl, wv);
        for (int c = 0; c < 3; ++c)
            EXPECT_WITHIN(colour[c], expected[c], 1e-4 * (std::abs(double(expected[c])) + double(f[1])));
        if (i < 200) {
            EXPECT_WITHIN(f[1], 0.3, 1e-6);
        }
    }
}

TEST(ScatteredSamples, ManySamplesOfOnePairAreInterpolatedQuickly) {
    ScatteredSamples samples;
    const Vec3f wl = to_float(spherical(0.5, 0.0)), wv = to_float(spherical(0.7, 2.0));
    samples.wl.assign(50'000, wl);
    samples.wv.assign(samples.wl.size(), wv);
    samples.colour.assign(samples.wl.size(), {0.25f, 0.5f, 1});
    make_index(samples);
    for (int i = 0; i < 100; ++i) {
        const Vec3f l = i == 0 ? wl : to_float(spherical(0.01 * i, 0.0));
        const Rgb f = value(samples, l, wv);
        EXPECT_EQ(f, (Rgb{0.25f, 0.5f, 1}));
    }
}

TEST(ScatteredSamples, MeasuredPaintsAreReadAndInterpolated) {
    const auto folder = shared_data();
    if (!std::filesystem::exists(folder / "cornell")) GTEST_SKIP() << folder << " is not here";
    for (const char* name : {"krylon_blue", "garnet_red", "acryl_blue"}) {
        const auto paint = checked(load_measured((folder / "cornell" / (std::string(name) + ".brdf")).string()));
        EXPECT_EQ(paint->format, "Cornell");
        const auto& s = std::get<ScatteredSamples>(paint->table);
        EXPECT_EQ(s.wl.size(), 1439u);
        EXPECT_EQ(s.wavelengths.size(), 31u);
        EXPECT_TRUE(s.isotropic && s.masked == 0);
    }
    // These files have the same samples as spectra and as colours.
    const auto spectra = load_measured((folder / "cornell" / "krylon_blue.brdf").string());
    const auto colours = checked(load_measured((folder / "cornell" / "krylon_blue_RGB.astm").string()));
    EXPECT_EQ(colours->format, "ASTM E1392");
    const auto &a = std::get<ScatteredSamples>(spectra->table).colour,
               &b = std::get<ScatteredSamples>(colours->table).colour;
    ASSERT_EQ(a.size(), b.size());
    double difference = 0, total = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        for (int c = 0; c < 3; ++c) {
            difference += std::pow(double(a[i][c]) - double(b[i][c]), 2);
            total += std::pow(double(a[i][c]), 2);
            EXPECT_WITHIN(b[i][c], a[i][c], 6e-3 * std::abs(double(a[i].b)) + 1e-5);
        }
    EXPECT_LT(difference / total, 2e-8);

    const auto tape = checked(load_measured((folder / "alta" / "retro-gray-tape.dat").string()));
    EXPECT_EQ(tape->format, "ALTA");
    const auto& s = std::get<ScatteredSamples>(tape->table);
    EXPECT_EQ(s.wl.size() + s.masked, 7405u);  // the masked ones are at 90°
    // The tape is retroreflective: at 30°, f is larger towards the light than in the mirror direction.
    const Vec3f light = to_float(spherical(30 * k_degree, 0.0));
    EXPECT_GT(value(s, light, light).g, 10 * value(s, light, mirror(light)).g);
}

}  // namespace
}  // namespace srbf::scattered_test
