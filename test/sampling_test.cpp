// Importance sampling: densities integrate to one, samples follow them, and their weights estimate albedos.
#include "srbf/sampling.h"
#include "sampling/mixture.h"

#include <fmt/format.h>

#include <map>

#include "brdf_functions.h"
#include "models.h"
#include "models/ggx/ggx_kind.h"
#include "models/pm/search/fit_pm.h"
#include "models/su/fit_su.h"
#include "models/su/su_functions.h"
#include "srbf/kernel.h"
#include "srbf/measured.h"
#include "srbf/metrics.h"
#include "statistics.h"
#include "su_models.h"

namespace srbf::sampling_test {
namespace {

constexpr double k_thetas[] = {0, 30, 60, 80};
constexpr int k_samples = 20000;  // of a statistical test

std::array<float, MixtureProposal::k_lobes> weights_of(const MixtureProposal& proposal, std::size_t node) {
    std::array<float, MixtureProposal::k_lobes> weight;
    std::copy_n(proposal.weight(node).begin(), weight.size(), weight.begin());
    return weight;
}

// Samples from a 3-vector of uniform numbers: a point and a selector.
template <typename P> Vec3f sample(const P& proposal, Vec3f wv, Vec3f u) {
    return sample(proposal, wv, Vec2f{u.x, u.y}, u.z);
}
template <Brdf B, typename P> LightSample sample(const B& brdf, const P& proposal, Vec3f wv, Vec3f u) {
    return sample(brdf, proposal, wv, Vec2f{u.x, u.y}, u.z);
}

/// A measured material with quick fits, and a proposal for each of the three BRDFs.
struct Material {
    std::string name;
    Measured measured;
    PmModel pm;
    SuModel su;
    MixtureProposal table_proposal, pm_proposal;
    ViewProposal su_proposal;
    CosineProposal cosine;
};

/// Calls visit(name, brdf, proposal) for each pair of a BRDF and a proposal.
template <typename Visit> void for_each_pairing(const Material& material, const Visit& visit) {
    visit(material.name + " PM", evaluator(material.pm), Proposal(material.pm_proposal));
    visit(material.name + " SU", evaluator(material.su), Proposal(material.su_proposal));
    visit(material.name + " table", evaluator(material.measured), Proposal(material.table_proposal));
    visit(material.name + " table with the proposal of PM", evaluator(material.measured),
          Proposal(material.pm_proposal));
}

std::vector<std::filesystem::path> measurements() {
    std::map<std::string, std::filesystem::path> files;
    for (const auto& folder : {bundled_data(), shared_data() / "rgl", shared_data() / "cornell"})
        if (std::filesystem::exists(folder))
            for (const auto& entry : std::filesystem::directory_iterator(folder))
                if (const auto extension = entry.path().extension(); extension == ".bsdf" || extension == ".brdf")
                    files.emplace(entry.path().stem().string(), entry.path());
    std::vector<std::filesystem::path> paths;
    for (const auto& [name, path] : files) paths.push_back(path);
    return paths;
}

const std::vector<std::unique_ptr<Material>>& materials() {
    static const auto list = [] {
        std::vector<std::unique_ptr<Material>> materials_list;
        for (const auto& path : measurements()) {
            auto material = std::make_unique<Material>();
            material->name = path.stem().string();
            material->measured = *load_measured(path.string());
            const auto observations =
                observe(signed_evaluator(material->measured), {.objective = Objective::cosine, .count = 8192});
            const auto pm = fit_pm(*observations, {.lobes = 5, .variates = 3, .starts = 2, .perturbations = 0});
            const auto matrix = tabulate(signed_evaluator(material->measured), {.directions = 128, .between = 256});
            const auto su = fit_su(*matrix, {.lobes = 4});
            EXPECT_TRUE(pm.ok() && su.ok()) << path;
            material->pm = pm->model;
            material->su = su->model;
            material->pm_proposal = propose(evaluator(material->pm));
            material->su_proposal = propose(material->su);
            material->table_proposal = propose(evaluator(material->measured));
            materials_list.push_back(std::move(material));
        }
        return materials_list;
    }();
    return list;
}

class Sampling : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        if (materials().size() < 8) std::puts("Only the bundled measurements: set SRBF_DATA for more of them.");
    }
    std::mt19937_64 random{5};
};

