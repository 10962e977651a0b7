// Fits of many texels.
#include "srbf/fit_batch.h"
#include "errors/measures.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "brdf/directions.h"
#include "fit/texel_stream.h"
#include "models/ggx/ggx_functions.h"
#include "properties.h"
#include "samples/fit_pm_to_samples.h"
#include "samples/gap_filled_samples.h"
#include "srbf/load.h"
#include "texel_values.h"

namespace srbf::fit_batch_test {
namespace {

BatchOptions small_options(int threads) {
    BatchOptions options;
    PmRequest pm;
    pm.variates = 3, pm.size = LobeCount{3};
    options.request.model = pm;
    options.request.threads = threads;
    options.starts = 2, options.perturbations = 2;
    return options;
}

TEST(FitBatch, texels_do_not_depend_on_their_neighbours_threads_or_slabs) {
    const SharedPairs pairs = shared_pairs();
    const std::vector<Rgb> f = blends(pairs, 5);
    const auto all = fit_batch(pairs, f, small_options(2));
    ASSERT_TRUE(all) << message(all.error());
    ASSERT_EQ(all->size(), 5u);
    const auto alone = fit_batch(pairs, std::span(f).subspan(3 * k_pairs, k_pairs), small_options(1));
    ASSERT_TRUE(alone);
    EXPECT_EQ(alone->front().model, (*all)[3].model);

    std::vector<PmModel> streamed;
    std::size_t read = 0;
    TexelStream stream{1, 5, 2, {}, {}, {}};
    stream.read = [&](std::size_t first, std::span<Rgb> to) -> Result<Done> {
        read += to.size() / k_pairs;
        std::copy_n(f.begin() + std::ptrdiff_t(first * k_pairs), to.size(), to.begin());
        return Done{};
    };
    stream.take = [&](std::size_t first, std::span<const TexelFit> fits) -> Result<Done> {
        EXPECT_EQ(first, 3u);
        for (const TexelFit& fit : fits) streamed.push_back(fit.model);
        return Done{};
    };
    stream.is_done = [](std::size_t first, std::size_t count) { return first == 1 && count == 2; };
    ASSERT_TRUE(fit_batch(pairs, stream, small_options(2)).ok());
    EXPECT_EQ(read, 2u);
    ASSERT_EQ(streamed.size(), 2u);
    EXPECT_EQ(streamed[0], (*all)[3].model);
    EXPECT_EQ(streamed[1], (*all)[4].model);
}

TEST(FitBatch, lobes_of_examples_are_nearly_as_good_as_searches) {
    const SharedPairs pairs = shared_pairs();
    const std::vector<Rgb> f = blends(pairs, 9);
    BatchOptions options;
    const auto searched = fit_batch(pairs, f, options);
    ASSERT_TRUE(searched);
    for (const std::size_t t : {0, 4, 8}) options.examples.push_back((*searched)[t].model);
    const auto fits = fit_batch(pairs, f, options);
    ASSERT_TRUE(fits) << message(fits.error());
    double of_examples = 0, of_searches = 0;
    for (std::size_t t = 0; t < fits->size(); ++t) {
        EXPECT_EQ((*fits)[t].state, TexelState::fitted);
        of_examples += (*fits)[t].errors.cube_root_error_ratio;
        of_searches += (*searched)[t].errors.cube_root_error_ratio;
    }
    EXPECT_LT(of_examples, 1.5 * of_searches);
    const auto alone = fit_batch(pairs, std::span(f).subspan(3 * k_pairs, k_pairs), options);
    ASSERT_TRUE(alone);
    EXPECT_EQ(alone->front().model, (*fits)[3].model);
    // Fewer values than numbers: coefficients of an example's lobes, or a constant.
    std::vector<Rgb> few(f.begin(), f.begin() + k_pairs);
    for (std::size_t i = 6; i < k_pairs; ++i) few[i].g = std::numeric_limits<float>::quiet_NaN();
    const auto sparse = fit_batch(pairs, few, options);
    ASSERT_TRUE(sparse);
    EXPECT_EQ(sparse->front().state, TexelState::fitted);
    options.examples.front().lobes = 2;
    EXPECT_EQ(fit_batch(pairs, f, options).error().code, ErrorCode::argument);
}

/// Where a texel is Lambert and GGX, lobes from examples follow that between the samples rather than the samples' noise.
TEST(FitBatch, lobes_of_examples_are_as_good_as_searches_between_the_samples_of_microfacets) {
    const SharedPairs pairs = shared_pairs(), others = shared_pairs(2);
    std::mt19937_64 random(4);
    std::vector<Rgb> f;
    std::vector<std::vector<Rgb>> expected(8);
    for (std::size_t t = 0; t < expected.size(); ++t) {
        const float x = float(t) / 8;
        const GgxModel ggx{{0.5f - 0.4f * x, 0.3f, 0.1f + 0.4f * x}, {{0.1f + 0.4f * x, {0.05f, 0.2f * x, 0.1f}, 1}}};
        for (std::size_t i = 0; i < k_pairs; ++i) {
            f.push_back(value(ggx, pairs.wl[i], pairs.wv[i]));
            for (int c = 0; c < 3; ++c) f.back()[c] *= float(0.96 + 0.08 * uniform(random));
            expected[t].push_back(value(ggx, others.wl[i], others.wv[i]));
        }
    }
    BatchOptions options;
    const auto searched = fit_batch(pairs, f, options);
    ASSERT_TRUE(searched);
    for (const std::size_t t : {0, 4, 7}) options.examples.push_back((*searched)[t].model);
    const auto fits = fit_batch(pairs, f, options);
    ASSERT_TRUE(fits);
    const auto error_of_all = [&](const std::vector<TexelFit>& of) {
        double sum = 0;
        for (std::size_t t = 0; t < of.size(); ++t)
            sum += measure_samples(others.wl, others.wv, expected[t], evaluator(of[t].model), 75 * k_degree)
                       .cube_root_error_ratio;
        return sum;
    };
    EXPECT_LT(error_of_all(*fits), 1.2 * error_of_all(*searched));
}

/// Texels of one value with noise of 2 %: nothing rises between the samples, of which the nearest to the mirror direction
/// are some degrees away; a texel with a highlight keeps it.
TEST(FitBatch, matte_texels_have_no_highlights) {
    std::mt19937_64 random(3);
    SharedPairs pairs;
    for (int i = 0; i < 150; ++i) {
        pairs.wl.push_back(to_float(random_direction(random, 0.2)));
        pairs.wv.push_back(to_float(random_direction(random, 0.2)));
    }
    std::vector<Rgb> f;
    for (int t = 0; t < 3; ++t)
        for (std::size_t i = 0; i < pairs.wl.size(); ++i) {
            const double h = normalize(to_double(pairs.wl[i]) + to_double(pairs.wv[i])).z;
            const double value = 0.1 + (t == 2 ? std::exp(10 * (h - 1)) : 0);
            const auto drawn = [&] { return float(value * (0.965 + 0.07 * uniform(random))); };
            const float r = drawn(), g = drawn(), b = drawn();
            f.push_back({r, g, b});
        }
    const auto fits = fit_batch(pairs, f, {});
    ASSERT_TRUE(fits) << message(fits.error());
    for (double theta = 0; theta < 76; theta += 3) {
        const Vec3f wl = to_float(spherical(theta * k_degree, 0.0)), wv = to_float(spherical(theta * k_degree, k_pi));
        for (std::size_t t = 0; t < 2; ++t)
            for (int c = 0; c < 3; ++c)
                EXPECT_PRED3(near_relative, value((*fits)[t].model, wl, wv)[c], 0.1, 0.06) << t << ' ' << theta;
        if (theta <= 45) {
            EXPECT_PRED3(near_relative, value((*fits)[2].model, wl, wv).r, 1.1, 0.3) << theta;
        }
    }
}

TEST(FitBatch, texels_without_values_do_not_stop_the_others) {
    SharedPairs pairs = shared_pairs();
    std::vector<Rgb> f = blends(pairs, 1);
    const std::vector<Rgb> whole = f;
    const float nan = std::nanf("");
    f.insert(f.end(), k_pairs, Rgb{0, 0, 0});
    f.insert(f.end(), k_pairs, Rgb{nan, nan, nan});
    f.insert(f.end(), whole.begin(), whole.end());
    for (std::size_t i = 3 * k_pairs; i < 3 * k_pairs + 30; ++i) f[i].g = nan;
    const auto fits = fit_batch(pairs, f, small_options(2));
    ASSERT_TRUE(fits) << message(fits.error());
    const TexelState expected[] = {TexelState::fitted, TexelState::black, TexelState::failed, TexelState::fitted};
    for (std::size_t t = 0; t < 4; ++t) EXPECT_EQ((*fits)[t].state, expected[t]) << t;
    EXPECT_TRUE((*fits)[2].failure && !(*fits)[1].failure);
    for (const std::size_t t : {1u, 2u}) {
        const Rgb black = value((*fits)[t].model, pairs.wl[0], pairs.wv[0]);
        EXPECT_EQ(std::max({black.r, black.g, black.b}), 0);
        EXPECT_EQ(rounded((*fits)[t].model), (*fits)[t].model);
    }
    // A number that stands for no value is as good as NaN.
    std::vector<Rgb> missing(f.end() - k_pairs, f.end());
    for (std::size_t i = 0; i < 30; ++i) missing[i].g = -999;
    const auto masked = fit_batch(pairs, missing, small_options(1));
    ASSERT_TRUE(masked);
    EXPECT_EQ(masked->front().model, (*fits)[3].model);
    // Pairs without a value, or below the horizon, are as good as absent.
    SharedPairs fewer = pairs;
    for (auto* of : {&fewer.wl, &fewer.wv}) of->erase(of->begin(), of->begin() + 30);
    const auto same = fit_batch(fewer, std::span(whole).subspan(30), small_options(1));
    ASSERT_TRUE(same);
    EXPECT_EQ(same->front().model, (*fits)[3].model);
    for (std::size_t i = 0; i < 30; ++i) pairs.wl[i].z *= -1;
    const auto below = fit_batch(pairs, whole, small_options(1));
    ASSERT_TRUE(below);
    EXPECT_EQ(below->front().model, same->front().model);
}

TEST(FitBatch, is_nearly_as_accurate_as_single_fits) {
    const SharedPairs pairs = shared_pairs();
    const std::vector<Rgb> f = blends(pairs, 3);
    BatchOptions options;
    options.request.threads = 2;
    const auto fits = fit_batch(pairs, f, options);
    ASSERT_TRUE(fits);
    double of_batch = 0, of_single = 0;
    for (std::size_t t = 0; t < 3; ++t) {
        ScatteredSamples samples;
        samples.wl = pairs.wl, samples.wv = pairs.wv;
        samples.colour.assign(f.begin() + std::ptrdiff_t(t * k_pairs), f.begin() + std::ptrdiff_t((t + 1) * k_pairs));
        make_index(samples);
        const auto observed = observe(samples, {.threads = 2});
        ASSERT_TRUE(observed);
        PmFitOptions single;
        single.lobes = 4, single.starts = 6, single.perturbations = 14, single.threads = 2;
        const auto fitted = fit_pm(*observed, single);
        ASSERT_TRUE(fitted);
        const Objective objective = options.request.objective;
        of_batch += error_of((*fits)[t].errors, objective);
        of_single += error_of(measure_samples(samples.wl, samples.wv, samples.colour, evaluator(fitted->model),
                                              default_max_theta(objective)),
                              objective);
    }
    EXPECT_LT(of_batch, 1.5 * of_single);  // a third of the search, a quarter of the pairs
}

TEST(FitBatch, refuses_and_cancels) {
    const SharedPairs pairs = shared_pairs();
    const std::vector<Rgb> f = blends(pairs, 1);
    EXPECT_EQ(fit_batch(pairs, std::span(f).first(k_pairs - 1), small_options(1)).error().code, ErrorCode::argument);
    BatchOptions other = small_options(1);
    other.request.model = SuRequest{};
    EXPECT_EQ(fit_batch(pairs, f, other).error().code, ErrorCode::argument);
    other.request.model = PmRequest{};
    EXPECT_EQ(fit_batch(pairs, f, other).error().code, ErrorCode::argument);
    EXPECT_EQ(fit_batch({}, f, small_options(1)).error().code, ErrorCode::argument);
    const auto cancelled = fit_batch(pairs, f, small_options(1), [](const Progress&) { return false; });
    EXPECT_EQ(cancelled.error().code, ErrorCode::cancelled);
}

}  // namespace
}  // namespace srbf::fit_batch_test
