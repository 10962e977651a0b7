// A renderer's material: loads a model, then evaluates and samples it ray by ray from several threads, and estimates
// how much of a sky of radiance 1 it reflects, by light sampling and by BRDF sampling, combined by the power heuristic.
//   path_material MODEL
#include <cmath>
#include <cstdio>
#include <random>
#include <thread>
#include <vector>

#include "srbf/load.h"
#include "srbf/prepared.h"

namespace {

constexpr int k_threads = 4, k_rays = 50000;

double power(double a, double b) { return a * a / (a * a + b * b); }

/// The mean green radiance along rays that meet the material at cosθv.
double reflected(const srbf::PreparedBrdf& material, float cos_v, int rays, unsigned seed) {
    std::mt19937 random(seed);
    const auto uniform = [&] { return std::uniform_real_distribution<float>(0.f, 0.99999994f)(random); };
    const srbf::Vec3f wv{std::sqrt(1 - cos_v * cos_v), 0, cos_v};
    const srbf::CosineProposal sky;  // samples the sky in proportion to cosθ
    double sum = 0;
    for (int ray = 0; ray < rays; ++ray) {
        // The BRDF draws a direction, with the weight f cosθl / pdf and the density pdf.
        const srbf::Vec2f u{uniform(), uniform()};
        const srbf::LightSample drawn = sample(material, wv, u, uniform());
        if (drawn.pdf > 0) sum += double(drawn.weight.g) * power(double(drawn.pdf), double(pdf(sky, drawn.wl, wv)));
        // The light draws a direction.
        const srbf::Vec3f wl = sample(sky, wv, {uniform(), uniform()}, 0);
        const double sky_pdf = double(pdf(sky, wl, wv));
        if (sky_pdf > 0)
            sum += double(value(material, wl, wv).g) * double(wl.z) / sky_pdf *
                   power(sky_pdf, double(pdf(material, wl, wv)));
    }
    return sum / rays;
}

}  // namespace

int main(int count, char** arguments) {
    if (count != 2) return std::puts("usage: path_material MODEL"), 2;
    const auto model = srbf::load_model(arguments[1]);
    if (!model) return std::fprintf(stderr, "%s\n", message(model.error()).c_str()), 1;
    const srbf::PreparedBrdf material = prepare(*model);

    int wrong = 0;
    for (const float cos_v : {1.f, 0.7f, 0.3f}) {
        std::vector<double> thread_means(k_threads);
        std::vector<std::thread> threads;
        for (unsigned i = 0; i < k_threads; ++i)
            threads.emplace_back([&, i] { thread_means[i] = reflected(material, cos_v, k_rays, i); });
        double mean = 0;
        for (unsigned i = 0; i < k_threads; ++i) threads[i].join(), mean += thread_means[i] / k_threads;
        const double expected = double(albedo(material, cos_v).g);
        std::printf("cos(theta_v) %.1f: reflects %.4f of the sky, albedo %.4f\n", double(cos_v), mean, expected);
        wrong += !(std::abs(mean - expected) < 0.02 * expected + 0.002);
    }
    return wrong > 0;
}