/// The density of the half vector h between wl and wv if wl has the density of the proposal.
double half_vector_density(const Proposal& proposal, Vec3d h, Vec3f wv) {
    const double cosine = dot(h, to_double(wv));
    if (cosine <= 0) return 0;
    return 4 * cosine * double(pdf(proposal, to_float(2 * cosine * h - to_double(wv)), wv));
}
Vec3d half_vector(Vec3f wl, Vec3f wv) { return normalize(to_double(wl) + to_double(wv)); }

struct SampledFractions {
    double integral;  ///< of the density
    double lost;      ///< samples below the horizon
};
/// Expects that samples of the proposal, with those that are lost, follow its density.
SampledFractions expect_samples_follow(const Proposal& proposal, Vec3f wv, std::mt19937_64& random, double significance,
                                       int steps = 32) {
    const PolarBins bins = half_vector_bins();
    const auto density = [&](Vec3d h) { return half_vector_density(proposal, h, wv); };
    std::vector<double> expected = bins.integrals(density, steps), observed(bins.size() + 1);
    for (int i = 0; i < k_samples; ++i) {
        const Vec3f wl = sample(proposal, wv, uniform_point(random));
        observed[wl.z > 0 ? bins.index(half_vector(wl, wv)) : bins.size()] += 1;
    }
    const double integral = sum_of(expected);
    for (double& mass : expected) mass *= k_samples;
    expected.push_back(k_samples * std::max(0.0, 1 - integral));
    EXPECT_GT(chi2_p_value(observed, expected), significance);
    return {integral, observed.back() / k_samples};
}

/// The relative variance of f cosθl / pdf at θv [degrees].
double variance(const Evaluate& brdf, const Proposal& proposal, double theta) {
    const Vec3f wv = to_float(spherical(theta * k_degree, 0.0));
    const Quadrature points = MirrorMixture(k_pi / 2).quadrature(to_double(wv), 30000);
    std::vector<Rgb> f(points.w.size());
    brdf(points.w, std::vector<Vec3f>(f.size(), wv), f);
    double mean = 0, second_moment = 0;
    for (std::size_t i = 0; i < f.size(); ++i) {
        const double g = is_finite(f[i]) ? luminance(f[i]) * double(points.w[i].z) : 0;
        mean += points.weight[i] * g;
        if (g > 0) second_moment += points.weight[i] * g * g / double(pdf(proposal, points.w[i], wv));
    }
    return second_moment / (mean * mean) - 1;
}

/// Surfaces of facets: two rough lobes, and brushed metal under a coat.
std::vector<Model> surfaces() {
    OpenPbrModel brushed;
    brushed.base_metalness = 1;
    brushed.specular_roughness = 0.5f;
    brushed.specular_roughness_anisotropy = 0.7f;
    brushed.specular_rotation = 0.1f;
    brushed.coat_weight = 1;
    brushed.coat_roughness = 0.4f;
    return {{GgxModel{{0.1f, 0.2f, 0.3f}, {{0.1f, {0.04f, 0.04f, 0.04f}, 1}, {0.6f, {0.5f, 0.5f, 0.5f}, 1}}}, {}},
            {brushed, {}}};
}

