// Fits of many texels.
#include "srbf/fit_batch.h"
#include "errors/measures.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "program.h"
#include "properties.h"
#include "samples/fit_pm_to_samples.h"
#include "samples/gap_filled_samples.h"
#include "srbf/directions.h"
#include "srbf/file.h"
#include "srbf/load.h"
#include "srbf/npy.h"

namespace srbf::fit_batch_test {
namespace {

constexpr std::size_t k_pairs = 150;

/// Pairs within 75°, half of the lights uniform and half about the mirror direction.
SharedPairs shared_pairs() {
    SharedPairs pairs;
    std::mt19937_64 random(1);
    const double cap = 75 * k_degree;
    const MirrorMixture lights(cap);
    const auto in_cap = [&] {
        const double u1 = uniform(random), u2 = uniform(random);
        return spherical(std::acos(1 - (1 - std::cos(cap)) * u1), 2 * k_pi * u2);
    };
    while (pairs.wl.size() < k_pairs) {
        const Vec3d v = in_cap();
        const double u1 = uniform(random), u2 = uniform(random), u3 = uniform(random);
        const Vec3d l = pairs.wl.size() % 2 == 0 ? in_cap() : lights.sample(v, u1, u2, u3);
        if (l.z < std::cos(cap)) continue;
        pairs.wl.push_back(to_float(l)), pairs.wv.push_back(to_float(v));
    }
    return pairs;
}

/// Texels [T, pairs]: blends of the bundled measurements with noise of 2 %.
std::vector<Rgb> blends(const SharedPairs& pairs, std::size_t count) {
    const auto a = load_measured(bundled_data() / "paper_white_rgb.bsdf"),
               b = load_measured(bundled_data() / "cc_ibiza_sunset_rgb.bsdf");
    EXPECT_TRUE(a && b);
    std::mt19937_64 random(2);
    std::vector<Rgb> f;
    for (std::size_t t = 0; t < count; ++t) {
        const double share = double(t) / double(std::max<std::size_t>(count - 1, 1));
        for (std::size_t i = 0; i < pairs.wl.size(); ++i) {
            const Rgb x = value(*a, pairs.wl[i], pairs.wv[i]), y = value(*b, pairs.wl[i], pairs.wv[i]);
            Rgb blend;
            for (int c = 0; c < 3; ++c)
                blend[c] = float(((1 - share) * double(x[c]) + share * double(y[c])) * (0.96 + 0.08 * uniform(random)));
            f.push_back(blend);
        }
    }
    return f;
}

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
        SampleFitOptions single;
        single.pm.lobes = 4, single.pm.starts = 6, single.pm.perturbations = 14, single.pm.threads = 2;
        const auto fitted = fit_pm(*observed, single);
        ASSERT_TRUE(fitted);
        const Objective objective = options.request.objective;
        of_batch += error_of((*fits)[t].errors, objective);
        of_single += error_of(measure_samples(samples.wl, samples.wv, samples.colour, evaluator(fitted->model),
                                              default_max_theta(objective)),
                              objective);
    }
    EXPECT_LT(of_batch, 1.4 * of_single);  // a third of the search, a quarter of the pairs
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

std::string npy(const std::string& header, std::size_t numbers) {
    std::string text = "\x93NUMPY";
    text += std::string("\1\0", 2) + char(header.size()) + '\0' + header;
    return text + std::string(4 * numbers, '\0');
}

TEST(Npy, head_is_read_and_every_truncation_is_an_error) {
    const std::string header = "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 5, 3), }\n";
    const std::string file = npy(header, 30);
    const auto head = read_npy_head(as_bytes(file), file.size(), "t.npy");
    ASSERT_TRUE(head) << message(head.error());
    EXPECT_EQ(head->shape, (std::vector<std::uint64_t>{2, 5, 3}));
    EXPECT_EQ(head->data, 10 + header.size());
    for (std::size_t n = 0; n < file.size(); ++n)
        EXPECT_FALSE(read_npy_head(as_bytes(std::string_view(file).substr(0, n)), n, "t.npy").ok()) << n;
    for (const char* bad : {"{'descr': '<f8', 'fortran_order': False, 'shape': (2, 5, 3), }",
                            "{'descr': '<f4', 'fortran_order': True, 'shape': (2, 5, 3), }",
                            "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 5, -3), }",
                            "{'descr': '<f4', 'fortran_order': False, 'shape': (99999999999, 99999999999), }",
                            "{'descr': '<f4', 'fortran_order': False, 'shape': (0, 3), }", "{}"}) {
        const std::string wrong = npy(bad, 30);
        EXPECT_FALSE(read_npy_head(as_bytes(wrong), wrong.size(), "t.npy").ok()) << bad;
    }
}

/// A folder with the texels and pairs as files.
class TexelFiles : public testing::Test {
  protected:
    void SetUp() override {
        const SharedPairs pairs = shared_pairs();
        const std::vector<Rgb> f = blends(pairs, k_texels);
        std::string csv = "wl_x,wl_y,wl_z,wv_x,wv_y,wv_z\n";
        for (std::size_t i = 0; i < k_pairs; ++i) {
            const Vec3f l = pairs.wl[i], v = pairs.wv[i];
            csv += fmt::format("{},{},{},{},{},{}\n", l.x, l.y, l.z, v.x, v.y, v.z);
        }
        write(folder / "p.csv", csv);
        const std::string header =
            fmt::format("{{'descr': '<f4', 'fortran_order': False, 'shape': ({}, {}, 3), }}\n", k_texels, k_pairs);
        write(folder / "t.npy", npy(header, 0) + std::string(reinterpret_cast<const char*>(f.data()), 12 * f.size()));
    }
    static constexpr std::size_t k_texels = 8;
    const std::vector<std::string> fit{"map",    "t.npy", "--pairs",    "p.csv", "--lobes",   "3",
                                       "--slab", "2",     "--variates", "3",     "--threads", "2"};
    TemporaryFolder folder;
};

std::vector<std::string> operator+(std::vector<std::string> a, const std::vector<std::string>& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

std::map<std::string, std::string> files_in(const std::string& folder) {
    std::map<std::string, std::string> all;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        if (!entry.path().filename().string().starts_with("."))
            all[entry.path().filename().string()] = contents(entry.path().string());
    return all;
}

TEST_F(TexelFiles, killed_and_resumed_nothing_is_lost) {
    const ProgramRun whole = run(folder, fit + std::vector<std::string>{"-o", "whole"});
    ASSERT_EQ(whole.status, 0) << whole.err;
    const auto expected = files_in(folder / "whole");
    ASSERT_EQ(expected.size(), k_texels / 2);
    const auto stack = read_stack(as_bytes(expected.at("t-000000002.srbf")), "t");
    ASSERT_TRUE(stack) << message(stack.error());
    EXPECT_EQ(stack->models.size(), 2u);

    // Killed once the first slab is there.
    const TemporaryFolder captured;
    const pid_t process =
        start(folder, fit + std::vector<std::string>{"-o", "killed"}, captured / "out", captured / "err");
    ASSERT_NE(process, 0);
    while (!std::filesystem::exists(folder / "killed/t-000000000.srbf")) ::usleep(1000);
    ::kill(process, SIGKILL);
    ::waitpid(process, nullptr, 0);
    const auto left = files_in(folder / "killed");
    EXPECT_LT(left.size(), expected.size());
    for (const auto& [name, text] : left) EXPECT_EQ(text, expected.at(name)) << name;
    // A slab that is not whole is fitted again.
    write(folder / "killed/t-000000002.srbf", expected.at("t-000000002.srbf").substr(0, 900));
    const ProgramRun resumed = run(folder, fit + std::vector<std::string>{"-o", "killed", "--resume"});
    ASSERT_EQ(resumed.status, 0) << resumed.err;
    EXPECT_EQ(files_in(folder / "killed"), expected);
    EXPECT_EQ(resumed.out.find(" 0 kept"), resumed.out.npos) << resumed.out;
    // By other options everything is.
    const ProgramRun other =
        run(folder, fit + std::vector<std::string>{"-o", "killed", "--resume", "--seed", "1", "--texels", "0:2"});
    EXPECT_NE(other.out.find(" 0 kept"), other.out.npos) << other.out;
}

TEST_F(TexelFiles, ranges_make_the_same_slabs) {
    ASSERT_EQ(run(folder, fit + std::vector<std::string>{"-o", "a", "--texels", "4:6"}).status, 0);
    ASSERT_EQ(run(folder, fit + std::vector<std::string>{"-o", "b", "--texels", "2:8"}).status, 0);
    EXPECT_EQ(files_in(folder / "a").at("t-000000004.srbf"), files_in(folder / "b").at("t-000000004.srbf"));
    for (const auto& bad : {"8:9", "0:9"})
        EXPECT_EQ(run(folder, fit + std::vector<std::string>{"-o", "c", "--texels", bad}).status, 1) << bad;
    for (const auto& bad : {"2:2", "3", "a:b", "-1:2"})
        EXPECT_EQ(run(folder, fit + std::vector<std::string>{"-o", "c", "--texels", bad}).status, 2) << bad;
    EXPECT_FALSE(std::filesystem::exists(folder / "c"));
}

TEST_F(TexelFiles, slabs_of_another_division_or_other_bytes_are_not_mixed_in) {
    using Words = std::vector<std::string>;
    const auto fitted = [&](const char* to, const char* slab, const char* texels, const Words& resume) {
        return run(folder, Words{"map", "t.npy", "--pairs", "p.csv", "--lobes", "1", "--variates", "1", "-o", to,
                                 "--slab", slab, "--texels", texels} +
                               resume);
    };
    ASSERT_EQ(fitted("o", "2", "0:2", {}).status, 0);
    ASSERT_EQ(fitted("fresh", "1", "0:2", {}).status, 0);
    const auto of_two = files_in(folder / "o"), of_one = files_in(folder / "fresh");
    const auto expect_refused = [&](const char* slab, const char* texels) {
        const auto before = files_in(folder / "o");
        for (const Words& resume : {Words{}, {"--resume"}}) {
            const ProgramRun refused = fitted("o", slab, texels, resume);
            EXPECT_EQ(refused.status, 1) << slab << ' ' << texels;
            EXPECT_NE(refused.err.find("one of another --slab"), refused.err.npos) << refused.err;
            EXPECT_EQ(files_in(folder / "o"), before);
        }
    };
    // The slab reaches into the range, or out of it.
    expect_refused("1", "1:2");
    expect_refused("1", "0:1");
    // One that begins alike is fitted again; one that begins within another is refused.
    EXPECT_NE(fitted("o", "1", "0:2", {"--resume"}).out.find(" 0 kept"), std::string::npos);
    EXPECT_EQ(files_in(folder / "o"), of_one);
    expect_refused("2", "0:2");
    // A slab of other bytes is fitted again, and so is another slab in its place.
    const std::string name = "t-000000001.srbf", slab = of_one.at(name);
    std::vector<std::string> others{of_one.at("t-000000000.srbf")};
    for (const std::size_t at : {std::size_t(9), slab.find("objective") + 14, slab.size() / 2, slab.size() - 1}) {
        others.push_back(slab);
        others.back()[at] = char(others.back()[at] ^ 1);
    }
    for (const std::string& other : others) {
        write(folder / ("o/" + name), other);
        EXPECT_EQ(fitted("o", "1", "0:2", {"--resume"}).status, 0);
        EXPECT_EQ(files_in(folder / "o"), of_one);
    }
}

}  // namespace
}  // namespace srbf::fit_batch_test
