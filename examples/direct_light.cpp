// Renders a ball of a model under a sky with a window, by direct light alone: samples of the model and of the window,
// combined by multiple importance sampling. With `alone` the model's samples do it without those of the window.
//   direct_light MODEL PICTURE.ppm [SAMPLES [alone]]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <vector>

#include "srbf/srbf.h"

using srbf::Rgb, srbf::Vec3f;
constexpr float k_pi = 3.14159265f;

/// A frame about the normal: the model sees directions in it, with the normal as z.
struct Frame {
    Vec3f x, y, z;
    explicit Frame(Vec3f n) : x(normalize(std::abs(n.y) < 0.9f ? Vec3f{n.z, 0, -n.x} : Vec3f{0, -n.z, n.y})), z(n) {
        y = {n.y * x.z - n.z * x.y, n.z * x.x - n.x * x.z, n.x * x.y - n.y * x.x};
    }
    Vec3f to_local(Vec3f w) const { return {dot(w, x), dot(w, y), dot(w, z)}; }
    Vec3f to_world(Vec3f w) const { return w.x * x + w.y * y + w.z * z; }
};

// The light: a sky, and in it a round window of radiance 6, whose directions have the density k_window_pdf.
float sky(Vec3f w) { return 0.4f + 0.4f * w.y; }
const Frame k_window(normalize(Vec3f{-0.6f, 0.65f, 0.45f}));
constexpr float k_radiance = 6, k_cosine = 0.97f, k_window_pdf = 1 / (2 * k_pi * (1 - k_cosine));

struct Random {
    std::mt19937 engine{1};
    std::uniform_real_distribution<float> uniform{0.f, 0.99999994f};
    float operator()() { return uniform(engine); }
};
Vec3f sample_window(float u, float v) {
    const float z = 1 - u * (1 - k_cosine), r = std::sqrt(1 - z * z), phi = 2 * k_pi * v;
    return k_window.to_world({r * std::cos(phi), r * std::sin(phi), z});
}

/// An estimate of the radiance that a point with this frame reflects towards wv, which is in the frame.
Rgb reflected(const srbf::PreparedBrdf& brdf, const Frame& frame, Vec3f wv, bool alone, Random& random) {
    Rgb sum{};
    const auto add = [&sum](float light, Rgb f) { sum.r += light * f.r, sum.g += light * f.g, sum.b += light * f.b; };

    // A direction sampled by the model, with f cos(theta_l) / pdf. If it hits the window, it shares the window's light
    // with the sample below, in proportion to their densities (the balance heuristic).
    const float u = random(), v = random(), selector = random();
    const srbf::LightSample s = srbf::sample(brdf, wv, {u, v}, selector);
    if (s.pdf > 0) {
        const Vec3f w = frame.to_world(s.wl);
        const bool hits = dot(w, k_window.z) > k_cosine;
        const float fraction = alone ? 1 : s.pdf / (s.pdf + k_window_pdf);
        add(sky(w) + (hits ? k_radiance * fraction : 0), s.weight);
    }
    if (alone) return sum;

    // A direction sampled in the window, with f and the density that the model has for it.
    const float x = random(), y = random();
    const Vec3f wl = frame.to_local(sample_window(x, y));
    if (wl.z > 0) {
        const srbf::ValuePdf f = srbf::value_pdf(brdf, wl, wv);  // NaN where a measurement has no value
        if (f.value.g >= 0) add(k_radiance * wl.z / (k_window_pdf + f.pdf), f.value);
    }
    return sum;
}

int main(int count, char** arguments) {
    const int samples = count > 3 ? std::atoi(arguments[3]) : 32;
    if (count < 3 || samples < 1) return std::puts("usage: direct_light MODEL PICTURE.ppm [SAMPLES [alone]]"), 2;
    const auto model = srbf::load(arguments[1]);
    if (!model) return std::fprintf(stderr, "%s\n", message(model.error()).c_str()), 1;
    const srbf::PreparedBrdf brdf = srbf::prepare(*model);  // once; any number of threads may use it

    constexpr int k_size = 200;
    Random random;
    std::vector<unsigned char> picture;
    double mean = 0;
    for (int row = 0; row < k_size; ++row)
        for (int column = 0; column < k_size; ++column) {
            Rgb sum{};
            const float x = (float(column) + 0.5f) * 2 / k_size - 1, y = 1 - (float(row) + 0.5f) * 2 / k_size;
            if (x * x + y * y < 0.999f) {
                const Frame frame(Vec3f{x, y, std::sqrt(1 - x * x - y * y)});
                const Vec3f wv = frame.to_local({0, 0, 1});  // towards the viewer
                for (int i = 0; i < samples; ++i) {
                    const Rgb estimate = reflected(brdf, frame, wv, count > 4, random);
                    sum.r += estimate.r, sum.g += estimate.g, sum.b += estimate.b;
                }
            }
            mean += double(sum.g) / samples / (k_size * k_size);
            for (const float value : {sum.r, sum.g, sum.b})
                picture.push_back(static_cast<unsigned char>(
                    255 * std::pow(std::clamp(2 * value / float(samples), 0.f, 1.f), 1 / 2.2f)));
        }
    std::FILE* const file = std::fopen(arguments[2], "wb");
    if (!file) return std::fprintf(stderr, "cannot write %s\n", arguments[2]), 1;
    std::fprintf(file, "P6\n%d %d\n255\n", k_size, k_size);
    std::fwrite(picture.data(), 1, picture.size(), file);
    std::printf("mean green radiance %.3f\n", mean);
    return std::fclose(file) != 0;
}
