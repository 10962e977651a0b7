// Subnormal numbers are rare in the inner loops of fits, and results do not depend on the caller's floating-point
// mode.
#include "base/floating_point.h"
#include "errors/measures.h"

#include <atomic>
#include <bit>
#include <cfenv>
#include <limits>

#include "measured/tables.h"
#include "measured_files.h"
#include "models.h"
#include "models/ggx/ggx_kind.h"
#include "models/pm/search/fit_pm.h"
#include "models/su/fit_su.h"
#include "models/su/view_lobes.h"
#include "properties.h"
#include "samples/gap_filled_samples.h"
#include "samples/observe_samples.h"
#include "srbf/convert.h"
#include "srbf/file.h"
#include "srbf/load.h"
#include "srbf/map.h"
#include "srbf/measured.h"
#include "srbf/metrics.h"
#include "srbf/sampling.h"
#ifdef SRBF_RENDER
#include "brdf/values.h"
#include "extras/render/environment.h"
#include "extras/render/mesh.h"
#include "models/ggx/ggx_kind.h"
#endif

namespace srbf::floating_point_test {
namespace {

/// Counts of the numbers that the loops read and wrote.
std::atomic<std::uint64_t> total = 0, subnormal = 0;
void count_numbers(const float* numbers, std::size_t count = k_block) {
    std::uint64_t subnormals = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const auto bits = std::bit_cast<std::uint32_t>(numbers[i]);  // a comparison depends on the mode
        subnormals += (bits & 0x7f800000) == 0 && (bits & 0x007fffff) != 0;
    }
    total += count;
    subnormal += subnormals;
}
void count_numbers(std::span<const float* const> columns, std::size_t count = k_block) {
    for (const float* column : columns) count_numbers(column, count);
}

}  // namespace

// The linker replaces each loop by the wrapper of that name (option --wrap, test/CMakeLists.txt).
#define SRBF_WRAPPED(result, name, symbol, ...)                                  \
    result real_##name(__VA_ARGS__) asm("__real_" SRBF_LINKER_PREFIX symbol);    \
    result wrapped_##name(__VA_ARGS__) asm("__wrap_" SRBF_LINKER_PREFIX symbol); \
    result wrapped_##name(__VA_ARGS__)

