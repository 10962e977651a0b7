// The view-by-view model: values at sampled views and between them, index textures, file.
#include "srbf/models/su.h"

#include <gtest/gtest.h>

#include "base/half.h"
#include "models/su/su_functions.h"
#include "srbf/kernel.h"
#include "srbf/model.h"
#include "su_models.h"

namespace srbf::su_test {
namespace {

/// The function of a sampled view by the formula of the docstring, in double.
std::array<double, 3> view_function(const SuModel& model, std::size_t view, Vec3f wl) {
    std::array<double, 3> f{};
    for (std::size_t j = view * std::size_t(model.lobes); j < (view + 1) * std::size_t(model.lobes); ++j) {
        const Vec3d d = to_double(wl) - to_double(model.centre[j]);
        for (int c = 0; c < 3; ++c)
            f[std::size_t(c)] +=
                double(model.coefficient[j][c]) * std::exp(-0.5 * double(model.bandwidth[j]) * dot(d, d));
    }
    return f;
}

double difference(const Rgb& a, const Rgb& b) {
    return std::max({std::abs(double(a.r) - double(b.r)), std::abs(double(a.g) - double(b.g)),
                     std::abs(double(a.b) - double(b.b))});
}

constexpr SuInterpolation k_interpolations[] = {SuInterpolation::rotated, SuInterpolation::plain};

TEST(Su, SampledViewsHaveTheirOwnFunction) {
    std::mt19937_64 random(1);
    for (const auto interpolation : k_interpolations)
        for (const auto discretise : {Discretise::view, Discretise::light}) {
            SuModel model = random_su(random, 300, 4);
            model.interpolation = interpolation;
            model.discretise = discretise;
            for (std::size_t i = 0; i < model.direction.size(); ++i) {
                const Vec3f w = to_float(random_direction(random, 0)), sample = model.direction[i];
                const Rgb f = discretise == Discretise::view ? value(model, w, sample) : value(model, sample, w);
                const auto expected = view_function(model, i, w);
                EXPECT_RGB_WITHIN(f, expected, 2e-5) << i << name(interpolation);
            }
        }
}

TEST(Su, LobesIntegrateToTheirClosedForm) {
    std::mt19937_64 random(3);
    const SuModel model = random_su(random, 8, 5);
    constexpr int count = 200000;
    for (std::size_t view = 0; view < 8; ++view) {
        std::array<double, 3> sum{}, closed{};
        for (int i = 0; i < count; ++i) {
            const auto f = view_function(model, view, to_float(fibonacci_direction(i, count, k_pi)));
            for (std::size_t c = 0; c < 3; ++c) sum[c] += 4 * k_pi / count * f[c];
        }
        for (std::size_t j = view * 5; j < view * 5 + 5; ++j)
            for (int c = 0; c < 3; ++c)
                closed[std::size_t(c)] +=
                    double(model.coefficient[j][c]) * Kernel<double>::gaussian_integral(double(model.bandwidth[j]));
        EXPECT_RGB_WITHIN_RELATIVE(sum, closed, 1e-4, 0);
    }
    // The model's own values are those: `SampledViewsHaveTheirOwnFunction`.
}

/// The largest change of the value over steps of 1e-4 on great circles, relative to the largest value.
double largest_jump(const SuModel& model, bool through_the_pole) {
    std::mt19937_64 random(4);
    double largest_change = 0, largest = 0;
    for (int circle = 0; circle < 6; ++circle) {
        const Vec3d wl = random_direction(random, 0.2),
                    a = through_the_pole ? Vec3d{0, 0, 1} : random_direction(random, 0);
        Vec3d b = random_direction(random, 0);
        b = normalize(b - dot(a, b) * a);
        Rgb previous{-1, -1, -1};
        for (int step = 0; step < 31416; ++step) {  // from horizon to horizon
            const double t = 1e-4 * step - k_pi / 2;
            const Vec3d wv = std::cos(t) * a + std::sin(t) * b;
            if (wv.z <= 1e-3) {
                previous = {-1, -1, -1};
                continue;
            }
            const Rgb f = value(model, to_float(wl), to_float(wv));
            if (previous.r >= 0) largest_change = std::max(largest_change, difference(f, previous));
            largest = std::max(largest, double(f.g));
            previous = f;
        }
    }
    return largest_change / largest;
}

TEST(Su, IsContinuousInTheSampledDirection) {
    // The weight of a sampled view changes over a few hundredths of a radian, so a step of 1e-4 changes the value
    // little.
    std::mt19937_64 random(5);
    SuModel model = random_su(random, 1536, 3);
    for (Vec3f& xi : model.centre) xi = normalize(xi + Vec3f(0, 0, 3));
    for (float& lambda : model.bandwidth) lambda = std::min(lambda, 3.f);
    model.interpolation = SuInterpolation::plain;
    EXPECT_LE(largest_jump(model, false), 0.03);  // largest where four views are equally close
    model.neighbours = 4;
    EXPECT_LE(largest_jump(model, false), 0.003);
    // Views adjacent in elevation are independent here and differ by 1/1536 in z: a step covers a sixth of that.
    model.interpolation = SuInterpolation::rotated;
    EXPECT_LE(largest_jump(model, false), 0.16);
    const SuModel isotropic = isotropic_su(1536);
    EXPECT_LE(largest_jump(isotropic, false), 0.001);
    EXPECT_LE(largest_jump(isotropic, true), 0.001);  // above the last sample, across the pole
}

TEST(Su, RotatedInterpolationOfAnIsotropicModelIsIsotropic) {
    std::mt19937_64 random(6);
    const SuModel model = isotropic_su(1536);
    for (int i = 0; i < 2000; ++i) {
        const Vec3d wl = random_direction(random, 0.05), wv = random_direction(random, 0.05);
        if (wv.z > 1 - 2.0 / 1536) continue;  // above the last sample
        const double angle = 7 * uniform(random);
        const Rgb a = value(model, to_float(wl), to_float(wv));
        const Rgb b = value(model, to_float(rotate(wl, angle)), to_float(rotate(wv, angle)));
        EXPECT_LE(difference(a, b), 3e-4) << wv.z;
        // The model has a lobe around the mirror direction and one around the normal.
        const double lobe = Kernel<double>::gaussian(wl, mirror(wv), 100.0);
        const double body = Kernel<double>::gaussian(wl, Vec3d(0, 0, 1), 0.5 + wv.z);
        EXPECT_WITHIN(double(a.r), 0.3 * body + lobe, 4e-3) << wv.z;
    }
}

TEST(Su, PlainWeightsArePositiveAndSumToOne) {
    std::mt19937_64 random(7);
    SuModel model = random_su(random, 500, 1);
    // With constant lobes, the value is the weighted mean of the neighbours' coefficients.
    for (float& lambda : model.bandwidth) lambda = 0;
    model.interpolation = SuInterpolation::plain;
    for (model.neighbours = 1; model.neighbours <= k_max_neighbours; ++model.neighbours)
        for (int i = 0; i < 300; ++i) {
            const Vec3f wv = to_float(random_direction(random, 0.01));
            const NearestViews nearest = nearest_views(model, wv);
            float smallest = 1e9f, largest = 0;
            for (int k = 0; k < model.neighbours; ++k) {
                const float beta = model.coefficient[nearest[std::size_t(k)]].r;
                smallest = std::min(smallest, beta);
                largest = std::max(largest, beta);
            }
            const float f = value(model, {0, 0, 1}, wv).r;
            EXPECT_TRUE(f >= smallest - 1e-6f && f <= largest + 1e-6f);
            if (model.neighbours == 1) {
                EXPECT_WITHIN(double(f), double(largest), 1e-6);
            }
        }
}

TEST(Su, ArraysAgreeWithSingleValues) {
    std::mt19937_64 random(8);
    SuModel model = random_su(random, 200, 5);
    for (const auto interpolation : k_interpolations)
        for (const auto discretise : {Discretise::view, Discretise::light}) {
            model.interpolation = interpolation;
            model.discretise = discretise;
            std::vector<Vec3f> wl, wv;
            while (wl.size() < 3000) {  // groups of 1 to 40 pairs with a common direction
                const Vec3f common = to_float(random_direction(random, -0.1));
                for (double i = 0; i < 40 * uniform(random); ++i) {
                    const Vec3f other = to_float(random_direction(random, -0.1));
                    wl.push_back(discretise == Discretise::view ? other : common);
                    wv.push_back(discretise == Discretise::view ? common : other);
                }
            }
            wv.back() = {0, 0, 1};  // the pole itself
            std::vector<Rgb> f(wl.size());
            evaluator(model)(wl, wv, f);
            for (std::size_t i = 0; i < f.size(); ++i) {
                const Rgb single = value(model, wl[i], wv[i]);
                for (int c = 0; c < 3; ++c) EXPECT_WITHIN(f[i][c], single[c], std::max(1e-4 * double(single[c]), 1e-6));
            }
        }
}

/// The green value by plain interpolation, from the nearest of the eight views of the direction's texel.
float value_by_texel(const SuModel& model, const IndexTexture& index, Vec3f wl, Vec3f wv) {
    NearestViews nearest = index.texels[texel_of(index.map, index.size, wv)];
    std::ranges::stable_sort(nearest, {}, [&](std::uint16_t view) {
        const Vec3f difference = model.direction[view] - wv;
        return dot(difference, difference);
    });
    return Kernel<float>::su_plain_value(model, nearest, wl, wv, model.neighbours).y;
}

TEST(Su, TexelsApproachTheExactNeighboursAsTheyShrink) {
    std::mt19937_64 random(10);
    SuModel model = random_su(random, 1536, 2);
    model.interpolation = SuInterpolation::plain;
    for (const auto map : {DirectionMap::cube, DirectionMap::parabolic}) {
        std::vector<double> errors;
        for (const int size : {8, 32, default_size(map)}) {
            const IndexTexture index = index_texture(model, map, size);
            double squares = 0, total = 0;
            for (int i = 0; i < 3000; ++i) {
                const Vec3f wl = to_float(random_direction(random, 0)), wv = to_float(random_direction(random, 0));
                const double exact = double(value(model, wl, wv).g),
                             by_texel = double(value_by_texel(model, index, wl, wv));
                squares += (exact - by_texel) * (exact - by_texel);
                total += exact * exact;
            }
            errors.push_back(squares / total);
        }
        EXPECT_GT(errors[0], 1e-3) << name(map);
        EXPECT_LT(errors[1], 0.1 * errors[0]) << name(map);
        EXPECT_LT(errors[2], 1e-6) << name(map);
    }
}

TEST(Su, BytesMatchThePublication) {
    std::mt19937_64 random(11);
    EXPECT_EQ(payload_bytes(random_su(random, 1536, 5)), 92160u);
    EXPECT_EQ(payload_bytes(random_su(random, 1536, 4)), 73728u);
    EXPECT_EQ(payload_bytes(random_su(random, 384, 1)), 384u * 12);
    SuModel model = random_su(random, 1536, 2);
    model.index = index_texture(model, DirectionMap::cube);
    EXPECT_EQ(auxiliary_bytes(model), 1572864u + 12288u);
}

TEST(SuFile, RoundTripGivesTheRoundedModel) {
    std::mt19937_64 random(12);
    for (const auto discretise : {Discretise::view, Discretise::light})
        for (const auto interpolation : k_interpolations)
            for (const int index : {0, 1, 2}) {
                SuModel model = random_su(random, 100, 3);
                model.discretise = discretise;
                model.interpolation = interpolation;
                model.neighbours = 1 + int(7 * uniform(random));
                if (index > 0)
                    model.index = index_texture(model, index == 1 ? DirectionMap::cube : DirectionMap::parabolic, 16);
                const SuModel rounded_model = rounded(model);
                EXPECT_EQ(rounded_model.index, model.index);
                EXPECT_EQ(rounded_model.direction, model.direction);
                EXPECT_EQ(rounded_model.neighbours, model.neighbours);
                for (std::size_t i = 0; i < model.bandwidth.size(); ++i) {
                    EXPECT_EQ(rounded_model.bandwidth[i], round_to_half(model.bandwidth[i]));
                    for (int c = 0; c < 3; ++c)
                        EXPECT_EQ(rounded_model.coefficient[i][c], round_to_half(model.coefficient[i][c]));
                    const Vec3f d = rounded_model.centre[i] - model.centre[i];
                    EXPECT_LE(dot(d, d), 2e-6f);
                }
                const auto bytes = write_model({model, {{"source", "a.bsdf"}}});
                const auto reread = checked(read_model(bytes, "x"));
                EXPECT_EQ(std::get<SuModel>(reread->model), rounded_model);
                EXPECT_EQ(reread->provenance, (std::map<std::string, std::string>{{"source", "a.bsdf"}}));
                // Rounding again has little effect: the angles are relative to a direction that is not in half
                // precision.
                EXPECT_EQ(rounded(rounded_model).bandwidth, rounded_model.bandwidth);
                EXPECT_EQ(rounded(rounded_model).coefficient, rounded_model.coefficient);
            }
}

TEST(SuFile, CentresNearTheMirrorDirectionAreAccurate) {
    std::mt19937_64 random(13);
    SuModel model = isotropic_su(1536);
    for (Vec3f& xi : model.centre) {
        const Vec3d offset = 0.01 * random_direction(random);
        xi = to_float(
            normalize(to_double(mirror(model.direction[std::size_t(&xi - model.centre.data()) / 2])) + offset));
    }
    const SuModel reread = rounded(model);
    for (std::size_t i = 0; i < model.centre.size(); ++i) {
        if (model.direction[i / 2].z > 0.99f) continue;  // azimuths vary strongly at the pole
        const Vec3f d = reread.centre[i] - model.centre[i];
        EXPECT_LE(std::sqrt(dot(d, d)), 3e-5f) << i;  // absolute angles would have an error of up to 1e-3
    }
}

}  // namespace
}  // namespace srbf::su_test
