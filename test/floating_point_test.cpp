// Few subnormal numbers in the inner loops of the fit, and no dependence of results on the caller's floating-point mode.
#include "base/floating_point.h"
#include "errors/measures.h"

#include <atomic>
#include <bit>
#include <cfenv>
#include <cstring>
#include <filesystem>
#include <limits>
#include <thread>

#include "../python/archive.h"
#include "measured/isotropy.h"
#include "models.h"
#include "models/ggx/ggx_kind.h"
#include "models/pm/search/fit_pm.h"
#include "models/su/fit_su.h"
#include "models/su/view_lobes.h"
#include "properties.h"
#include "samples/fit_pm_to_samples.h"
#include "samples/gap_filled_samples.h"
#include "samples/observe_samples.h"
#include "srbf/convert.h"
#include "srbf/file.h"
#include "srbf/library.h"
#include "srbf/measured.h"
#include "srbf/metrics.h"
#include "srbf/sampling.h"
#ifdef SRBF_RENDER
#include "extras/render/environment.h"
#include "extras/render/mesh.h"
#endif

namespace srbf {
namespace {

/// Statistics of the numbers that the loops read and wrote.
std::atomic<std::uint64_t> seen = 0, subnormal = 0;
void see(const float* numbers, std::size_t count = k_block) {
    std::uint64_t found = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const auto bits = std::bit_cast<std::uint32_t>(numbers[i]);  // a comparison depends on the mode
        found += (bits & 0x7f800000) == 0 && (bits & 0x007fffff) != 0;
    }
    seen += count, subnormal += found;
}
void see(std::span<const float* const> columns, std::size_t count = k_block) {
    for (const float* column : columns) see(column, count);
}

}  // namespace

// The linker replaces the loop of that name by each of these (option --wrap, test/CMakeLists.txt).
#define SRBF_WRAPPED(result, name, symbol, ...)               \
    result real_##name(__VA_ARGS__) asm("__real_" symbol);    \
    result wrapped_##name(__VA_ARGS__) asm("__wrap_" symbol); \
    result wrapped_##name(__VA_ARGS__)

