// Libraries: materials of lobes that they share, their file, and texels.
#include "srbf/basis.h"

#include <gtest/gtest.h>

#include <random>

#include "base/half.h"
#include "brdf/directions.h"
#include "models/library_file.h"
#include "properties.h"
#include "srbf/convert.h"
#include "srbf/library.h"
#include "srbf/load.h"
#include "srbf/sampling.h"

namespace srbf::basis_test {
namespace {

/// Three axial lobes: diffuse, a broad and a narrow highlight.
PmModel lobes_of_three() {
    PmModel model;
    model.form = PmForm::horizon, model.lobes = 3, model.variates = 1;
    model.coefficient.assign(3, {1, 1, 1}), model.log_scale.assign(3, 0), model.exponent.assign(3, 0);
    model.centre.assign(3, {0, 0, 1}), model.bandwidth = {0, 10, 200}, model.parameterization = {{1, 1}};
    return model;
}

Library some_library(bool sparse) {
    Library library;
    library.basis = lobes_of_three();
    library.stored = sparse ? 2 : 3;
    if (sparse) library.index = {0, 2, 1, 2};
    for (int i = 0; i < 2 * library.stored; ++i) library.coefficient.push_back({0.25f * float(i + 1), 0.5f, 0.125f});
    library.names = {"paper", "paint"};
    library.error = {1.5f, 0.5f};
    library.provenance["generator"] = "a test";
    return library;
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

TEST(Basis, WhatIsWrittenIsRead) {
    for (const bool sparse : {false, true}) {
        const Library library = some_library(sparse);
        const auto bytes = write_library(library);
        EXPECT_TRUE(is_library(bytes));
        const auto read = read_library(bytes, "a");
        ASSERT_TRUE(read) << message(read.error());
        EXPECT_TRUE(*read == library);
        EXPECT_FALSE(read_model(bytes, "a"));
        for (std::size_t size = 0; size < bytes.size(); ++size)
            EXPECT_FALSE(read_library(std::span(bytes).first(size), "a")) << size;
    }
}

TEST(Basis, WrongIndicesAndNamesAreErrors) {
    Library library = some_library(true);
    library.index[1] = 3;
    EXPECT_FALSE(read_library(write_library(library), "a"));
    library = some_library(true);
    library.names.pop_back();
    EXPECT_FALSE(read_library(write_library(library), "a"));
    library = some_library(false);
    library.width = 3;
    EXPECT_FALSE(read_library(write_library(library), "a"));
}

TEST(Basis, MaterialsAreFoundByNameIndexAndPlace) {
    Library library = some_library(true);
    EXPECT_EQ(find_material(library, "paint"), 1u);
    EXPECT_EQ(find_material(library, "0"), 0u);
    EXPECT_EQ(find_material(library, "2"), std::nullopt);
    EXPECT_EQ(find_material(library, "0,1"), std::nullopt);
    library.width = 1;
    EXPECT_EQ(find_material(library, "0,1"), 1u);
    EXPECT_EQ(find_material(library, "1,0"), std::nullopt);
    const Model model = material(library, 1);
    EXPECT_EQ(std::get<PmModel>(model.model).bandwidth, (std::vector<float>{10, 200}));
}

/// A dense library is linear: f of the mean of coefficients is the mean of f, as a mip level needs.
TEST(Basis, MeanOfCoefficientsIsMeanOfBrdfs) {
    Library library = some_library(false);
    for (std::size_t k = 0; k < 3; ++k) {
        const Rgb a = library.coefficient[k], b = library.coefficient[3 + k];
        library.coefficient.push_back({(a.r + b.r) / 2, (a.g + b.g) / 2, (a.b + b.b) / 2});
    }
    library.names.push_back("mean"), library.error.push_back(0);
    const Model models[] = {material(library, 0), material(library, 1), material(library, 2)};
    const auto [wl, wv] = some_pairs(200);
    for (std::size_t i = 0; i < wl.size(); ++i)
        for (int c = 0; c < 3; ++c) {
            const float mean = (value(models[0], wl[i], wv[i])[c] + value(models[1], wl[i], wv[i])[c]) / 2;
            EXPECT_NEAR(value(models[2], wl[i], wv[i])[c], mean, 1e-6f * (1 + mean));
        }
}

/// Texels made of the lobes have their coefficients again, also where some values are missing.
TEST(Basis, CoefficientsOfTexelsAreRecovered) {
    const Library library = some_library(false);
    const auto [wl, wv] = some_pairs(128);
    std::vector<Rgb> f(3 * wl.size());
    for (std::size_t t = 0; t < 2; ++t)
        evaluate(material(library, t), wl, wv, std::span(f).subspan(t * wl.size(), wl.size()));
    f[5].g = std::numeric_limits<float>::quiet_NaN();  // the last texel is black
    const TexelCoefficients found = fit_texels_to_basis(library, {wl, wv, true}, f, 2);
    ASSERT_EQ(found.coefficient.size(), 9u);
    for (std::size_t i = 0; i < 6; ++i)
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(found.coefficient[i][c], library.coefficient[i][c], 1e-3);
    for (std::size_t i = 6; i < 9; ++i) EXPECT_EQ(found.coefficient[i].r, 0);
    EXPECT_LT(found.error[0], 1e-3f);
}

/// A lobe that explains the samples, but would rise by orders of magnitude beyond them, is held down.
TEST(Basis, CoefficientsOfTexelsAreBoundedTowardsTheHorizon) {
    Library library = some_library(false);
    library.basis.exponent = {0, -4, 0};  // (cosθl cosθv)⁻⁴
    library.basis.bandwidth[1] = 0;
    const auto directions = [](double least_theta, double most_theta) {
        std::pair<std::vector<Vec3f>, std::vector<Vec3f>> pairs;
        for (int i = 0; i < 100; ++i) {
            const double l = least_theta + (most_theta - least_theta) * double(i % 10) / 9,
                         v = least_theta + (most_theta - least_theta) * double(i / 10) / 9;
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
    const TexelCoefficients found = fit_texels_to_basis(library, {wl, wv, true}, f, 1);
    library.coefficient = found.coefficient, library.error = found.error, library.names = {"a"};
    const auto [beyond_l, beyond_v] = directions(61, 89.9);
    std::vector<Rgb> g(beyond_l.size());
    evaluate(material(library, 0), beyond_l, beyond_v, g);
    for (std::size_t i = 0; i < g.size(); ++i) EXPECT_LE(g[i].r * beyond_l[i].z * beyond_v[i].z, 2 * largest) << i;
    EXPECT_GT(found.coefficient[0].r, 0.05f);
}

/// Texels of one value each, with noise of 2 %: shared lobes invent nothing between the samples, and the stored
/// coefficients have the error that is told.
TEST(Basis, MatteTexelsHaveNoHighlights) {
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
            Rgb& of = f.emplace_back();
            for (int c = 0; c < 3; ++c) of[c] = colours.back()[c] * drawn(0.965, 1.035);
        }
    }
    const SharedPairs pairs{wl, wv, true};
    BasisOptions options;
    options.lobes = 8, options.threads = 1;
    auto library = fit_texel_basis(pairs, f, options);
    ASSERT_TRUE(library) << message(library.error());
    const TexelCoefficients found = fit_texels_to_basis(*library, pairs, f, 1);
    library->coefficient = found.coefficient, library->error = found.error;
    for (const Rgb& of : found.coefficient)
        for (int c = 0; c < 3; ++c) EXPECT_EQ(of[c], round_to_half(of[c]));
    std::vector<Vec3f> l, v;
    for (double theta = 0; theta < 78; theta += 2)
        for (const double phi : {0.0, 0.3, 1.0, 2.0, 3.0, k_pi})
            l.push_back(to_float(spherical(theta * k_degree, 0.0))),
                v.push_back(to_float(spherical(theta * k_degree, phi)));
    for (std::size_t t = 0; t < colours.size(); ++t) {
        EXPECT_LT(found.error[t], 0.025f);
        std::vector<Rgb> g(l.size());
        evaluate(material(*library, t), l, v, g);
        for (std::size_t i = 0; i < g.size(); ++i)
            for (int c = 0; c < 3; ++c) EXPECT_PRED3(near_relative, g[i][c], colours[t][c], 0.1) << t << ' ' << i;
    }
}

/// Coefficients beyond the largest 16-bit float are not cut off: the solution knows of it, and its error is told.
TEST(Basis, TexelsTooBrightForTheScaleHaveTheirErrors) {
    const Library library = some_library(false);
    const auto [wl, wv] = some_pairs(128);
    std::vector<Rgb> f(wl.size());
    evaluate(material(library, 0), wl, wv, f);
    for (Rgb& of : f) of = {of.r, of.g, 1e6f * of.b};
    const TexelCoefficients found = fit_texels_to_basis(library, {wl, wv, true}, f, 1);
    for (const Rgb& of : found.coefficient) EXPECT_LE(std::max({of.r, of.g, of.b}), k_half_max);
    EXPECT_GT(found.error[0], 0.3f);
}

/// Tables of the two materials.
std::vector<LibrarySource> sources_of(const Library& made) {
    std::vector<LibrarySource> sources;
    for (std::size_t t = 0; t < 2; ++t)
        sources.push_back({made.names[t], [&made, t]() -> Result<Measured> {
                               const Model model = material(made, t);
                               return Measured{{}, {}, 0, to_merl(evaluator(model), {45, 45, 36}, 1)};
                           }});
    return sources;
}

/// Materials of two of three lobes are sums of just these.
TEST(Basis, ActiveLobesAreFound) {
    const Library made = some_library(true);
    const auto found = fit_to_basis(made, sources_of(made), {.active = 2, .threads = 1});
    ASSERT_TRUE(found) << message(found.error());
    EXPECT_EQ(found->index, made.index);
    for (std::size_t i = 0; i < made.coefficient.size(); ++i)
        for (int c = 0; c < 3; ++c)
            EXPECT_PRED3(near_relative, found->coefficient[i][c], made.coefficient[i][c], 0.1) << i;
}

/// Materials that are sums of the same three lobes are fitted by as many, and do not depend on the number of threads.
TEST(Basis, SharedLobesAreFound) {
    const Library made = some_library(false);
    std::vector<LibrarySource> sources = sources_of(made);
    BasisOptions options;
    options.form = PmForm::horizon, options.lobes = 4, options.variates = 2, options.active = 3, options.threads = 1;
    const auto one = fit_library(sources, options);
    ASSERT_TRUE(one) << message(one.error());
    options.threads = 2;
    const auto two = fit_library(sources, options);
    ASSERT_TRUE(two);
    EXPECT_TRUE(*one == *two);
    for (const float error : one->error) EXPECT_LT(error, 2.f);  // mean ΔE_ITP
    const auto again = fit_to_basis(*one, std::span(sources).first(1), options);
    ASSERT_TRUE(again);
    EXPECT_EQ(material_bytes(*again), 3u * 8);
    EXPECT_NEAR(again->error[0], one->error[0], 0.05);
    sources[1].name = sources[0].name;
    EXPECT_FALSE(fit_library(sources, options));
}

}  // namespace
}  // namespace srbf::basis_test