TEST_F(Sampling, SamplesFollowDensitiesThatIntegrateToOne) {
    const int tests = (int(materials().size()) * 5 + int(surfaces().size())) * int(std::size(k_thetas));
    const double significance = sidak(0.01, tests);
    const auto check = [&](const std::string& name, const Evaluate&, const Proposal& proposal) {
        for (const double theta : k_thetas) {
            SCOPED_TRACE(fmt::format("{} {}", name, theta));
            const Vec3f wv = to_float(spherical(theta * k_degree, 0.7));
            const auto [integral, lost] = expect_samples_follow(proposal, wv, random, significance);
            // The fraction of samples that are lost has its own statistical error. For most it is 0.
            EXPECT_WITHIN(integral + lost, 1, 1e-3 + 4 * std::sqrt(lost / k_samples));
        }
    };
    for (const auto& material : materials()) {
        for_each_pairing(*material, check);
        check(material->name + " cosine", evaluator(material->measured), material->cosine);
    }
    for (const Model& surface : surfaces()) check("facets", evaluator(surface), propose(surface));
}

/// Weights are bounded down to views a hundredth of a degree above the horizon, also for the narrowest facets.
TEST_F(Sampling, WeightsOfFacetsAreBounded) {
    std::vector<Model> models = surfaces();
    for (const float roughness : {0.002f, 0.02f, 0.1f, 0.5f, 1.f})
        for (const float diffuse : {0.f, 0.3f})
            models.push_back({GgxModel{{diffuse, diffuse, diffuse}, {{roughness, {0.04f, 0.04f, 0.04f}, 1}}}, {}});
    constexpr int views = 25, count = 4000;
    for (std::size_t m = 0; m < models.size(); ++m) {
        const Proposal proposal = propose(models[m]);
        for (int i = 0; i < views; ++i) {
            const Vec3f wv = to_float(spherical(std::acos(std::pow(1e-4, i / (views - 1.0))), 0.7 + i));
            Moments weights;
            for (int n = 0; n < count; ++n)
                weights.add(luminance(sample(models[m], proposal, wv, uniform_point(random)).weight));
            EXPECT_LT(weights.largest, 10) << m << ' ' << wv.z;
            EXPECT_LT(weights.relative_variance(), 0.3) << m << ' ' << wv.z;
        }
    }
}

TEST_F(Sampling, TestDetectsSamplesOfAnotherProposal) {
    const Material& material = *materials()[0];
    const PolarBins bins = half_vector_bins();
    MixtureProposal other = material.pm_proposal;
    for (std::size_t node = 0; node < MixtureProposal::k_nodes; ++node) {
        auto weight = weights_of(other, node);
        weight[0] += 0.1f;
        *std::max_element(weight.begin() + 1, weight.end()) -= 0.1f;
        other.set_weights(node, weight);
    }
    const Vec3f wv = to_float(spherical(30 * k_degree, 0.7));
    const auto density = [&](Vec3d h) { return half_vector_density(other, h, wv); };
    const auto sample_half_vector = [&] {
        return half_vector(sample(material.pm_proposal, wv, uniform_point(random)), wv);
    };
    EXPECT_LT(sampler_p_value(bins, density, k_samples, sample_half_vector), 1e-6);
}

TEST_F(Sampling, MeanWeightIsTheAlbedo) {
    const int tests = int(materials().size()) * 4 * int(std::size(k_thetas));
    const double significance = sidak(0.01, tests);
    for (const auto& material : materials())
        for_each_pairing(*material, [&](const std::string& name, const Evaluate& brdf, const Proposal& proposal) {
            for (const double theta : k_thetas) {
                const Vec3f wv = to_float(spherical(theta * k_degree, 0.0));
                std::vector<Vec3f> wl;
                std::vector<float> scale;
                for (int i = 0; i < k_samples; ++i) {
                    const Vec3f w = sample(proposal, wv, uniform_point(random));
                    if (!(w.z > 0)) continue;
                    wl.push_back(w);
                    scale.push_back(w.z / pdf(proposal, w, wv));
                }
                const std::vector<Rgb> f = values_towards(brdf, wl, wv);
                Moments weights;
                for (std::size_t i = 0; i < f.size(); ++i)
                    weights.add(is_finite(f[i]) ? double(scale[i]) * luminance(f[i]) : 0);
                weights.count = k_samples;  // a lost sample weighs 0
                const double mean = weights.mean(), deviation = weights.deviation_of_mean();
                const double expected = luminance(albedo(brdf, theta * k_degree, k_pi / 2));
                // The quadrature has an error of 1e-4, and more where a measurement has an edge.
                const double deviations = std::max(0.0, std::abs(mean - expected) - 3e-4 * expected) / deviation;
                EXPECT_GT(std::erfc(deviations / std::sqrt(2.0)), significance)
                    << name << ' ' << theta << ": " << mean << " +- " << deviation << ", expected " << expected;
            }
        });
}

