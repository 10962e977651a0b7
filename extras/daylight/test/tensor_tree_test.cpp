// Tensor trees: parsing, look-up, real files, refused files, and writing BSDF XML.
#include "extras/daylight/tensor_tree.h"
#include "bad_texts.h"
#include "brdf/directions.h"
#include "brdf/parts.h"
#include "brdf_functions.h"
#include "extras/daylight/test/bsdf_files.h"
#include "extras/daylight/tree_beam.h"
#include "measured/tables.h"
#include "properties.h"
#include "srbf/file.h"
#include "srbf/load.h"

namespace srbf::tensor_tree_test {
namespace {

Result<Measured> read(const std::string& text) { return read_measured(as_bytes(text), "f"); }

std::string tree_block(const std::string& part, const std::string& tree, const std::string& band = "Visible") {
    return "<WavelengthData><Wavelength unit=\"Integral\">" + band +
           "</Wavelength><WavelengthDataBlock><WavelengthDataDirection>" + part +
           "</WavelengthDataDirection><AngleBasis>LBNL/Shirley-Chiu</AngleBasis><ScatteringData>" + tree +
           "</ScatteringData></WavelengthDataBlock></WavelengthData>\n";
}

/// The text of a grid of this level whose leaves are f(x).
std::string grid_text(int rank, int level, const std::function<double(std::array<double, 4>)>& f) {
    std::string text = "{";
    const std::size_t n = std::size_t(1) << level;
    for (std::size_t k = 0; k < std::size_t(1) << rank * level; ++k) {
        std::array<double, 4> x{};
        for (std::size_t i = std::size_t(rank), remaining = k; i-- > 0; remaining /= n)
            x[i] = (double(remaining % n) + 0.5) / double(n);
        text += fmt::format(" {:.7g}", f(x));
    }
    return text + " }";
}

double sum_of(const std::array<double, 4>& x) { return x[0] + 10 * x[1] + 100 * x[2] + 1000 * x[3]; }

/// A branch whose children are single numbers has the values of a grid of that level. With several levels it has
/// the values of its leaves.
TEST(TensorTree, BranchesAndGridsAgree) {
    for (const int rank : {3, 4}) {
        const auto grid = checked(read_tensor_tree(grid_text(rank, 2, sum_of), rank));
        std::string branches = "{";
        for (int child = 0; child < 1 << rank; ++child)
            branches += grid_text(rank, 1, [&](std::array<double, 4> x) {
                for (std::size_t i = 0; i < 4; ++i) x[i] = (x[i] + (child >> i & 1)) / 2;
                if (rank == 3) x[3] = 0;
                return sum_of(x);
            });
        const auto tree = checked(read_tensor_tree(branches + "}\n", rank));
        EXPECT_EQ(tree->smallest_leaf(), 0.25f);
        std::mt19937_64 random(1);
        for (int i = 0; i < 500; ++i) {
            std::array<double, 4> x{uniform(random), uniform(random), uniform(random), rank == 4 ? uniform(random) : 0};
            EXPECT_EQ(grid->at(x), tree->at(x));
            for (int k = 0; k < rank; ++k) x[std::size_t(k)] = (std::floor(4 * x[std::size_t(k)]) + 0.5) / 4;
            EXPECT_WITHIN(tree->at(x), sum_of(x), 1e-3);
        }
    }
}

/// A tree stores a function of p = (wl.x, −wl.y) and q = (−wv.x, wv.y), as Radiance defines trees, within the
/// accuracy of a leaf. The mean over the square of outgoing directions × π is the directional-hemispherical sum.
TEST(TensorTree, DirectionsAreRadiances) {
    const auto disc = [](double u, double v) {  // the inverse map
        const double a = 2 * u - 1, b = 2 * v - 1;
        if (a == 0 && b == 0) return std::array{0.0, 0.0};
        const double r = std::abs(a) > std::abs(b) ? a : b;
        const double phi = std::abs(a) > std::abs(b) ? k_pi / 4 * b / a : k_pi / 2 - k_pi / 4 * a / b;
        return std::array{r * std::cos(phi), r * std::sin(phi)};
    };
    const auto f = [](double px, double py, double qx, double qy) { return 3 + px + 0.5 * py * qx - 0.7 * qy; };
    const std::string four = grid_text(4, 4, [&](std::array<double, 4> x) {
        const auto p = disc(x[0], x[1]), q = disc(x[2], x[3]);
        return f(p[0], p[1], q[0], q[1]);
    });
    const std::string three = grid_text(3, 5, [&](std::array<double, 4> x) {
        const auto q = disc(x[1], x[2]);
        return x[0] > 0.5 ? 0 : f(1 - 2 * x[0], 0, q[0], q[1]);
    });
    const auto a = checked(read(bsdf_xml("", tree_block("Transmission Back", four), "TensorTree4"))),
               b = checked(read(bsdf_xml("", tree_block("Reflection Front", three), "TensorTree3")));
    EXPECT_EQ(a->format, "BSDF tree");
    EXPECT_FALSE(is_isotropic(*a));
    EXPECT_TRUE(is_isotropic(*b));
    std::mt19937_64 random(2);
    for (int i = 0; i < 300; ++i) {
        const Vec3f wl = to_float(random_direction(random, 0.05)), wv = to_float(random_direction(random, 0.05));
        const double px = double(wl.x), py = -double(wl.y), qx = -double(wv.x), qy = double(wv.y);
        EXPECT_WITHIN(value(*a, to_side(wl, -1), wv).g, f(px, py, qx, qy), 0.25);
        EXPECT_EQ(value(*a, wv, to_side(wl, -1)),
                  value(*a, to_side(wl, -1), wv));  // the reverse direction, by reciprocity
        const double s = std::hypot(px, py), rotated_x = (px * qx + py * qy) / s, rotated_y = (px * qy - py * qx) / s;
        EXPECT_WITHIN(value(*b, wl, wv).g, f(s, 0, rotated_x, rotated_y), 0.15);
        EXPECT_EQ(value(*a, wl, wv), Rgb{});
    }
}

/// Trees of u′ and v′ give the third its colour: equal energy is white, and sRGB's red stays red.
TEST(TensorTree, ColoursAreThoseOfTheirChromaticities) {
    const auto coloured = [](double u, double v) {
        return read(bsdf_xml("",
                             tree_block("Reflection Front", "{0.5}") +
                                 tree_block("Reflection Front", fmt::format("{{{}}}", u), "CIE-u") +
                                 tree_block("Reflection Front", fmt::format("{{{}}}", v), "CIE-v"),
                             "TensorTree3"));
    };
    const auto white = checked(coloured(4.0 / 19, 9.0 / 19));
    EXPECT_EQ(std::get<BsdfTable>(white->table).bands.size(), 1u);
    EXPECT_RGB_WITHIN(value(*white, {0, 0, 1}, {0, 0, 1}), grey(0.5), 1e-4);
    const Rgb red = value(*coloured(0.3, 0.5), {0, 0, 1}, {0, 0, 1});
    EXPECT_GT(red.r, 2 * red.g);
    EXPECT_WITHIN(luminance(red), 0.5, 0.01);
    EXPECT_EQ(value(*coloured(0, 0), {0, 0, 1}, {0, 0, 1}).r, value(*white, {0, 0, 1}, {0, 0, 1}).r);
}

TEST(TensorTree, RefusesBadTrees) {
    const auto error = [](const std::string& tree) {
        return error_text(read(bsdf_xml("", tree_block("Reflection Front", tree), "TensorTree3")));
    };
    EXPECT_EQ(error("{ { 1 } { 1 } { 1 } { 1 } { 1 } { 1 2 3 4 5 6 7 8 } { 1 } { 1 } }"), "");
    std::string deep;
    for (int i = 0; i < 1000; ++i) deep += "{";
    for (const auto& [tree, what] : std::initializer_list<std::array<std::string, 2>>{
             {"", "expected '{', found the end"},
             {"{", "numbers, then '}'"},
             {"{ 1 2 }", "2^3k numbers between braces, found 2"},
             {"{ 1 } 2", "the end of the tree"},
             {"{ {1} {1} {1} {1} {1} {1} {1} }", "expected '{'"},
             {"{ {1} {1} {1} {1} {1} {1} {1} {1} {1} }", "'}' after 8 trees"},
             {"{ x }", "numbers, then '}', found 'x }'"},
             {"{ 1e30 }", "numbers, then '}'"},
             {"{ nan }", "numbers, then '}'"},
             {"{}", "2^3k numbers between braces, found 0"},
             {deep, "at most 16 levels"}}) {
        EXPECT_CONTAINS(error(tree), what) << tree;
        EXPECT_LACKS(error(tree), "\n");
    }
    const std::string good = bsdf_xml("", tree_block("Reflection Front", "{ 1 }"), "TensorTree3");
    expect_truncations_refused(read, good, 3);
    EXPECT_NE(error_text(read(bsdf_xml("", tree_block("Reflection Front", "{ 1 }"), "TensorTree5"))), "");
}

/// Radiance computes .0764561 for this shade at 30°, which is the mean over the square of outgoing directions × π.
TEST(TensorTree, MeanOfAShadeAgreesWithRadiance) {
    const auto path = shared_data() / "tensor" / "t3.xml";
    if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
    const auto measured = checked(load_measured(path));
    const auto& tree = table_as<TreeTable>(*std::get<BsdfTable>(measured->table).band().part[3])->y;
    double sum = 0;
    const int n = 64;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) sum += double(tree.at({0.25 - 1e-6, (i + 0.5) / n, (j + 0.5) / n, 0})) / (n * n);
    EXPECT_WITHIN(k_pi * sum, 0.0764561, 1e-7);
}

/// A file that is written is read as the same matrices and written again as the same bytes, for each of the bases.
TEST(BsdfXml, WriteReadIdentity) {
    const auto measured = checked(read(small_shade()));
    const std::string written = write_bsdf_xml(std::get<BsdfTable>(measured->table));
    const auto again = checked(read(written));
    const auto &a = std::get<BsdfTable>(measured->table), &b = std::get<BsdfTable>(again->table);
    ASSERT_EQ(b.bands.size(), a.bands.size());
    EXPECT_EQ(b.description, a.description);
    for (std::size_t band = 0; band < a.bands.size(); ++band)
        for (std::size_t p = 0; p < k_parts; ++p) {
            const auto &part_a = *table_as<KlemsTable>(*a.bands[band].part[p]),
                       &part_b = *table_as<KlemsTable>(*b.bands[band].part[p]);
            ASSERT_EQ(part_a.cells.size(), part_b.cells.size());
            for (std::size_t k = 0; k < part_a.cells.size(); ++k)
                EXPECT_WITHIN_RELATIVE(part_b.cells[k].g, part_a.cells[k].g, 1e-5);
            EXPECT_EQ(part_a.beam.size(), part_b.beam.size());
        }
    EXPECT_EQ(write_bsdf_xml(b), written);
}

/// The matrix of a constant is constant. The matrix of a lobe around the mirror direction has the lobe's sums.
TEST(BsdfXml, MeansOverPatches) {
    SKIP_UNDER_SANITIZERS("takes too long");
    const auto f = [](double cosine) { return 0.1 + 300 * std::exp(2000 * (cosine - 1)); };  // 2.6° wide
    const Evaluate brdf = pairwise([&](Vec3f wl, Vec3f wv) { return grey(f(double(dot(mirror(wl), wv)))); });
    for (const KlemsBasis kind : {KlemsBasis::half, KlemsBasis::quarter}) {
        const AngleBasis basis = klems_basis(kind);
        const KlemsTable table = to_klems(brdf, basis, 1);
        for (std::size_t ring = 0; ring + 1 < basis.rings.size(); ++ring) {
            const std::size_t i = basis.first_of(ring);
            double sum = 0, expected = 0;
            for (std::size_t o = 0; o < basis.patches(); ++o)
                sum += double(table.cell(o, i).g) * basis.projected_solid_angle(basis.ring_of(o));
            // The integral of the lobe is 2π/2000; its cosine is that of the patch's points.
            for (int k = 0; k < 100; ++k) expected += basis.point_of(i, (k + 0.5) / 100, 0.5).z / 100;
            expected = 0.1 * k_pi + 300 * 2 * k_pi / 2000 * expected;
            EXPECT_WITHIN_RELATIVE(sum, expected, 0.01) << ring;
        }
    }
}

/// An isotropic tree of one grid, 64 leaves wide. f is a function of the distances i, j in leaves from the mirror
/// direction.
TreeTable tree_about_mirror(const std::function<double(int i, int j)>& f) {
    constexpr int n = 64;
    TreeTable tree{{3, TensorTree::grid(6, 0), {}, {}}, {}};
    for (int light_leaf = 0; light_leaf < n; ++light_leaf)
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j) {
                // p = (|p|, 0) maps to ((1 + |p|)/2, 1/2) in the square, where two leaves meet.
                const double p = std::abs(1 - 2 * (light_leaf + 0.5) / n);
                tree.y.leaves.push_back(float(f(i - int((1 + p) / 2 * n), j < n / 2 ? n / 2 - 1 - j : j - n / 2)));
            }
    return tree;
}

