// Prepared models for pairs of directions, compared with kernel.glsl in double, for every instruction set of this
// machine.
#include "srbf/prepared.h"

#if defined(__SSE__)
#include <xmmintrin.h>
#endif

#include "brdf/parts.h"
#include "brdf/values.h"
#include "corpus.h"
#include "measured/tables.h"
#include "models.h"
#include "models/ggx/ggx_kind.h"
#include "models/su/su_functions.h"
#include "one_target.h"
#include "sampling/mixture.h"
#include "srbf/fit.h"
#include "srbf/kernel.h"
#include "srbf/load.h"
#include "srbf/metrics.h"
#include "srbf/prepared_bsdf.h"
#include "su_models.h"

namespace srbf::prepared_test {
namespace {

struct Pair {
    Vec3f wl, wv;
};

/// Pairs all over the sphere, and close to the mirror direction.
std::vector<Pair> random_pairs(std::mt19937_64& random, int count) {
    std::vector<Pair> pairs;
    for (int i = 0; i < count; ++i) {
        const Vec3d wl = random_direction(random, i % 5 == 0 ? -0.2 : 0);
        const double offset = std::pow(10, -3 * uniform(random));
        const Vec3d wv =
            i % 2 ? random_direction(random, -0.2) : normalize(mirror(wl) + offset * random_direction(random));
        pairs.push_back({to_float(wl), to_float(wv)});
    }
    return pairs;
}

class Prepared : public testing::Test {
  protected:
    std::mt19937_64 random_{1};
};
class PreparedOn : public Prepared, public testing::WithParamInterface<Target> {
  protected:
    const OneTarget target_{GetParam()};
};
INSTANTIATE_TEST_SUITE_P(EachTarget, PreparedOn, testing::ValuesIn(hwy::SupportedAndGeneratedTargets()),
                         [](const auto& target) { return std::string(hwy::TargetName(target.param)); });

TEST_P(PreparedOn, IsClampedToAvoidSubnormalNumbersAndInfinity) {
    PmModel model = random_model(random_, {.lobes = 1, .variates = 1});
    model.parameterization = {{1, 1}};
    model.coefficient = {{0x1p-24f, 0x1p-60f, 1}};
    for (const auto& [log_scale, expected] : {std::pair(-500.f, 0x1p-100), {500.f, 0x1p100}}) {
        model.log_scale = {log_scale};
        model.bandwidth = {0};
        const Rgb f = value(prepare(Model{model, {}}, CosineProposal{}), {0, 0, 1}, {0, 0, 1});
        EXPECT_WITHIN_RELATIVE(double(f.r), 0x1p-24 * expected, 1e-4);
        EXPECT_EQ(f.g, 0);
        EXPECT_WITHIN_RELATIVE(double(f.b), expected, 1e-4);
    }
}

/// A BRDF or BSDF of each kind and format.
std::vector<AnyBrdf> all_kinds() {
    std::vector<AnyBrdf> list;
    const auto add = [&](const std::filesystem::path& folder) {
        for (const auto& entry : std::filesystem::directory_iterator(folder))
            if (auto brdf = load_brdf(entry.path().string())) list.push_back(*std::move(brdf));
    };
    add(std::filesystem::path(SRBF_SOURCE_DIR) / "test/models/1");
    for (const auto& [target, folder] : corpora())
        if (target == "model" || target == "measured" || folder.string().find("extras") != std::string::npos)
            add(folder);
    return list;
}
/// Pairs with a direction that is not above the horizon. If `two_sided`, that direction is on neither side of the
/// surface.
std::vector<Pair> pairs_without_value(bool two_sided) {
    std::vector<Vec3f> invalid{{NAN, NAN, NAN}, {NAN, 0, 1},      {0, NAN, 1},       {0, 0, NAN},
                               {1, 0, NAN},     {INFINITY, 0, 1}, {0, -INFINITY, 1}, {0, 0, INFINITY},
                               {1, 0, 0},       {1, 0, -0.f},     {1, 0, 1e-40f}};
    if (!two_sided) invalid.push_back({0.6f, 0, -0.8f}), invalid.push_back({1, 0, -1e-40f});
    std::vector<Pair> pairs;
    for (const Vec3f& w : invalid)
        for (const Vec3f& other : {w, Vec3f(0, 0, 1), Vec3f(0.48f, -0.36f, 0.8f)})
            pairs.push_back({w, other}), pairs.push_back({other, w});
    return pairs;
}
struct PairArrays {
    std::vector<Vec3f> wl, wv;
};
PairArrays to_arrays(const std::vector<Pair>& pairs) {
    PairArrays arrays;
    for (const auto& [l, v] : pairs) {
        arrays.wl.push_back(l);
        arrays.wv.push_back(v);
    }
    return arrays;
}

TEST_F(Prepared, EvaluatorsReturnZeroForInvalidDirections) {
    const auto brdfs = all_kinds();
    ASSERT_GT(brdfs.size(), 60u);
    for (std::size_t b = 0; b < brdfs.size(); ++b) {
        const bool two_sided = is_two_sided(brdfs[b]);
        const std::vector<Pair> pairs = pairs_without_value(two_sided);
        const auto [wl, wv] = to_arrays(pairs);
        const auto expect_black = [&](const Evaluate& evaluate, const char* name) {
            std::vector<Rgb> f(wl.size(), Rgb{1, 1, 1});
            evaluate(wl, wv, f);
            EXPECT_EQ(std::ranges::count(f, Rgb()), std::ptrdiff_t(f.size())) << name << " of BRDF " << b;
        };
        const PreparedBsdf sides =
            std::visit([](const auto& brdf) { return PreparedBsdf(prepare(brdf, CosineProposal{})); }, brdfs[b]);
        const PreparedBrdf front =
            std::visit([](const auto& brdf) { return prepare(brdf, CosineProposal{}); }, brdfs[b]);
        std::visit(
            [&](const auto& brdf) {
                expect_black(evaluator(brdf), "arrays");
                for (const auto& [l, v] : pairs) EXPECT_EQ(value(brdf, l, v), Rgb()) << b;
            },
            brdfs[b]);
        for (const auto& [l, v] : pairs) {
            EXPECT_EQ(value(front, l, v), Rgb());
            EXPECT_EQ(pdf(front, l, v), 0);
            if (!above_horizon(v, v)) {
                EXPECT_EQ(sample(front, v, {0.3f, 0.4f}, 0.5f).pdf, 0);
            }
        }
        for (const auto& [l, v] : pairs_without_value(true)) {
            EXPECT_EQ(value(sides, l, v), Rgb());
            EXPECT_EQ(pdf(sides, l, v), 0);
            if (!to_part_frame(v, v)) {
                EXPECT_EQ(sample(sides, v, {0.3f, 0.4f}, 0.5f).pdf, 0);
            }
        }
        expect_black(evaluator(front), "prepared arrays");
        EXPECT_EQ(albedo(front, NAN), Rgb());
        const auto expect_dark = [&](const Channels& channels) {
            std::vector<float> f(channels.count() * wl.size(), 1);
            channels.evaluate(wl, wv, f);
            EXPECT_EQ(std::ranges::count(f, 0.f), std::ptrdiff_t(f.size())) << b;
        };
        if (const auto* measured = std::get_if<Measured>(&brdfs[b])) {
            expect_black(signed_evaluator(*measured), "signed arrays");
            for (const auto& [l, v] : pairs) EXPECT_EQ(signed_value(*measured, l, v), Rgb());
            if (!wavelengths(*measured).empty()) {
                expect_dark(spectra(*measured));
                expect_dark(signed_spectra(*measured));
            }
        } else {
            expect_dark(channels(std::get<Model>(brdfs[b])));
        }
    }
}

TEST_F(Prepared, ProposalsReturnZeroForInvalidDirections) {
    const Model su{isotropic_su(64), {}}, pm{random_model(random_, {}), {}};
    const std::vector<Proposal> proposals{CosineProposal{}, propose(su), propose(pm)};
    for (const Proposal& proposal : proposals)
        for (const auto& [l, v] : pairs_without_value(false)) {
            EXPECT_EQ(pdf(proposal, l, v), 0) << proposal.index();
            if (above_horizon(v, v)) continue;
            EXPECT_EQ(sample(pm, proposal, v, {0.3f, 0.4f}, 0.5f).pdf, 0) << proposal.index();
        }
}

TEST_F(Prepared, ArraysOfDifferentLengthsEndTheProgram) {
    const Vec3f two[] = {{0, 0, 1}, {0, 0, 1}};
    std::size_t kinds = 0;
    for (const AnyBrdf& brdf : all_kinds()) {
        if (++kinds % 8 != 1) continue;  // each takes a process
        const Evaluate f = std::visit([](const auto& value) { return evaluator(value); }, brdf);
        std::vector<Rgb> values(2);
        EXPECT_DEATH(f(two, std::span(two).first(1), values), "arrays of pairs");
        EXPECT_DEATH(f(two, two, std::span(values).first(1)), "arrays of pairs");
    }
    const Evaluate f = [](auto, auto, auto) {};
    std::vector<float> few(5);
    EXPECT_DEATH(rgb_channels(f).evaluate(two, two, few), "arrays of pairs");
}

/// Runs `body` with or without flushing of subnormal numbers by the processor.
template <typename Body> void in_mode(bool flush, const Body& body) {
#if defined(__SSE__)
    constexpr unsigned both = 0x8040;  // flush to zero, denormals are zero
    const unsigned previous = _mm_getcsr();
    _mm_setcsr(flush ? previous | both : previous & ~both);
    body();
    _mm_setcsr(previous);
#else
    (void)flush;
    body();
#endif
}

TEST_P(PreparedOn, ResultsDoNotDependOnTheProcessorMode) {
    // Prepared once for all instruction sets, since preparation does not depend on them.
    static const std::vector<PreparedBrdf> models = [] {
        std::mt19937_64 random(7);
        std::vector<PreparedBrdf> list;
        for (const PmForm form : k_forms)
            for (const bool axial : {true, false})
                for (const int lobes : {5, 12}) {
                    const PmModel model = random_model(random, {axial, true, lobes, 4, k_half_max, form});
                    list.push_back(prepare({model, {}}, {.azimuths = axial ? 1 : 4}));
                }
        list.push_back(prepare(Model{random_su(random, 64, 5), {}}));
        list.push_back(prepare(Model{GgxModel{{0.1f, 0.2f, 0.3f}, {{k_min_roughness, {1, 0.9f, 0.8f}, 1}}}, {}}));
        return list;
    }();
    std::vector<Pair> pairs = random_pairs(random_, 2000);
    for (std::size_t i = 0; i < pairs.size(); i += 4) {  // exactly or nearly along the axes
        pairs[i].wl = {i % 8 ? 0 : 1e-25f, 1e-40f, 1};
        if (i % 16 == 0) pairs[i].wv = {1, 1e-30f, 1e-38f};
    }
    for (const PreparedBrdf& model : models) {
        std::vector<Rgb> f[2];
        std::vector<Vec3f> wl[2];
        std::vector<float> density[2];
        for (const int flush : {0, 1})
            in_mode(flush != 0, [&] {
                std::mt19937_64 random(3);
                for (const auto& [l, v] : pairs) {
                    f[flush].push_back(value(model, l, v));
                    density[flush].push_back(pdf(model, l, v));
                    const float a = float(uniform(random)), b = float(uniform(random)), c = float(uniform(random));
                    if (v.z > 0.01f) wl[flush].push_back(sample(proposal(model), v, {a, b}, c));
                }
            });
        EXPECT_EQ(f[0], f[1]);
        EXPECT_EQ(density[0], density[1]);
        EXPECT_TRUE(wl[0] == wl[1]);
    }
}

void expect_integral(const Evaluate& f, const PreparedBrdf& prepared) {
    for (const double cosine : {1.0, 0.9999, 0.94, 0.7, 0.5, 0.26, 0.1, 0.05, 0.02, 0.012, 0.007, 0.003, 0.0015}) {
        const Rgb expected = albedo(f, std::acos(cosine), k_pi / 2), prepared_albedo = albedo(prepared, float(cosine));
        for (int c = 0; c < 3; ++c)
            EXPECT_WITHIN(prepared_albedo[c], expected[c], std::max(0.01 * double(expected[c]), 0.002)) << cosine;
    }
}

TEST_P(PreparedOn, AlbedoIsTheIntegral) {
    const PmModel pm = random_model(random_, {.lobes = 6, .form = PmForm::extended});
    const PreparedBrdf brdf = prepare(Model{pm, {}}, CosineProposal{});
    expect_integral(evaluator(pm), brdf);
    const PreparedBrdf grey = diffuse({0.5f, 0.25f, 1});
    for (const float z : {1.f, 0.7f, 0.1f, 1e-3f}) {
        EXPECT_WITHIN(albedo(grey, z).r, 0.5, 2e-3) << z;
        EXPECT_WITHIN(albedo(grey, z).b, 1, 4e-3) << z;
    }
    EXPECT_EQ(albedo(grey, 0), Rgb{});
    EXPECT_EQ(albedo(grey, NAN), Rgb{});
}

/// The albedos of a film and of white paper change rapidly at grazing angles.
TEST_F(Prepared, AlbedoOfFitsIsTheIntegral) {
    for (const char* const name : {"cc_ibiza_sunset_rgb.bsdf", "paper_white_rgb.bsdf"}) {
        SCOPED_TRACE(name);
        Measured measured = *load_measured((bundled_data() / name).string());
        const auto fitted = checked(Fitter(measured).fit({PmRequest{.size = LobeCount{3}, .effort = 0.1}}));
        expect_integral(evaluator(fitted->model), prepare(fitted->model, CosineProposal{}));
        exchange(measured);  // whose light depends on the azimuth even along the normal
        expect_integral(evaluator(measured), prepare(measured, CosineProposal{}));
    }
}

TEST_F(Prepared, AlbedoOfViewsIsTheIntegral) {
    constexpr int k_points = 40000;
    const std::vector<Vec3f> wl = fibonacci_directions(k_points, k_pi / 2);
    const SuModel model = random_su(random_, 96, 4);
    const PreparedBrdf prepared = prepare(Model{model, {}}, CosineProposal{});
    for (const double theta : {3.0, 40.0, 75.0, 83.7, 86.3, 88.9, 89.5}) {
        const std::vector<Vec3f> wv(wl.size(), to_float(spherical(theta * k_degree, 0.7)));
        std::vector<Rgb> f(wl.size());
        evaluate(model, wl, wv, f);
        double integral = 0;
        for (std::size_t i = 0; i < wl.size(); ++i) integral += double(f[i].g * wl[i].z) * 2 * k_pi / k_points;
        EXPECT_WITHIN(albedo(prepared, wv[0].z).g, integral, 0.01 * integral) << theta;
    }
}

TEST_F(Prepared, ABrdfOfAnyTypeIsOwned) {
    std::vector<PreparedBrdf> owners;
    {
        Measured measured = *load_measured((bundled_data() / "paper_white_rgb.bsdf").string());
        owners.push_back(prepare(measured, ProposeOptions{}));
        owners.push_back(prepare(measured, CosineProposal{}));
        owners.push_back(prepare(std::move(measured)));
    }
    const Measured reference = *load_measured((bundled_data() / "paper_white_rgb.bsdf").string());
    for (const PreparedBrdf& brdf : owners) {
        double mean = 0;
        for (const auto& [l, v] : random_pairs(random_, 200)) EXPECT_EQ(value(brdf, l, v), value(reference, l, v));
        const Vec3f wv = to_float(spherical(0.5, 0.0));
        for (int i = 0; i < 4000; ++i) {
            const Vec3f u = uniform_point(random_);
            mean += double(sample(brdf, wv, {u.x, u.y}, u.z).weight.g) / 4000;
        }
        EXPECT_WITHIN(mean, albedo(brdf, wv.z).g, 0.03);
    }
}

TEST_P(PreparedOn, BatchesAgreeWithTheModel) {
    for (const bool axial : {true, false}) {
        const PmModel model = random_model(random_, {.axial = axial, .lobes = 11, .form = PmForm::extended});
        const auto [wl, wv] = to_arrays(random_pairs(random_, 100));
        std::vector<Rgb> model_values(wl.size()), prepared_values(wl.size());
        evaluate(model, wl, wv, model_values);
        evaluator(prepare(Model{model, {}}, CosineProposal{}))(wl, wv, prepared_values);
        EXPECT_EQ(model_values, prepared_values);
    }
}

TEST_F(Prepared, CopiesOutliveTheirSources) {
    for (const int kind : {0, 1, 2}) {
        auto source = std::make_unique<Model>();
        if (kind == 0) source->model = random_model(random_, {.lobes = 9, .form = PmForm::extended});
        if (kind == 1) source->model = random_su(random_, 64, 3);
        if (kind == 2) source->model = GgxModel{{0.1f, 0.2f, 0.3f}, {{0.2f, {1, 0.9f, 0.8f}, 1}}};
        const Model reference = *source;
        const Proposal proposal = propose(reference);
        std::optional<PreparedBrdf> first = prepare(*source);
        source.reset();
        PreparedBrdf copy = *first;
        const PreparedBrdf moved = std::move(*first);
        first.reset();
        const PreparedBrdf last = std::move(copy);
        for (const PreparedBrdf& model : {moved, last, copy})  // a move is a copy
            for (const auto& [l, v] : random_pairs(random_, 200)) {
                const Rgb f = value(model, l, v), expected = value(reference, l, v);
                EXPECT_RGB_WITHIN_RELATIVE(f, expected, 1e-4, 1e-6);
                EXPECT_EQ(pdf(model, l, v), pdf(proposal, l, v));
                const ValuePdf both = value_pdf(model, l, v);
                EXPECT_EQ(both.value, f);
                EXPECT_EQ(both.pdf, pdf(model, l, v));
                if (!(v.z > 0)) continue;
                const Vec3f u = uniform_point(random_);
                const LightSample prepared_sample = sample(model, v, {u.x, u.y}, u.z),
                                  reference_sample = sample(reference, proposal, v, {u.x, u.y}, u.z);
                EXPECT_EQ(prepared_sample.pdf, reference_sample.pdf);
                EXPECT_TRUE(prepared_sample.wl == reference_sample.wl);
                EXPECT_WITHIN(prepared_sample.weight.g, reference_sample.weight.g,
                              1e-4 * reference_sample.weight.g + 1e-6);
            }
    }
}

/// An anisotropic model that srbf.h prepares samples as `k_anisotropic_azimuths` do for any number of threads, and so
/// does the exchanged one.
TEST_F(Prepared, LoadedBrdfsAreExchangedAndHaveTheirAzimuths) {
    const Model model{random_model(random_, {.axial = false, .lobes = 4, .form = PmForm::extended}), {}};
    ASSERT_FALSE(is_isotropic(model));
    const LoadedBrdf loaded = loaded_brdf(model);
    const PreparedBrdf whole = prepare(loaded, 1), other = prepare(exchanged(loaded)),
                       by_azimuths = prepare(model, {.azimuths = k_anisotropic_azimuths});
    for (const auto& [l, v] : random_pairs(random_, 100)) {
        EXPECT_EQ(pdf(whole, l, v), pdf(by_azimuths, l, v));
        const Rgb f = value(whole, l, v), exchanged_f = value(other, v, l);
        EXPECT_RGB_WITHIN_RELATIVE(exchanged_f, f, 1e-4, 1e-6);
    }
}

/// Prepared BRDFs without content, as members of a caller's struct before they are assigned.
struct Material {
    LoadedBrdf loaded;
    PreparedBrdf prepared;
};
static_assert(std::is_nothrow_default_constructible_v<Material> && std::is_nothrow_move_constructible_v<Material>);

TEST_F(Prepared, IsBlackByDefault) {
    Material material;
    const PreparedBrdf copy = material.prepared;
    for (const PreparedBrdf& black : {material.prepared, copy, PreparedBrdf(std::move(material.prepared))}) {
        for (const auto& [l, v] : random_pairs(random_, 2000)) {
            EXPECT_EQ(value(black, l, v), Rgb());
            EXPECT_EQ(pdf(black, l, v), 0);
            EXPECT_EQ(value_pdf(black, l, v).pdf, 0);
            const Vec3f u = uniform_point(random_);
            const LightSample light = sample(black, v, {u.x, u.y}, u.z);
            EXPECT_EQ(light.pdf, 0);
            EXPECT_EQ(light.weight, Rgb());
        }
        for (const float z : {1.f, 0.3f, 1e-4f}) EXPECT_EQ(albedo(black, z), Rgb());
        const std::vector<Vec3f> up(3, {0, 0, 1});
        std::vector<Rgb> f(3, {1, 1, 1});
        evaluate(black, up, up, f);
        EXPECT_EQ(f, std::vector<Rgb>(3));
        EXPECT_DEATH(evaluate(black, up, up, std::span(f).first(1)), "arrays of pairs");
    }
    material.prepared = diffuse({0.5f, 0.5f, 0.5f});
    EXPECT_GT(value(material.prepared, {0, 0, 1}, {0, 0, 1}).g, 0);
    EXPECT_EQ(value(copy, {0, 0, 1}, {0, 0, 1}), Rgb());
}

TEST_F(Prepared, ALoadedBrdfWithoutContentIsAMisuse) {
    const Material material, copy = material;
    const std::string misuse = "a LoadedBrdf without content";
    EXPECT_DEATH(content(copy.loaded), misuse);
    EXPECT_DEATH(prepare(copy.loaded), misuse);
    EXPECT_DEATH(exchanged(copy.loaded), misuse);
    EXPECT_DEATH((void)fit(copy.loaded), misuse);
    EXPECT_DEATH((void)save(copy.loaded, "nothing.srbf"), misuse);
    EXPECT_DEATH((void)shading_code(copy.loaded, "nothing", "glsl"), misuse);
}

/// A mixture with random weights, a third of them 0, and its density computed by kernel.glsl in double.
MixtureProposal random_mixture(std::mt19937_64& random, bool is_grain) {
    MixtureProposal proposal;
    if (is_grain) {
        proposal.cosine = 0.6f;
        proposal.sine = 0.8f;
    }
    for (std::size_t node = 0; node < MixtureProposal::k_nodes; ++node) {
        std::array<float, MixtureProposal::k_lobes> row;
        float sum = 0;
        for (std::size_t k = 0; k < row.size(); ++k) {
            row[k] = k > 0 && uniform(random) < 0.33 ? 0 : float(uniform(random));
            sum += row[k];
        }
        for (float& w : row) w /= sum;
        proposal.set_weights(node, row);
        proposal.shape[node] = {is_grain ? 4 : 0.3f + float(uniform(random)), 0.5f + 3 * float(uniform(random))};
    }
    return proposal;
}
std::array<double, MixtureProposal::k_lobes + k_shape_numbers> numbers_at(const MixtureProposal& proposal, double z) {
    const double position = (1 - std::sqrt(std::sqrt(z))) / 0.9 * (MixtureProposal::k_nodes - 1);
    const int lower = std::min(int(position), MixtureProposal::k_nodes - 2);
    std::array<double, MixtureProposal::k_lobes + k_shape_numbers> numbers;
    for (std::size_t k = 0; k < numbers.size(); ++k)
        numbers[k] = (1 - position + lower) * double(node_numbers(proposal, std::size_t(lower), false)[k]) +
                     (position - lower) * double(node_numbers(proposal, std::size_t(lower + 1), false)[k]);
    return numbers;
}

TEST_P(PreparedOn, DensityAndSamplesAgreeWithTheKernel) {
    using D = Kernel<double>;
    for (const bool is_grain : {false, true})
        for (int i = 0; i < 4; ++i) {
            const MixtureProposal proposal = random_mixture(random_, is_grain);
            int different = 0;
            for (int n = 0; n < 2000; ++n) {
                const Vec3f wv = to_float(random_direction(random_, 0.02)), u = uniform_point(random_);
                const Vec3d v = to_double(wv);
                const auto weight = numbers_at(proposal, double(wv.z));
                const double stretch = weight[MixtureProposal::k_lobes], power = weight[MixtureProposal::k_lobes + 1];
                const auto map = D::stretch_along(is_grain ? Vec3d(0.6, 0.8, 0) : v, stretch);
                double remaining = double(u.z);
                int k = 0;
                while (k + 1 < MixtureProposal::k_lobes && remaining >= weight[std::size_t(k)])
                    remaining -= weight[std::size_t(k++)];
                const Vec3f wl = sample(proposal, wv, {u.x, u.y}, u.z);
                const Vec3d expected = D::sample_proposal_lobe(k, v, map, power, double(u.x), double(u.y));
                const Vec3d difference = to_double(wl) - expected;
                different += !near(std::sqrt(dot(difference, difference)), 0, 2e-3);
                const DirectionSample sample_and_pdf = sample_with_pdf(proposal, wv, {u.x, u.y}, u.z);
                EXPECT_TRUE(sample_and_pdf.wl == wl);
                EXPECT_EQ(sample_and_pdf.pdf, pdf(proposal, wl, wv));
                if (!(wl.z > 0)) continue;
                double density = 0;
                for (int j = 0; j < MixtureProposal::k_lobes; ++j)
                    density += weight[std::size_t(j)] *
                               D::proposal_lobe_pdf(j, D::proposal_point(to_double(wl), v, map, power));
                EXPECT_WITHIN_RELATIVE(double(pdf(proposal, wl, wv)), density, 2e-3) << n << ' ' << k;
            }
            EXPECT_LE(different, 2);  // where rounding selects another lobe
        }
}

/// The bundled fits and tables, and models with other proposals, prepared once for all instruction sets.
const std::vector<PreparedBrdf>& prepared_files() {
    static const std::vector<PreparedBrdf> list = [] {
        const auto models = std::filesystem::path(SRBF_SOURCE_DIR) / "test/models/1";
        std::vector<std::filesystem::path> files{models / "su_rotated.srbf", models / "pm_horizon_axial.srbf",
                                                 models / "ggx_two.srbf", models / "openpbr_brushed.srbf"};
        for (const auto& folder : {bundled_data(), bundled_data() / "gallery"})
            for (const auto& entry : std::filesystem::directory_iterator(folder))
                if (const auto end = entry.path().extension(); end == ".srbf" || end == ".bsdf")
                    files.push_back(entry.path());
        std::vector<PreparedBrdf> prepared;
        for (const auto& file : files) prepared.push_back(prepare(*load(file.string())));
        return prepared;
    }();
    return list;
}

TEST_P(PreparedOn, SamplesAndDensityAgree) {
    // A sample has the density of its direction in every bit, and up to two roundings the weight.
    std::array<int, std::variant_size_v<Proposal>> directions{};
    for (const PreparedBrdf& brdf : prepared_files())
        for (int i = 0; i < 1000; ++i) {
            const Vec3f wv = to_float(random_direction(random_, 0)), u = uniform_point(random_);
            const LightSample light = sample(brdf, wv, {u.x, u.y}, u.z);
            if (!(light.pdf > 0)) continue;
            ++directions[proposal(brdf).index()];
            EXPECT_EQ(light.pdf, pdf(brdf, light.wl, wv));
            const Rgb f = value(brdf, light.wl, wv);
            for (int c = 0; c < 3; ++c)
                EXPECT_WITHIN_RELATIVE(double(light.weight[c]), double(f[c]) * double(light.wl.z) / double(light.pdf),
                                       1.2e-7);
        }
    for (std::size_t kind = 1; kind < directions.size(); ++kind) EXPECT_GT(directions[kind], 900) << kind;
}

}  // namespace
}  // namespace srbf::prepared_test