TEST_F(Sampling, FewSamplesAreLostForAnyView) {
    for (const auto& material : materials())
        for (const MixtureProposal* proposal : {&material->table_proposal, &material->pm_proposal})
            for (const double theta : {0.0, 30.0, 60.0, 80.0, 87.0, 88.5, 89.4, 89.9}) {
                const Vec3f wv = to_float(spherical(theta * k_degree, 0.7));
                int lost = 0;
                for (int i = 0; i < k_samples; ++i) lost += !(sample(*proposal, wv, uniform_point(random)).z > 0);
                EXPECT_LT(lost, 0.015 * k_samples) << material->name << ' ' << theta;
            }
}

/// Measurements with few views have highlights at each view. A mixture has no nodes for them.
TEST_F(Sampling, CoversHighlightsBetweenMeasuredViews) {
    constexpr double step = 5 * k_degree, width = 1.5 * k_degree;
    const Evaluate coarse = pairwise([](Vec3f wl, Vec3f wv) {
        const Vec3d l = to_double(wl), v = to_double(wv);
        const double theta = std::acos(v.z), lower = std::floor(theta / step), fraction = theta / step - lower;
        double sum = 0.1;
        for (const auto& [view_index, weight] : {std::pair(lower, 1 - fraction), {lower + 1, fraction}}) {
            const Vec3d mirror = spherical(view_index * step, std::atan2(-v.y, -v.x));
            sum += 200 * weight * std::exp(std::min((dot(l, mirror) - 1) / (width * width), 0.0));
        }
        return grey(sum);
    });
    const MixtureProposal proposal = propose(coarse);
    for (double theta = 1; theta < 85; theta += 1.5) EXPECT_LT(variance(coarse, proposal, theta), 1) << theta;
}

TEST_F(Sampling, VarianceIsSmall) {
    for (const auto& material : materials()) {
        const bool is_rgl = material->measured.format == "RGL";
        for_each_pairing(*material, [&](const std::string& name, const Evaluate& brdf, const Proposal& proposal) {
            EXPECT_LT(variance(brdf, proposal, 45), is_rgl ? 0.15 : 0.3) << name;
        });
        // Grazing views have tighter bounds.
        if (!is_rgl) continue;
        for (const auto& [theta, bound] : {std::pair(60.0, 0.05), {75.0, 0.07}, {85.0, 0.15}}) {
            EXPECT_LT(variance(evaluator(material->measured), material->table_proposal, theta), bound)
                << material->name << " table " << theta;
            EXPECT_LT(variance(evaluator(material->pm), material->pm_proposal, theta), bound)
                << material->name << " PM " << theta;
        }
    }
}

/// The density of lights that facets from a lobe of half vectors reflect, those below the horizon too.
double half_vector_pdf(Vec3d wl, Vec3d wv, const Kernel<double>::ProposalLobe& lobe,
                       const Kernel<double>::Stretch& map) {
    const auto h = Kernel<double>::half_vector(wl, wv, map);
    return lobe.scale * Kernel<double>::gaussian(h.direction, lobe.centre, lobe.bandwidth) * h.factor;
}