SRBF_WRAPPED(float, exponent, "8exponentESt4spanIKfLm18446744073709551615EES1_IKPS2_Lm18446744073709551615EES4_Pfm",
             std::span<const float> weight, std::span<const float* const> s, const float* root_weight, float* x,
             std::size_t count) {
    count_numbers(s, count);
    const float largest = real_exponent(weight, s, root_weight, x, count);
    count_numbers(x, count);
    return largest;
}
SRBF_WRAPPED(void, exponentiate, "12exponentiateEPKfS2_fPfm", const float* x, const float* root_weight, float offset,
             float* e, std::size_t count) {
    count_numbers(x, count);
    count_numbers(root_weight, count);
    real_exponentiate(x, root_weight, offset, e, count);
    count_numbers(e, count);
}
SRBF_WRAPPED(double, residual, "8residualEPKfSt4spanIS1_Lm18446744073709551615EES3_IKS2_Lm18446744073709551615EEPfm",
             const float* y, std::span<const float> beta, std::span<const float* const> columns, float* r,
             std::size_t count) {
    count_numbers(y, count);
    count_numbers(beta.data(), beta.size());
    count_numbers(columns, count);
    const double squares = real_residual(y, beta, columns, r, count);
    count_numbers(r, count);
    return squares;
}
SRBF_WRAPPED(void, add_gram, "8add_gramESt4spanIKPKfLm18446744073709551615EEPdm", std::span<const float* const> columns,
             double* G, std::size_t count) {
    count_numbers(columns, count);
    real_add_gram(columns, G, count);
}
SRBF_WRAPPED(void, add_products, "12add_productsESt4spanIKPKfLm18446744073709551615EES5_Pdm",
             std::span<const float* const> rows, std::span<const float* const> columns, double* G, std::size_t count) {
    count_numbers(rows, count);
    count_numbers(columns, count);
    real_add_products(rows, columns, G, count);
}
namespace {

struct Counts {
    std::uint64_t total, subnormal;
};
template <typename Body> Counts counts_of(const Body& body) {
    total = 0;
    subnormal = 0;
    body();
    return {total, subnormal};
}
constexpr std::uint64_t k_many = 100'000'000;
/// Expects that the loops of `body` process more than `many` numbers, and that few of them are subnormal, because
/// those are slow. The largest measured fraction was 1 in 90.
template <typename Body> void expect_few(const Body& body, std::uint64_t many = k_many) {
    const Counts count = counts_of(body);
    EXPECT_GT(count.total, many);
    EXPECT_LT(count.subnormal, count.total / 40);
}

TEST(FloatingPoint, CountersFindSubnormalNumbers) {
    std::vector<float> numbers(k_block, 1.f);
    numbers[3] = std::bit_cast<float>(std::uint32_t(7));
    numbers[5] = 0;
    const Counts count = counts_of([&] { count_numbers(numbers.data()); });
    EXPECT_EQ(count.total, k_block);
    EXPECT_EQ(count.subnormal, 1u);
}

TEST(FloatingPoint, FewNumbersOfTheDefaultFitAreSubnormal) {
    const Measured& measured = bundled("cc_ibiza_sunset_rgb");
    expect_few([&] { const auto fit = checked(fit_pm(*observe(signed_evaluator(measured), {}), {})); });
}

TEST(FloatingPoint, FewNumbersOfAViewByViewFitAreSubnormal) {
    const Measured& measured = bundled("cc_ibiza_sunset_rgb");
    expect_few([&] {
        const auto matrix = tabulate(signed_evaluator(measured), {.directions = 192});
        const auto fit = checked(fit_su(*matrix, {.lobes = 5}));
    });
}

TEST(FloatingPoint, FewNumbersOfAFitOfMeasuredSpectraAreSubnormal) {
    const auto path = shared_data() / "cornell" / "krylon_blue.brdf";
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
    const Measured measured = *load_measured(path.string());
    expect_few(
        [&] {
            const auto observations =
                checked(observe(std::get<ScatteredSamples>(measured.table),
                                ObserveSamplesOptions{.objective = Objective::cube_root, .spectral = true}));
            const auto fit =
                checked(fit_pm(*observations, {.lobes = 6, .variates = 3, .starts = 4, .perturbations = 8}));
        },
        k_many / 10);
}

// ---- The caller's mode ----

#if defined(__SSE__)
/// Modes that a caller may have set, as values of MXCSR: the initial mode of a process; subnormal numbers treated as
/// 0; rounding down, up and to 0, one of them with raised flags.
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

TEST(StandardArithmetic, RestoresTheMode) {
    const auto initial = mode_now();
    for (const auto mode : k_modes) {
        set_mode(mode);
        {
            const StandardArithmetic standard;
            volatile double tiny = std::numeric_limits<double>::min();
            tiny = tiny * tiny;  // raises flags
            const auto inner = mode_now();
            { const StandardArithmetic nested; }
            EXPECT_EQ(mode_now(), inner);
        }
        EXPECT_EQ(mode_now(), mode);
    }
    set_mode(initial);
}

TEST(StandardArithmetic, KeepsSubnormals) {
    const auto initial = mode_now();
    for (const auto mode : k_modes) {
        set_mode(mode);
        const StandardArithmetic standard;
        volatile float min = std::numeric_limits<float>::min();
        volatile double least_double = std::numeric_limits<double>::min();
        EXPECT_GT(min / 2, 0);
        EXPECT_GT(least_double / 2, 0);
        volatile float subnormal_operand = std::bit_cast<float>(std::uint32_t(0x00400000));
        EXPECT_GT(subnormal_operand * 1e30f, 0);
    }
    set_mode(initial);
}

template <typename T> std::vector<std::byte> bytes_of(const std::vector<T>& numbers) {
    const auto bytes = std::as_bytes(std::span(numbers));
    return {bytes.begin(), bytes.end()};
}

/// All results of the library for small fits.
std::vector<std::vector<std::byte>> results(const Measured& measured, int threads) {
    std::vector<std::vector<std::byte>> list;
    const Evaluate f = signed_evaluator(measured);
    const auto observations = observe(f, {.count = 4096, .threads = threads});
    list.push_back(bytes_of(observations->f));
    list.push_back(bytes_of(observations->weight));
    const auto fit =
        fit_pm(*observations, {.lobes = 3, .variates = 3, .starts = 3, .perturbations = 4, .threads = threads});
    list.push_back(write_model({fit->model, {}}));
    const auto matrix = tabulate(f, {.directions = 64, .between = 64, .threads = threads});
    const auto su = fit_su(*matrix, {.lobes = 2, .threads = threads});
    list.push_back(write_model({su->model, {}}));
    const auto ggx = Kind<GgxModel>::fit(*observations, {}, {.threads = threads});
    list.push_back(write_model({ggx->model, {}}));
    const Model models[] = {{fit->model, {}}, {su->model, {}}, {ggx->model, {}}};
    for (const Model& model : models) {
        const Evaluate others[] = {evaluator(model)};
        const Measures measures = measure_heldout(rgb_channels(f), rgb_channels(others), {1.5, threads}, 2000)[0];
        list.push_back(bytes_of(std::vector{measures.squared_error_ratio, measures.squared_error_ratio_cosine,
                                            measures.log_rms_cosine, measures.cube_root_error_ratio}));
        const Rgb directional_albedo = albedo(others[0], 0.5, 1.5);
        list.push_back(bytes_of(std::vector{directional_albedo.r, directional_albedo.g, directional_albedo.b}));
    }
    const MixtureProposal proposal = propose(evaluator(models[0]), {.threads = threads});
    for (std::size_t node = 0; node < MixtureProposal::k_nodes; ++node)
        list.push_back(bytes_of(std::vector(proposal.weight(node).begin(), proposal.weight(node).end())));
    list.push_back(bytes_of(to_merl(f, {6, 6, 8}, threads).cells));
    list.push_back({std::byte(is_isotropic(evaluator(measured), 1.4))});
    return list;
}

TEST(CallersMode, HasNoEffectAndIsKept) {
    const Measured& measured = bundled("cc_ibiza_sunset_rgb");
    const auto initial = mode_now();
    const auto expected = results(measured, 1);
    for (const int threads : {1, 2})
        for (const auto mode : k_modes) {
            if (threads == 2 && mode != k_modes[1]) continue;  // threads inherit the mode
            set_mode(mode);
            const auto actual = results(measured, threads);
            const auto after = mode_now();
            set_mode(initial);
            EXPECT_EQ(without_flags(after), without_flags(mode));
            ASSERT_EQ(actual.size(), expected.size());
            for (std::size_t i = 0; i < actual.size(); ++i)
                EXPECT_TRUE(actual[i] == expected[i])
                    << "result " << i << " with " << threads << " threads in mode " << mode;
        }
}

/// A measurement or model of any kind as bytes: a model as its file, a measurement as values at some pairs.
std::string contents_read(const std::filesystem::path& path) {
    std::string read;
    const auto add = [&](const auto& list) {
        read.append(reinterpret_cast<const char*>(std::data(list)), std::size(list) * sizeof *std::data(list));
    };
    if (const auto brdf = load_brdf(path.string())) {
        if (const auto* model = std::get_if<Model>(&*brdf)) add(write_model(*model));
        if (const auto* measured = std::get_if<Measured>(&*brdf))
            for (const std::string& note : notes(*measured)) add(note);
        static const std::vector<Vec3f> wl = fibonacci_directions(400, 1.5), wv(wl.rbegin(), wl.rend());
        std::vector<Rgb> f(wl.size());
        std::visit([&](const auto& brdf_of_kind) { evaluator(brdf_of_kind)(wl, wv, f); }, *brdf);
        add(f);
    } else {
        add(message(brdf.error()));
    }
    const auto bytes = *read_file(path.string());
#ifdef SRBF_RENDER
    if (const auto environment = read_environment(bytes, "f")) add(environment->texels().pixels);
    if (const auto mesh = read_mesh(bytes, "f")) {
        add(mesh->positions);
        add(mesh->normals);
    }
#endif
    if (const auto map = read_map(bytes, "f"))
        for (std::size_t t = 0; t < map->count(); ++t) add(write_model(texel(*map, t)));
    return read;
}

TEST(CallersMode, HasNoEffectOnReadingFiles) {
    const auto initial = mode_now();
    std::size_t files = 0;
    for (const char* folder : {"fuzz/corpus", "test/models", "data"})
        for (const auto& entry :
             std::filesystem::recursive_directory_iterator(std::filesystem::path(SRBF_SOURCE_DIR) / folder)) {
            if (!entry.is_regular_file()) continue;
            ++files;
            const std::string expected = contents_read(entry.path());
            for (const auto mode : k_modes) {
                set_mode(mode);
                const std::string actual = contents_read(entry.path());
                const auto after = mode_now();
                set_mode(initial);
                EXPECT_EQ(without_flags(after), without_flags(mode)) << entry.path();
                EXPECT_TRUE(actual == expected) << entry.path() << " in mode " << mode;
            }
        }
    EXPECT_GT(files, 150u);
}

}  // namespace
}  // namespace srbf::floating_point_test
