// A path tracer with bounces: a ball of a model on a chequered floor of the same model, under a sky with a sun. At each
// point the sun is sampled and the path goes on by the model, with multiple importance sampling and Russian roulette.
//   paths MODEL PICTURE.ppm [SAMPLES]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <random>
#include <string>

#include "srbf/srbf.h"

using srbf::Rgb, srbf::Vec3f;
constexpr float k_pi = 3.14159265f;
Rgb operator*(Rgb a, Rgb b) { return {a.r * b.r, a.g * b.g, a.b * b.b}; }
Rgb operator*(float s, Rgb a) { return {s * a.r, s * a.g, s * a.b}; }
Rgb operator+(Rgb a, Rgb b) { return {a.r + b.r, a.g + b.g, a.b + b.b}; }

/// A frame about the normal: the model sees directions in it, with the normal as z.
struct Frame {
    Vec3f x, y, z;
    explicit Frame(Vec3f n)
        : x(normalize(std::abs(n.y) < 0.9f ? Vec3f{n.z, 0, -n.x} : Vec3f{0, -n.z, n.y})), y(cross(n, x)), z(n) {}
    Vec3f to_local(Vec3f w) const { return {dot(w, x), dot(w, y), dot(w, z)}; }
    Vec3f to_world(Vec3f w) const { return w.x * x + w.y * y + w.z * z; }
};

/// The nearest point of a ray on the ball about (0, 1, 0) or on the floor y = 0; without one the distance is 0.
struct Hit {
    float distance;
    Vec3f normal;
};
Hit intersect(Vec3f from, Vec3f w) {
    const Vec3f from_centre = from - Vec3f{0, 1, 0};
    const float b = dot(from_centre, w), root = b * b - dot(from_centre, from_centre) + 1;
    const float ball = root > 0 ? -b - std::sqrt(root) : 0, floor = w.y < 0 ? -from.y / w.y : 0;
    if (ball > 1e-3f && (floor < 1e-3f || ball < floor)) return {ball, normalize(from_centre + ball * w)};
    return {floor < 1e-3f ? 0 : floor, {0, 1, 0}};
}

// A sky with a sun, whose directions are sampled with the density k_sun_pdf. Of the sun's light `fraction` counts.
const Frame k_sun(normalize(Vec3f{0.5f, 0.65f, 0.55f}));
constexpr float k_radiance = 25, k_cosine = 0.985f, k_sun_pdf = 1 / (2 * k_pi * (1 - k_cosine));
Rgb sky(Vec3f w, float fraction) {
    const float sun = dot(w, k_sun.z) > k_cosine ? fraction * k_radiance : 0, grey = 0.35f + 0.25f * w.y + sun;
    return {grey, grey, grey + 0.25f * w.y};
}

/// An estimate of the radiance that arrives at `at` from the direction w.
template <typename Random> Rgb trace(const srbf::PreparedBrdf& brdf, Vec3f at, Vec3f w, Random&& random) {
    Rgb sum{}, throughput{1, 1, 1};
    for (float fraction = 1;;) {
        const Hit hit = intersect(at, w);
        if (hit.distance == 0) return sum + throughput * sky(w, fraction);
        at = at + hit.distance * w;
        const Frame frame(hit.normal);
        const Vec3f wv = frame.to_local(-1.f * w);
        if (hit.normal.y == 1 && (int(std::floor(2 * at.x)) + int(std::floor(2 * at.z))) % 2)
            throughput = 0.3f * throughput;

        // The sun, unless something is before it: its light, weighted by the density that the model has for it.
        const float z = 1 - random() * (1 - k_cosine), r = std::sqrt(1 - z * z), phi = 2 * k_pi * random();
        const Vec3f to_sun = k_sun.to_world({r * std::cos(phi), r * std::sin(phi), z}), wl = frame.to_local(to_sun);
        if (wl.z > 0 && intersect(at, to_sun).distance == 0) {
            const srbf::ValuePdf f = srbf::value_pdf(brdf, wl, wv);  // NaN where a measurement has no value
            if (f.value.g >= 0) sum = sum + k_radiance * wl.z / (k_sun_pdf + f.pdf) * throughput * f.value;
        }
        // The path goes on in a direction that the model samples. It ends by chance if it carries little light.
        const float x = random(), y = random(), selector = random();
        const srbf::LightSample s = srbf::sample(brdf, wv, {x, y}, selector);
        if (!(s.pdf > 0)) return sum;
        throughput = throughput * s.weight;
        const float survival = std::min(0.95f, std::max({throughput.r, throughput.g, throughput.b}));
        if (random() >= survival) return sum;
        throughput = (1 / survival) * throughput, fraction = s.pdf / (s.pdf + k_sun_pdf), w = frame.to_world(s.wl);
    }
}

int main(int count, char** arguments) {
    const int samples = count > 3 ? std::atoi(arguments[3]) : 64;
    if (count < 3 || samples < 1) return std::puts("usage: paths MODEL PICTURE.ppm [SAMPLES]"), 2;
    const auto model = srbf::load(arguments[1]);
    if (!model) return std::fprintf(stderr, "%s\n", message(model.error()).c_str()), 1;
    const srbf::PreparedBrdf brdf = srbf::prepare(*model);

    constexpr int k_width = 320, k_height = 240;
    std::mt19937 engine(1);
    const auto random = [&] { return std::uniform_real_distribution<float>(0.f, 0.99999994f)(engine); };
    std::string picture;
    for (int pixel = 0; pixel < k_width * k_height; ++pixel) {
        Rgb sum{};
        for (int i = 0; i < samples; ++i) {
            const float x = (float(pixel % k_width) + random()) / k_width - 0.5f;
            const float y = 0.225f - (float(pixel / k_width) + random()) / k_width;
            sum = sum + trace(brdf, {0, 1.5f, 4.2f}, normalize(Vec3f{x, y, -1}), random);
        }
        for (const float value : {sum.r, sum.g, sum.b})
            picture += char(255 * std::pow(std::min(value / float(samples), 1.f), 1 / 2.2f));
    }
    std::ofstream file(arguments[2], std::ios::binary);
    file << "P6\n" << k_width << ' ' << k_height << "\n255\n" << picture;
    return file.flush() ? 0 : (std::fprintf(stderr, "cannot write %s\n", arguments[2]), 1);
}