TEST_F(Sampling, JacobianOfEachWarpTimesItsDensityIsOne) {
    using D = Kernel<double>;
    constexpr double h = 1e-6;
    const auto check = [&](const auto& warp, const auto& density, const std::string& name) {
        const double u1 = 0.01 + 0.98 * uniform(random), u2 = 0.01 + 0.98 * uniform(random);
        const Vec3d w = warp(u1, u2);
        if (dot(w, w) < 0.5) return;
        const Vec3d derivative1 = (0.5 / h) * (warp(u1 + h, u2) - warp(u1 - h, u2)),
                    derivative2 = (0.5 / h) * (warp(u1, u2 + h) - warp(u1, u2 - h)),
                    area = cross(derivative1, derivative2);
        EXPECT_WITHIN(std::sqrt(dot(area, area)) * density(w), 1, 2e-4) << name << ' ' << u1 << ' ' << u2;
        EXPECT_WITHIN(dot(w, w), 1, 1e-12) << name;
    };
    for (int i = 0; i < 300; ++i) {
        const Vec3d wv = random_direction(random, 0.02);
        const double power = 3 * uniform(random);
        const auto map = D::stretch_along(i % 3 ? wv : random_direction(random), i % 2 ? 1 : 0.2 + 8 * uniform(random));
        check([&](double u1, double u2) { return D::sample_cosine(u1, u2); }, [&](Vec3d w) { return D::cosine_pdf(w); },
              "cosine");
        for (int k = 0; k < 2; ++k)
            check([&](double u1, double u2) { return D::sample_proposal_lobe(k, wv, map, power, u1, u2); },
                  [&](Vec3d w) { return D::proposal_lobe_pdf(k, D::proposal_point(w, wv, map, power)); },
                  "power of the cosine " + std::to_string(k + 1));
        const auto facets =
            D::facets_along(0.6, 0.8, i % 2 ? 0.5 : 0.01 + 0.9 * uniform(random), 0.01 + 0.9 * uniform(random));
        check([&](double u1, double u2) { return D::sample_visible_normals(wv, facets, u1, u2); },
              [&](Vec3d w) { return D::visible_normals_pdf(w, wv, facets); }, "facets");
        for (int k = SRBF_FIRST_HALF_VECTOR_LOBE; k < SRBF_PROPOSAL_LOBES; ++k) {
            const auto lobe = D::half_vector_lobe(D::stretched(wv, map), map.inverse, D::proposal_bandwidth(k), power);
            const auto facet = [&](double u1, double u2) {
                return D::stretched(D::sample_sharp_vmf(lobe.centre, lobe.width, lobe.rest, u1, u2), map);
            };
            check([&](double u1, double u2) { return D::light_of(facet(u1, u2), wv); },
                  [&](Vec3d w) { return half_vector_pdf(w, wv, lobe, map); }, "half-vector " + std::to_string(k));
        }
    }
}

TEST_F(Sampling, LobesAreMirroredAtTheHorizon) {
    using D = Kernel<double>;
    for (int i = 0; i < 1000; ++i) {
        const Vec3d wv = random_direction(random, 0.02), specular(-wv.x, -wv.y, wv.z);
        const int k = 2 + i % (SRBF_PROPOSAL_LOBES - 2);
        const auto map = D::stretch_along(wv, i % 2 ? 0.4 : 3.0);
        const Vec3d wl = D::sample_proposal_lobe(k, wv, map, 2.0, uniform(random), uniform(random));
        EXPECT_GE(wl.z, 0);
        if (!(wl.z > 0)) continue;
        const auto unmirrored = [&](Vec3d w) {
            const double bandwidth = D::proposal_bandwidth(k);
            if (k < SRBF_FIRST_HALF_VECTOR_LOBE) return D::vmf_pdf(w, specular, bandwidth);
            return half_vector_pdf(w, wv, D::half_vector_lobe(D::stretched(wv, map), map.inverse, bandwidth, 2.0), map);
        };
        EXPECT_WITHIN_RELATIVE(D::proposal_lobe_pdf(k, D::proposal_point(wl, wv, map, 2.0)),
                               unmirrored(wl) + unmirrored({wl.x, wl.y, -wl.z}), 2e-7);
    }
}

