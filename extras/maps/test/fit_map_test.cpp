// Maps of texels that share their lobes: their file, and their fits.
#include "srbf/fit_map.h"

#include "base/half.h"
#include "brdf/directions.h"
#include "models/model_files.h"
#include "properties.h"
#include "srbf/convert.h"
#include "srbf/file.h"
#include "srbf/load.h"
#include "srbf/map.h"
#include "srbf/sampling.h"

namespace srbf::fit_map_test {
namespace {

/// Three axial lobes: diffuse, a broad and a narrow highlight.
PmModel lobes_of_three() {
    PmModel model;
    model.form = PmForm::horizon;
    model.lobes = 3;
    model.variates = 1;
    model.coefficient.assign(3, {1, 1, 1}), model.log_scale.assign(3, 0), model.exponent.assign(3, 0);
    model.centre.assign(3, {0, 0, 1}), model.bandwidth = {0, 10, 200}, model.parameterization = {{1, 1}};
    return model;
}

/// A map of two texels.
TexelMap some_map() {
    TexelMap map;
    map.basis = lobes_of_three();
    map.width = 1;
    for (int i = 0; i < 6; ++i) map.coefficient.push_back({0.25f * float(i + 1), 0.5f, 0.125f});
    map.error = {1.5f, 0.5f};
    map.provenance["generator"] = "a test";
    return map;
}

std::pair<std::vector<Vec3f>, std::vector<Vec3f>> some_pairs(std::size_t count) {
    std::mt19937_64 random(1);
    std::vector<Vec3f> wl, wv;
    const auto direction = [&] {
        const double z = 0.2 + 0.8 * double(random() >> 11) * 0x1p-53, phi = 6.283 * double(random() >> 11) * 0x1p-53;
        const double s = std::sqrt(1 - z * z);
        return Vec3f{float(s * std::cos(phi)), float(s * std::sin(phi)), float(z)};
    };
    for (std::size_t i = 0; i < count; ++i) {
        wl.push_back(direction());
        const Vec3f other = direction();
        wv.push_back(i % 2 ? other : Vec3f{-wl.back().x, -wl.back().y, wl.back().z});
    }
    return {wl, wv};
}

TEST(FitMap, WrittenMapsAreReadBack) {
    const TexelMap map = some_map();
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
    const TexelMap map = some_map();
    EXPECT_EQ(find_texel(map, "1"), 1u);
    EXPECT_EQ(find_texel(map, "0,1"), 1u);
    for (const char* name : {"2", "1,0", "0,2", "paint", "", "0,", ",1"})
        EXPECT_EQ(find_texel(map, name), std::nullopt);
}

/// f of the mean of coefficients is the mean of f, as a mip level needs.
TEST(FitMap, MeanOfCoefficientsIsMeanOfBrdfs) {
    TexelMap map = some_map();
    for (std::size_t k = 0; k < 3; ++k) {
        const Rgb a = map.coefficient[k], b = map.coefficient[3 + k];
        map.coefficient.push_back({(a.r + b.r) / 2, (a.g + b.g) / 2, (a.b + b.b) / 2});
    }
    map.error.push_back(0);
    const Model models[] = {texel(map, 0), texel(map, 1), texel(map, 2)};
    const auto [wl, wv] = some_pairs(200);
    for (std::size_t i = 0; i < wl.size(); ++i)
        for (int c = 0; c < 3; ++c) {
            const float mean = (value(models[0], wl[i], wv[i])[c] + value(models[1], wl[i], wv[i])[c]) / 2;
            EXPECT_WITHIN(value(models[2], wl[i], wv[i])[c], mean, 1e-6f * (1 + mean));
        }
}

/// Texels made of the lobes have their coefficients again, also where some values are missing.
TEST(FitMap, CoefficientsOfTexelsAreRecovered) {
    const TexelMap map = some_map();
    const auto [wl, wv] = some_pairs(128);
    std::vector<Rgb> f(3 * wl.size());
    for (std::size_t t = 0; t < 2; ++t) evaluate(texel(map, t), wl, wv, std::span(f).subspan(t * wl.size(), wl.size()));
    f[5].g = std::numeric_limits<float>::quiet_NaN();  // the last texel is black
    const TexelCoefficients found = coefficients_of_texels(map, {wl, wv, true}, f, 2);
    ASSERT_EQ(found.coefficient.size(), 9u);
    for (std::size_t i = 0; i < 6; ++i) EXPECT_RGB_WITHIN(found.coefficient[i], map.coefficient[i], 1e-3);
    for (std::size_t i = 6; i < 9; ++i) EXPECT_EQ(found.coefficient[i].r, 0);
    EXPECT_LT(found.error[0], 1e-3f);
}

/// A lobe that explains the samples, but would rise by orders of magnitude beyond them, is held down.
TEST(FitMap, CoefficientsOfTexelsAreBoundedTowardsTheHorizon) {
    TexelMap map = some_map();
    map.basis.exponent = {0, -4, 0};  // (cosθl cosθv)⁻⁴
    map.basis.bandwidth[1] = 0;
    const auto directions = [](double min_theta, double max_theta) {
        std::pair<std::vector<Vec3f>, std::vector<Vec3f>> pairs;
        for (int i = 0; i < 100; ++i) {
            const double l = min_theta + (max_theta - min_theta) * double(i % 10) / 9,
                         v = min_theta + (max_theta - min_theta) * double(i / 10) / 9;
            pairs.first.push_back(to_float(spherical(l * k_degree, 0.1 * i)));
            pairs.second.push_back(to_float(spherical(v * k_degree, 0.0)));
        }
        return pairs;
    };
    const auto [wl, wv] = directions(0, 60);
    std::vector<Rgb> f(wl.size());
    double largest = 0;
    for (std::size_t i = 0; i < f.size(); ++i) {
        const double area = double(wl[i].z) * double(wv[i].z), value = 0.1 + 0.01 * std::pow(area, -4);
        f[i] = {float(value), float(value), float(value)};
        largest = std::max(largest, value * area);
    }
    const TexelCoefficients found = coefficients_of_texels(map, {wl, wv, true}, f, 1);
    map.coefficient = found.coefficient;
    map.error = found.error;
    const auto [beyond_l, beyond_v] = directions(61, 89.9);
    std::vector<Rgb> g(beyond_l.size());
    evaluate(texel(map, 0), beyond_l, beyond_v, g);
    for (std::size_t i = 0; i < g.size(); ++i) EXPECT_LE(g[i].r * beyond_l[i].z * beyond_v[i].z, 2 * largest) << i;
    EXPECT_GT(found.coefficient[0].r, 0.05f);
}

/// Texels of one value each, with noise of 2 %: shared lobes invent nothing between the samples, and the stored
/// coefficients have the error that is reported.
TEST(FitMap, MatteTexelsHaveNoHighlights) {
    std::mt19937_64 random(7);
    std::vector<Vec3f> wl, wv;
    for (int i = 0; i < 200; ++i) {
        wl.push_back(to_float(random_direction(random, 0.2)));
        wv.push_back(to_float(random_direction(random, 0.2)));
    }
    const auto drawn = [&](double from, double to) { return float(from + (to - from) * uniform(random)); };
    std::vector<Rgb> colours, f;
    for (int t = 0; t < 4; ++t) {
        colours.push_back({drawn(0.02, 0.2), drawn(0.02, 0.2), drawn(0.02, 0.2)});
        for (std::size_t i = 0; i < wl.size(); ++i) {
            Rgb& colour = f.emplace_back();
            for (int c = 0; c < 3; ++c) colour[c] = colours.back()[c] * drawn(0.965, 1.035);
        }
    }
    const SharedPairs pairs{wl, wv, true};
    MapOptions options;
    options.lobes = 8;
    options.threads = 1;
    auto map = checked(fit_map(pairs, f, options));
    const TexelCoefficients found = coefficients_of_texels(*map, pairs, f, 1);
    map->coefficient = found.coefficient;
    map->error = found.error;
    for (const Rgb& colour : found.coefficient)
        for (int c = 0; c < 3; ++c) EXPECT_EQ(colour[c], round_to_half(colour[c]));
    std::vector<Vec3f> l, v;
    for (double theta = 0; theta < 78; theta += 2)
        for (const double phi : {0.0, 0.3, 1.0, 2.0, 3.0, k_pi})
            l.push_back(to_float(spherical(theta * k_degree, 0.0))),
                v.push_back(to_float(spherical(theta * k_degree, phi)));
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
    const TexelMap map = some_map();
    const auto [wl, wv] = some_pairs(128);
    std::vector<Rgb> f(wl.size());
    evaluate(texel(map, 0), wl, wv, f);
    for (Rgb& colour : f) colour = {colour.r, colour.g, 1e6f * colour.b};
    const TexelCoefficients found = coefficients_of_texels(map, {wl, wv, true}, f, 1);
    for (const Rgb& colour : found.coefficient) EXPECT_LE(std::max({colour.r, colour.g, colour.b}), k_half_max);
    EXPECT_GT(found.error[0], 0.3f);
}

/// Materials that are sums of the same three lobes are fitted by four, and do not depend on the number of threads.
TEST(FitMap, SharedLobesAreFound) {
    const TexelMap made = some_map();
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
    const TexelMap map = some_map();
    const float fractions[] = {1, 0, 0.25f, 0.75f};
    const TexelCoefficients painted = painted_texels(map, fractions);
    EXPECT_EQ(painted.error, (std::vector<float>{1.5f, 0.75f}));
    for (std::size_t j = 0; j < 3; ++j) {
        EXPECT_EQ(painted.coefficient[j], map.coefficient[j]);
        for (int c = 0; c < 3; ++c)
            EXPECT_WITHIN(painted.coefficient[3 + j][c],
                          0.25f * map.coefficient[j][c] + 0.75f * map.coefficient[3 + j][c], 1e-3f);
    }
}

}  // namespace
}  // namespace srbf::fit_map_test