// The leaves in the mirror direction hold a fraction of the light, which is recovered. The level around them remains.
TEST(TensorTree, ItsBeamIsSeparated) {
    constexpr double fraction = 0.05, level = 0.01, leaf = k_pi / (64 * 64);
    const TreeTable tree =
        tree_about_mirror([](int i, int j) { return level + (i == 0 && j == 0 ? fraction / (2 * leaf) : 0); });
    const auto separated = as_evaluated_table(tree).functions->separated_beam();
    ASSERT_TRUE(separated);
    for (const double degrees : {0.0, 10.0, 25.0, 40.0, 60.0}) {
        const Vec3f wl = to_float(spherical(degrees * k_degree, 0.3)), wv = mirror(wl);
        EXPECT_WITHIN_RELATIVE(fraction_at(separated->beam, wl).g, fraction, 0.05) << degrees;
        Rgb remaining;
        separated->rest(std::span(&wl, 1), std::span(&wv, 1), std::span(&remaining, 1));
        EXPECT_WITHIN(remaining.g, level, 1e-6) << degrees;
    }
    // A lobe several leaves wide is not a beam, nor is a constant level.
    EXPECT_FALSE(as_evaluated_table(tree_about_mirror([](int i, int j) {
                     return level + std::exp(-(i * i + j * j) / 50.);
                 })).functions->separated_beam());
    EXPECT_FALSE(as_evaluated_table(tree_about_mirror([](int, int) { return level; })).functions->separated_beam());
}

}  // namespace
}  // namespace srbf::tensor_tree_test