/// A brushed conductor: Trowbridge-Reitz with roughness `along` an azimuth of 40° and `across` it.
struct Brushed {
    double along = 0.3, across = 0.06;
};
Rgb value(const Brushed& surface, Vec3f wl, Vec3f wv) {
    if (!(wl.z > 0 && wv.z > 0)) return {};
    const auto rotated = [](Vec3f w) { return Kernel<double>::turned(to_double(w), std::cos(0.7), -std::sin(0.7)); };
    const Vec3d l = rotated(wl), v = rotated(wv), h = normalize(l + v);
    const auto square = [](double x) { return x * x; };
    const double a = surface.along, b = surface.across;
    const auto stretched = [&](Vec3d w) { return square(a * w.x) + square(b * w.y); };
    const double slope = square(h.x / a) + square(h.y / b) + square(h.z);
    const auto lambda = [&](Vec3d w) { return 0.5 * (std::sqrt(1 + stretched(w) / square(w.z)) - 1); };
    const float f = float(1 / (k_pi * a * b * square(slope)) / (4 * l.z * v.z * (1 + lambda(l) + lambda(v))));
    return {f, f, f};
}

// The last nodes are at cosθv = 0.016, 0.0057, 0.0012 and 1e-4. The mixtures do not know the facets.
TEST_F(Sampling, GrazingViewsHaveBoundedWeights) {
    for (const double roughness : {0.03, 0.1, 0.3}) {
        const Brushed rough{roughness, roughness};
        const MixtureProposal proposal = propose(evaluator(rough));
        for (const double z : {0.05, 0.015, 0.005, 0.002, 5e-4, 1e-4}) {
            const Vec3f wv = to_float(spherical(std::acos(z), 0.3));
            Moments weights;
            int lost = 0;
            for (int i = 0; i < k_samples; ++i) {
                const LightSample light = sample(rough, proposal, wv, uniform_point(random));
                lost += light.pdf == 0;
                weights.add(double(light.weight.g));
            }
            EXPECT_LT(weights.relative_variance(), 0.25) << roughness << ' ' << z;
            EXPECT_LT(weights.largest, 50 * weights.mean()) << roughness << ' ' << z;
            EXPECT_LT(lost, 0.002 * k_samples) << roughness << ' ' << z;
        }
    }
}

TEST_F(Sampling, LobesStretchAlongTheGrain) {
    const Brushed brushed;
    const MixtureProposal isotropic = propose(evaluator(brushed)),
                          stretched = propose(evaluator(brushed), {.azimuths = 8});
    EXPECT_EQ(isotropic.cosine * isotropic.cosine + isotropic.sine * isotropic.sine, 0);
    for (const HalfVectorShape& shape : stretched.shape) EXPECT_WITHIN(double(shape.stretch), 5, 1.1);
    EXPECT_WITHIN(std::atan2(double(stretched.sine), double(stretched.cosine)), 0.7, 0.14);
    for (const double theta : {0.0, 45.0, 75.0})
        for (const double phi : {0.2, 1.5}) {
            const Vec3f wv = to_float(spherical(theta * k_degree, phi));
            SCOPED_TRACE(fmt::format("{} {}", theta, phi));
            Moments stretched_weights, isotropic_weights;
            for (int i = 0; i < k_samples; ++i) {
                stretched_weights.add(double(sample(brushed, stretched, wv, uniform_point(random)).weight.g));
                isotropic_weights.add(double(sample(brushed, isotropic, wv, uniform_point(random)).weight.g));
            }
            EXPECT_LT(stretched_weights.relative_variance(), theta > 50 ? 0.5 : 0.15);
            EXPECT_GT(isotropic_weights.relative_variance(), 0.7);
            const auto [integral, lost] = expect_samples_follow(stretched, wv, random, sidak(0.01, 6), 64);
            EXPECT_WITHIN(integral + lost, 1, 2e-3);
        }
}

TEST_F(Sampling, WeightsSumToOneAndTheCosineKeepsItsMinimum) {
    for (const auto& material : materials())
        for (std::size_t node = 0; node < MixtureProposal::k_nodes; ++node) {
            const auto weight = weights_of(material->pm_proposal, node);
            float sum = 0;
            for (const float w : weight) sum += w;
            EXPECT_WITHIN(double(sum), 1, 1e-5);
            EXPECT_GE(*std::min_element(weight.begin(), weight.end()), 0);
            EXPECT_GE(weight[0], 0.9f * k_min_cosine);
        }
}