SRBF_WRAPPED(float, exponent,
             "_ZN4srbf8exponentESt4spanIKfLm18446744073709551615EES0_IKPS1_Lm18446744073709551615EES3_Pfm",
             std::span<const float> weight, std::span<const float* const> s, const float* root_weight, float* x,
             std::size_t count) {
    see(s, count);
    const float largest = real_exponent(weight, s, root_weight, x, count);
    see(x, count);
    return largest;
}
SRBF_WRAPPED(void, exponentiate, "_ZN4srbf12exponentiateEPKfS1_fPfm", const float* x, const float* root_weight,
             float offset, float* e, std::size_t count) {
    see(x, count), see(root_weight, count);
    real_exponentiate(x, root_weight, offset, e, count);
    see(e, count);
}
SRBF_WRAPPED(double, residual,
             "_ZN4srbf8residualEPKfSt4spanIS0_Lm18446744073709551615EES2_IKS1_Lm18446744073709551615EEPfm",
             const float* y, std::span<const float> beta, std::span<const float* const> columns, float* r,
             std::size_t count) {
    see(y, count), see(beta.data(), beta.size()), see(columns, count);
    const double squares = real_residual(y, beta, columns, r, count);
    see(r, count);
    return squares;
}
SRBF_WRAPPED(void, add_gram, "_ZN4srbf8add_gramESt4spanIKPKfLm18446744073709551615EEPdm",
             std::span<const float* const> columns, double* G, std::size_t count) {
    see(columns, count);
    real_add_gram(columns, G, count);
}
SRBF_WRAPPED(void, add_products, "_ZN4srbf12add_productsESt4spanIKPKfLm18446744073709551615EES4_Pdm",
             std::span<const float* const> rows, std::span<const float* const> columns, double* G, std::size_t count) {
    see(rows, count), see(columns, count);
    real_add_products(rows, columns, G, count);
}
namespace {

Measured film() { return *load_measured((bundled_data() / "cc_ibiza_sunset_rgb.bsdf").string()); }

/// Spectra whose R, G, B are the ends and the middle: spectral measurements are not bundled.
Channels rainbow(const Measured& measured) {
    const std::vector<float> nm{450, 500, 550, 600, 650};
    return {nm, [f = signed_evaluator(measured)](auto wl, auto wv, auto spectra) {
                std::vector<Rgb> colour(wl.size());
                f(wl, wv, colour);
                for (std::size_t i = 0; i < colour.size(); ++i) {
                    const Rgb c = colour[i];
                    const float of[] = {c.b, (c.b + c.g) / 2, c.g, (c.g + c.r) / 2, c.r};
                    std::copy_n(of, 5, &spectra[5 * i]);
                }
            }};
}

struct Count {
    std::uint64_t seen, subnormal;
};
template <typename Body> Count counted(const Body& body) {
    seen = 0, subnormal = 0;
    body();
    return {seen, subnormal};
}
constexpr std::uint64_t k_many = 100'000'000;
/// The loops of the body process more than this many numbers, of which few are subnormal, since they take time: up to 1 in 90
/// was found.
template <typename Body> void expect_few(const Body& body, std::uint64_t many = k_many) {
    const Count count = counted(body);
    EXPECT_GT(count.seen, many);
    EXPECT_LT(count.subnormal, count.seen / 40);
}

TEST(InnerLoops, TheCountFindsASubnormalNumber) {
    std::vector<float> numbers(k_block, 1.f);
    numbers[3] = std::bit_cast<float>(std::uint32_t(7)), numbers[5] = 0;
    const Count count = counted([&] { see(numbers.data()); });
    EXPECT_EQ(count.seen, k_block);
    EXPECT_EQ(count.subnormal, 1u);
}

TEST(InnerLoops, SeeFewInTheDefaultFit) {
    const Measured measured = film();
    expect_few([&] {
        const auto fit = fit_pm(*observe(signed_evaluator(measured), {}), {});
        ASSERT_TRUE(fit.ok());
    });
}

TEST(InnerLoops, SeeFewInTheFormOfTheSource) {
    const Measured measured = film();
    const FitOptions options{.form = PmForm::gaussian, .starts = 4, .perturbations = 8};
    expect_few([&] {
        const auto fit = fit_pm(*observe(signed_evaluator(measured), {.objective = Objective::raw}), options);
        ASSERT_TRUE(fit.ok());
    });
}

TEST(InnerLoops, SeeFewInAFitOfGeneralLobes) {
    const Measured measured = film();
    const FitOptions options{.axial = false, .lobes = 4, .variates = 3, .starts = 4, .perturbations = 8};
    expect_few([&] {
        const auto fit = fit_pm(*observe(signed_evaluator(measured), {.count = 16384}), options);
        ASSERT_TRUE(fit.ok());
    });
}

TEST(InnerLoops, SeeFewInAViewByViewFit) {
    const Measured measured = film();
    expect_few([&] {
        const auto matrix = tabulate(signed_evaluator(measured), {.directions = 192});
        const auto fit = fit_su(*matrix, {.lobes = 5});
        ASSERT_TRUE(fit.ok());
    });
}

TEST(InnerLoops, SeeFewInASpectralFit) {
    const Measured measured = film();
    expect_few([&] {
        auto observations = *observe(signed_evaluator(measured), {.count = 16384});
        observe_spectra(observations, rainbow(measured));
        const auto fit = fit_pm(observations, {.lobes = 6, .variates = 3, .starts = 4, .perturbations = 8});
        ASSERT_TRUE(fit.ok());
    });
}

TEST(InnerLoops, SeeFewInAFitOfMeasuredSpectra) {
    const auto path = shared_data() / "cornell" / "krylon_blue.brdf";
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
    const Measured measured = *load_measured(path.string());
    expect_few(
        [&] {
            const auto observations =
                observe(std::get<ScatteredSamples>(measured.table),
                        ObserveSamplesOptions{.objective = Objective::cube_root, .spectral = true});
            ASSERT_TRUE(observations.ok());
            const auto fit =
                fit_pm(*observations, {{.lobes = 6, .variates = 3, .starts = 4, .perturbations = 8}, true});
            ASSERT_TRUE(fit.ok());
        },
        k_many / 10);
}

// ---- The caller's mode ----

#if defined(__SSE__)
/// Modes that a caller may have set, as values of MXCSR: the initial mode of a process; subnormal numbers as 0; rounding down, up,
/// and to 0, one of them with raised flags.
constexpr unsigned k_modes[] = {0x1f80, 0x9fc0, 0x3f80, 0x5fbf, 0x7f80};
unsigned mode_now() { return _mm_getcsr(); }
unsigned without_flags(unsigned mode) { return mode & ~0x3fu; }
void set_mode(unsigned mode) { _mm_setcsr(mode); }
#else
/// The standard library can only set the rounding mode.
constexpr int k_modes[] = {FE_TONEAREST, FE_DOWNWARD, FE_UPWARD, FE_TOWARDZERO};
int mode_now() { return std::fegetround(); }
int without_flags(int mode) { return mode; }
void set_mode(int mode) { std::fesetround(mode); }
#endif

TEST(StandardArithmetic, GivesBackWhatItFound) {
    const auto before = mode_now();
    for (const auto mode : k_modes) {
        set_mode(mode);
        {
            const StandardArithmetic standard;
            volatile double tiny = std::numeric_limits<double>::min();
            tiny = tiny * tiny;  // raises flags
            const auto within = mode_now();
            { const StandardArithmetic once_more; }
            EXPECT_EQ(mode_now(), within);
        }
        EXPECT_EQ(mode_now(), mode);
    }
    set_mode(before);
}

TEST(StandardArithmetic, KeepsSubnormals) {
    const auto before = mode_now();
    for (const auto mode : k_modes) {
        set_mode(mode);
        const StandardArithmetic standard;
        volatile float least = std::numeric_limits<float>::min();
        volatile double least_double = std::numeric_limits<double>::min();
        EXPECT_GT(least / 2, 0);
        EXPECT_GT(least_double / 2, 0);
        volatile float subnormal_operand = std::bit_cast<float>(std::uint32_t(0x00400000));
        EXPECT_GT(subnormal_operand * 1e30f, 0);
    }
    set_mode(before);
}

template <typename T> std::vector<std::byte> bytes_of(const std::vector<T>& numbers) {
    const auto bytes = std::as_bytes(std::span(numbers));
    return {bytes.begin(), bytes.end()};
}

/// All results of the library for a small fit.
std::vector<std::vector<std::byte>> results(const Measured& measured, int threads) {
    std::vector<std::vector<std::byte>> all;
    const Evaluate f = signed_evaluator(measured);
    const auto observations = observe(f, {.count = 4096, .threads = threads});
    all.push_back(bytes_of(observations->f)), all.push_back(bytes_of(observations->weight));
    const auto fit =
        fit_pm(*observations, {.lobes = 3, .variates = 3, .starts = 3, .perturbations = 4, .threads = threads});
    all.push_back(write_model({fit->model, {}}));
    const auto matrix = tabulate(f, {.directions = 64, .between = 64, .threads = threads});
    const auto su = fit_su(*matrix, {.lobes = 2, .threads = threads});
    all.push_back(write_model({su->model, {}}));
    const auto ggx = Kind<GgxModel>::fit(*observations, {}, {.threads = threads});
    all.push_back(write_model({ggx->model, {}}));
    const Model models[] = {{fit->model, {}}, {su->model, {}}, {ggx->model, {}}};
    for (const Model& model : models) {
        const Evaluate others[] = {evaluator(model)};
        const Measures measures = measure_heldout(rgb_channels(f), rgb_channels(others), {1.5, threads}, 2000)[0];
        all.push_back(bytes_of(std::vector{measures.squared_error_ratio, measures.squared_error_ratio_cosine,
                                           measures.log_rms_cosine, measures.cube_root_error_ratio}));
        const Rgb albedo_at = albedo(others[0], 0.5, 1.5);
        all.push_back(bytes_of(std::vector{albedo_at.r, albedo_at.g, albedo_at.b}));
    }
    const MixtureProposal proposal = propose(evaluator(models[0]), {.threads = threads});
    for (std::size_t node = 0; node < MixtureProposal::k_nodes; ++node)
        all.push_back(bytes_of(std::vector(proposal.weight(node).begin(), proposal.weight(node).end())));
    all.push_back(bytes_of(to_merl(f, {6, 6, 8}, threads).cells));
    all.push_back({std::byte(is_isotropic(evaluator(measured), 1.4))});
    return all;
}

TEST(CallersMode, ChangesNoResultAndStaysAsItIs) {
    const Measured measured = film();
    const auto before = mode_now();
    const auto expected = results(measured, 1);
    for (const int threads : {1, 2})
        for (const auto mode : k_modes) {
            if (threads == 2 && mode != k_modes[1]) continue;  // what threads inherit
            set_mode(mode);
            const auto found = results(measured, threads);
            const auto after = mode_now();
            set_mode(before);
            EXPECT_EQ(without_flags(after), without_flags(mode));
            ASSERT_EQ(found.size(), expected.size());
            for (std::size_t i = 0; i < found.size(); ++i)
                EXPECT_TRUE(found[i] == expected[i])
                    << "result " << i << " with " << threads << " threads in mode " << mode;
        }
}

/// All numbers of what a file holds, of whatever kind, and values at some pairs.
std::string what_is_read(const std::filesystem::path& path) {
    ArchiveWriter writer;
    if (const auto brdf = load_brdf(path.string())) {
        writer(*brdf);
        static const std::vector<Vec3f> wl = fibonacci_directions(40, 1.5), wv(wl.rbegin(), wl.rend());
        std::vector<Rgb> f(wl.size());
        std::visit([&](const auto& of) { evaluator(of)(wl, wv, f); }, *brdf);
        writer(f);
    } else {
        writer(message(brdf.error()));
    }
    const auto bytes = *read_file(path.string());
#ifdef SRBF_RENDER
    if (const auto environment = read_environment(bytes, "f")) writer(environment->texels().pixels);
    if (const auto mesh = read_mesh(bytes, "f")) writer(mesh->positions), writer(mesh->normals);
#endif
    if (const auto library = read_library(bytes, "f"))
        for (std::size_t t = 0; t < library->count(); ++t) writer(material(*library, t));
    if (const auto stack = read_stack(bytes, "f"))
        for (const PmModel& model : stack->models) writer(model);
    return writer.bytes;
}

TEST(CallersMode, FilesAreReadAlike) {
    const auto before = mode_now();
    std::size_t files = 0;
    for (const char* folder : {"fuzz/corpus", "test/models", "data"})
        for (const auto& entry :
             std::filesystem::recursive_directory_iterator(std::filesystem::path(SRBF_SOURCE_DIR) / folder)) {
            if (!entry.is_regular_file()) continue;
            ++files;
            const std::string expected = what_is_read(entry.path());
            for (const auto mode : k_modes) {
                set_mode(mode);
                const std::string found = what_is_read(entry.path());
                const auto after = mode_now();
                set_mode(before);
                EXPECT_EQ(without_flags(after), without_flags(mode)) << entry.path();
                EXPECT_TRUE(found == expected) << entry.path() << " in mode " << mode;
            }
        }
    EXPECT_GT(files, 150u);
}

}  // namespace
}  // namespace srbf
