// Samples the BxDF of a model from both sides of a surface, and compares the mean of f cosθ / pdf with the albedo, and
// value and density of each sample with f and PDF. Then four threads open the model again, which is prepared once. It
// compiles without pbrt: ../CMakeLists.txt makes headers of pbrt's names that include mock_pbrt.h.
//   pbrt_test MODEL
#include <cmath>
#include <cstdio>
#include <future>
#include <random>

#include "srbf_pbrt.h"

/// True if threads that open a file at once get the same BRDF.
bool is_opened_once(const std::string& file, bool exchanged) {
    const auto open = [&] {
        std::string error;
        return srbf_plain::open(file, exchanged, error);
    };
    std::future<const srbf_plain::Brdf*> opened[4];
    for (auto& each : opened) each = std::async(std::launch::async, open);
    const srbf_plain::Brdf* first = open();
    bool same = first != nullptr;
    for (auto& each : opened) same = (each.get() == first) && same;
    return same;
}

int main(int count, char** arguments) {
    using namespace pbrt;
    if (count != 2) return std::puts("usage: pbrt_test MODEL"), 2;
    std::string error;
    const srbf_plain::Brdf* brdf = srbf_plain::open(arguments[1], false, error);
    if (!brdf) return std::fprintf(stderr, "%s\n", error.c_str()), 1;
    const SrbfMaterial material(brdf, true, {}, nullptr), front(brdf, false, {}, nullptr);
    SampledWavelengths lambda;
    const MaterialEvalContext context;
    const SrbfBxDF bxdf = material.GetBxDF(0, context, lambda), one_sided = front.GetBxDF(0, context, lambda);
    const auto mode = TransportMode::Radiance;
    const auto all = BxDFReflTransFlags::All;
    std::mt19937 random(1);
    std::uniform_real_distribution<float> uniform(0.f, 0.99999994f);
    bool agree = !one_sided.Sample_f({0.6f, 0, -0.8f}, 0.5f, {0.3f, 0.7f}, mode, all);
    agree = agree && srbf_plain::open(arguments[1], false, error) == brdf;
    agree = agree && is_opened_once(arguments[1], true) && srbf_plain::open(arguments[1], true, error) != brdf;
    for (const float z : {0.8f, -0.8f}) {
        const Vector3f wo{0.6f, 0, z};
        double sum = 0, largest = 0;
        constexpr int k_samples = 100000;
        for (int i = 0; i < k_samples; ++i) {
            const float uc = uniform(random), u = uniform(random), v = uniform(random);
            const auto s = bxdf.Sample_f(wo, uc, {u, v}, mode, all);
            if (!s) continue;
            sum += double(s->f[1] * std::abs(s->wi.z) / s->pdf);
            const double density = double(bxdf.PDF(wo, s->wi, mode, all) / s->pdf);
            const double value = double(bxdf.f(wo, s->wi, mode)[1] / s->f[1]);
            largest = std::fmax(largest, std::fmax(std::fabs(density - 1), std::fabs(value - 1)));
        }
        const double mean = sum / k_samples, expected = double(srbf_plain::albedo(*brdf, std::abs(z)));
        std::printf("%s from z = %g: mean f cos / pdf %.4f, albedo %.4f, differences %.2g\n", bxdf.ToString().c_str(),
                    double(z), mean, expected, largest);
        agree = agree && std::fabs(mean - expected) < 0.03 * expected && largest < 1e-3;
    }
    return agree ? 0 : 1;
}