TEST_F(Sampling, ResultsDoNotDependOnThreads) {
    const Material& material = *materials()[0];
    const MixtureProposal one = propose(evaluator(material.pm), {.threads = 1});
    for (std::size_t node = 0; node < MixtureProposal::k_nodes; ++node)
        EXPECT_EQ(one.weight(node), material.pm_proposal.weight(node));
}

TEST_F(Sampling, BlackIsSampledByTheCosine) {
    const MixtureProposal proposal = propose(evaluator(axial_gaussians({Rgb{}}, {0})));
    for (std::size_t node = 0; node < MixtureProposal::k_nodes; ++node) EXPECT_EQ(proposal.weight(node)[0], 1);
    SuModel su = isotropic_su(16);
    std::fill(su.coefficient.begin(), su.coefficient.end(), Rgb{});
    const ViewProposal view_proposal = propose(su);
    for (int i = 0; i < 100; ++i) {
        const Vec3f wv = to_float(random_direction(random, 0.02)),
                    wl = sample(view_proposal, wv, uniform_point(random));
        EXPECT_GE(pdf(view_proposal, wl, wv), 0.98f * wl.z / float(k_pi));
        EXPECT_EQ(sample(su, view_proposal, wv, uniform_point(random)).weight, Rgb{});
    }
}

TEST_F(Sampling, ViewsAreNoWorseThanTheCosine) {
    for (const auto& material : materials())
        for (const double theta : {0.0, 45.0, 60.0, 75.0, 85.0}) {
            const Evaluate brdf = evaluator(material->su);
            EXPECT_LT(variance(brdf, material->su_proposal, theta),
                      1.1 * variance(brdf, CosineProposal{}, theta) + 1e-3)
                << material->name << ' ' << theta;
        }
}

/// The half vector of the viewer and of the light mirrored at the horizon vanishes at the mirror direction.
TEST_F(Sampling, TheMirrorDirectionHasADensity) {
    for (const auto& material : materials())
        for_each_pairing(*material, [&](const std::string& name, const Evaluate&, const Proposal& proposal) {
            for (const float theta : {0.f, 0.3f, 1.f}) {
                const Vec3f wv(std::sin(theta), 0, std::cos(theta)), mirrored = mirror(wv),
                                                                     beside = normalize(mirrored + Vec3f(0, 3e-4f, 0));
                const double density = double(pdf(proposal, mirrored, wv)),
                             density_beside = double(pdf(proposal, beside, wv));
                EXPECT_WITHIN_RELATIVE(density, density_beside, 0.5) << name << " " << theta;
            }
        });
}

TEST_F(Sampling, ExtremeModelsCanBeSampled) {
    for (int i = 0; i < 8; ++i) {
        const PmModel model = random_model(
            random, {.axial = i % 2 == 0, .log_scale = true, .max_bandwidth = 65504, .form = PmForm::extended});
        const MixtureProposal proposal = propose(evaluator(model), {.azimuths = i % 2 == 0 ? 1 : 4});
        for (int n = 0; n < 1000; ++n) {
            const Vec3f wv = to_float(random_direction(random, n % 5 == 0 ? 1e-5 : 0.02));
            const Vec3f u = n % 7 == 0   ? Vec3f(0, 0, 0)
                            : n % 7 == 1 ? 0x1.fffffep-1f * Vec3f(1, 1, 1)
                                         : uniform_point(random);
            const LightSample light_sample = sample(model, proposal, wv, u);
            EXPECT_TRUE(std::isfinite(light_sample.pdf) && light_sample.pdf >= 0 && is_finite(light_sample.weight));
            if (light_sample.pdf > 0) {
                EXPECT_WITHIN(double(dot(light_sample.wl, light_sample.wl)), 1, 1e-5);
            }
        }
    }
}

}  // namespace
}  // namespace srbf::sampling_test
