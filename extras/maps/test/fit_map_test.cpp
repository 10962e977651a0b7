// Maps of texels that share their lobes: their file, and their fits.
#include "srbf/fit_map.h"

#include "base/half.h"
#include "brdf_functions.h"
#include "extras/maps/test/texel_values.h"
#include "models/model_files.h"
#include "properties.h"
#include "srbf/convert.h"
#include "srbf/file.h"
#include "srbf/load.h"
#include "srbf/map.h"
#include "srbf/sampling.h"

namespace srbf::fit_map_test {
namespace {

TexelMap map_of_two() {
    TexelMap map;
    map.basis = three_lobes();
    map.width = 1;
    for (int i = 0; i < 6; ++i) map.coefficient.push_back({0.25f * float(i + 1), 0.5f, 0.125f});
    map.error = {1.5f, 0.5f};
    map.provenance["generator"] = "a test";
    return map;
}

/// Pairs above the horizon, half of them in the mirror direction.
SharedPairs pairs_above(std::size_t count) {
    std::mt19937_64 random(1);
    SharedPairs pairs;
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3d wl = random_direction(random, 0.2), other = random_direction(random, 0.2);
        pairs.wl.push_back(to_float(wl));
        pairs.wv.push_back(to_float(i % 2 ? other : mirror(wl)));
    }
    return pairs;
}

TEST(FitMap, WrittenMapsAreReadBack) {
    const TexelMap map = map_of_two();
    const auto bytes = write_map(map);
    EXPECT_TRUE(is_map_file(bytes));
    const auto read = checked(read_map(bytes, "a"));
    EXPECT_TRUE(*read == map);
    EXPECT_FALSE(read_model(bytes, "a"));
    for (std::size_t size = 0; size < bytes.size(); ++size)
        EXPECT_FALSE(read_map(std::span(bytes).first(size), "a")) << size;
    TexelMap wrong = map;
    wrong.width = 3;
    EXPECT_FALSE(read_map(write_map(wrong), "a"));
}

/// Libraries of version 0.1: a dense one is a row of its materials.
TEST(FitMap, FilesOfLibrariesAreReadOrRefusedInOneLine) {
    const std::filesystem::path corpus = std::filesystem::path(SRBF_SOURCE_DIR) / "fuzz/corpus/map";
    const auto two = checked(read_map(*read_file((corpus / "two").string()), "two"));
    EXPECT_EQ(two->width, two->count());
    const auto sparse = read_map(*read_file((corpus / "sparse").string()), "sparse");
    ASSERT_FALSE(sparse);
    EXPECT_CONTAINS(message(sparse.error()), "a library of version 0.1");
}

TEST(FitMap, TexelsAreFoundByIndexAndPlace) {
    const TexelMap map = map_of_two();
    EXPECT_EQ(find_texel(map, "1"), 1u);
    EXPECT_EQ(find_texel(map, "0,1"), 1u);
    for (const char* name : {"2", "1,0", "0,2", "paint", "", "0,", ",1"})
        EXPECT_EQ(find_texel(map, name), std::nullopt);
}

/// f of the mean of coefficients is the mean of f, as a mip level needs.
TEST(FitMap, MeanOfCoefficientsIsMeanOfBrdfs) {
    TexelMap map = map_of_two();
    for (std::size_t k = 0; k < 3; ++k)
        map.coefficient.push_back(mixed(map.coefficient[k], map.coefficient[3 + k], 0.5f));
    map.error.push_back(0);
    const Model models[] = {texel(map, 0), texel(map, 1), texel(map, 2)};
    const auto [wl, wv, is_isotropic] = pairs_above(200);
    for (std::size_t i = 0; i < wl.size(); ++i) {
        const Rgb mean = mixed(value(models[0], wl[i], wv[i]), value(models[1], wl[i], wv[i]), 0.5f);
        EXPECT_RGB_WITHIN_RELATIVE(value(models[2], wl[i], wv[i]), mean, 1e-6, 1e-6);
    }
}

/// Texels made of the lobes have their coefficients again, also where some values are missing.
TEST(FitMap, CoefficientsOfTexelsAreRecovered) {
    const TexelMap map = map_of_two();
    const SharedPairs pairs = pairs_above(128);
    const std::size_t count = pairs.wl.size();
    std::vector<Rgb> f(3 * count);
    for (std::size_t t = 0; t < 2; ++t)
        evaluate(texel(map, t), pairs.wl, pairs.wv, std::span(f).subspan(t * count, count));
    f[5].g = std::numeric_limits<float>::quiet_NaN();  // the last texel is black
    const TexelCoefficients found = coefficients_of_texels(map, pairs, f, 2);
    ASSERT_EQ(found.coefficient.size(), 9u);
    for (std::size_t i = 0; i < 6; ++i) EXPECT_RGB_WITHIN(found.coefficient[i], map.coefficient[i], 1e-3);
    for (std::size_t i = 6; i < 9; ++i) EXPECT_EQ(found.coefficient[i].r, 0);
    EXPECT_LT(found.error[0], 1e-3f);
}

/// A lobe that explains the samples, but would rise by orders of magnitude beyond them, is held down.
TEST(FitMap, CoefficientsOfTexelsAreBoundedTowardsTheHorizon) {
    TexelMap map = map_of_two();
    map.basis.exponent = {0, -4, 0};  // (cosθl cosθv)⁻⁴
    map.basis.bandwidth[1] = 0;
    const auto pairs_between = [](double min_theta, double max_theta) {
        SharedPairs pairs;
        const auto theta = [&](int step) { return (min_theta + (max_theta - min_theta) * step / 9.0) * k_degree; };
        for (int i = 0; i < 100; ++i) {
            pairs.wl.push_back(to_float(spherical(theta(i % 10), 0.1 * i)));
            pairs.wv.push_back(to_float(spherical(theta(i / 10), 0.0)));
        }
        return pairs;
    };
    const SharedPairs measured = pairs_between(0, 60), beyond = pairs_between(61, 89.9);
    std::vector<Rgb> f, g(beyond.wl.size());
    double largest = 0;  // f cosθl cosθv
    for (std::size_t i = 0; i < measured.wl.size(); ++i) {
        const double area = cosines(measured.wl[i], measured.wv[i]), value = 0.1 + 0.01 * std::pow(area, -4);
        f.push_back(grey(value));
        largest = std::max(largest, value * area);
    }
    const TexelCoefficients found = coefficients_of_texels(map, measured, f, 1);
    map.coefficient = found.coefficient;
    map.error = found.error;
    evaluate(texel(map, 0), beyond.wl, beyond.wv, g);
    for (std::size_t i = 0; i < g.size(); ++i)
        EXPECT_LE(double(g[i].r) * cosines(beyond.wl[i], beyond.wv[i]), 2 * largest) << i;
    EXPECT_GT(found.coefficient[0].r, 0.05f);
}

/// Texels of one value each, with noise of 2 %: shared lobes invent nothing between the samples, and the stored
/// coefficients have the error that is reported.
TEST(FitMap, MatteTexelsHaveNoHighlights) {
    std::mt19937_64 random(7);
    SharedPairs pairs;
    for (int i = 0; i < 200; ++i) {
        pairs.wl.push_back(to_float(random_direction(random, 0.2)));
        pairs.wv.push_back(to_float(random_direction(random, 0.2)));
    }
    const auto drawn = [&](double from, double to) { return float(from + (to - from) * uniform(random)); };
    std::vector<Rgb> colours, f;
    for (int t = 0; t < 4; ++t) {
        colours.push_back({drawn(0.02, 0.2), drawn(0.02, 0.2), drawn(0.02, 0.2)});
        for (std::size_t i = 0; i < pairs.wl.size(); ++i) {
            Rgb& colour = f.emplace_back();
            for (int c = 0; c < 3; ++c) colour[c] = colours.back()[c] * drawn(0.965, 1.035);
        }
    }
    auto map = checked(fit_map(pairs, f, {.lobes = 8, .threads = 1}));
    const TexelCoefficients found = coefficients_of_texels(*map, pairs, f, 1);
    map->coefficient = found.coefficient;
    map->error = found.error;
    for (const Rgb& colour : found.coefficient)
        for (int c = 0; c < 3; ++c) EXPECT_EQ(colour[c], round_to_half(colour[c]));
    std::vector<Vec3f> l, v;
    for (double theta = 0; theta < 78; theta += 2)
        for (const double phi : {0.0, 0.3, 1.0, 2.0, 3.0, k_pi}) {
            l.push_back(to_float(spherical(theta * k_degree, 0.0)));
            v.push_back(to_float(spherical(theta * k_degree, phi)));
        }
    for (std::size_t t = 0; t < colours.size(); ++t) {
        EXPECT_LT(found.error[t], 0.025f);
        std::vector<Rgb> g(l.size());
        evaluate(texel(*map, t), l, v, g);
        for (std::size_t i = 0; i < g.size(); ++i)
            EXPECT_RGB_WITHIN_RELATIVE(g[i], colours[t], 0.15, 0) << t << ' ' << i;
    }
}

/// Coefficients beyond the largest 16-bit float are not cut off: the solver bounds them, and the error includes this.
TEST(FitMap, TexelsTooBrightForTheScaleHaveTheirErrors) {
    const TexelMap map = map_of_two();
    const SharedPairs pairs = pairs_above(128);
    std::vector<Rgb> f(pairs.wl.size());
    evaluate(texel(map, 0), pairs.wl, pairs.wv, f);
    for (Rgb& colour : f) colour.b *= 1e6f;
    const TexelCoefficients found = coefficients_of_texels(map, pairs, f, 1);
    for (const Rgb& colour : found.coefficient) EXPECT_LE(largest_of(colour), k_half_max);
    EXPECT_GT(found.error[0], 0.3f);
}

/// Materials that are sums of the same three lobes are fitted by four, and do not depend on the number of threads.
TEST(FitMap, SharedLobesAreFound) {
    const TexelMap made = map_of_two();
    std::vector<Measured> materials;
    for (const std::size_t t : {0, 1}) {
        const Model model = texel(made, t);
        materials.push_back({{}, {}, 0, to_merl(evaluator(model), {45, 45, 36}, 1)});
    }
    MapOptions options;
    options.form = PmForm::horizon;
    options.lobes = 4;
    options.variates = 2;
    options.threads = 1;
    const auto one = checked(fit_map(materials, options));
    options.threads = 2;
    const auto two = checked(fit_map(materials, options));
    EXPECT_TRUE(*one == *two);
    for (const float error : one->error) EXPECT_LT(error, 2.f);  // mean ΔE_ITP
    EXPECT_EQ(fit_map(std::span<const Measured>(), options).error().code, ErrorCode::argument);
}

/// A texel of one material is this material, and one of several their mean.
TEST(FitMap, PaintedTexelsAreMeansOfMaterials) {
    const TexelMap map = map_of_two();
    const float fractions[] = {1, 0, 0.25f, 0.75f};
    const TexelCoefficients painted = painted_texels(map, fractions);
    EXPECT_EQ(painted.error, (std::vector<float>{1.5f, 0.75f}));
    for (std::size_t j = 0; j < 3; ++j) {
        EXPECT_EQ(painted.coefficient[j], map.coefficient[j]);
        EXPECT_RGB_WITHIN(painted.coefficient[3 + j], mixed(map.coefficient[j], map.coefficient[3 + j], 0.75f), 1e-3f);
    }
}

}  // namespace
}  // namespace srbf::fit_map_test
