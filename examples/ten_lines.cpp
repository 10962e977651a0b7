// The library in ten lines: fits a measurement, writes the model and its GLSL, and asks values and samples of it.
//   ten_lines paper_white_rgb.bsdf
#include <cstdio>

#include "srbf/srbf.h"

int main(int count, char** arguments) {
    if (count != 2) return std::puts("usage: ten_lines MEASUREMENT"), 2;
    const auto measured = srbf::load(arguments[1]);
    if (!measured) return std::puts(message(measured.error()).c_str()), 1;
    const auto fitted = srbf::fit(*measured);
    if (!fitted) return std::puts(message(fitted.error()).c_str()), 1;
    if (const auto done = save(fitted->model, "fitted.srbf"); !done) return std::puts(message(done.error()).c_str()), 1;
    std::printf("%zu bytes, visible error %.2f\n", fitted->bytes, fitted->delta_e);

    const srbf::PreparedBrdf brdf = prepare(fitted->model);
    const srbf::Vec3f wv{0, 0.6f, 0.8f};
    const srbf::LightSample light = sample(brdf, wv, {0.3f, 0.7f}, 0.5f);  // of numbers that are uniform in [0, 1)
    std::printf("f %.4f, pdf %.4f, weight %.4f, albedo %.4f\n", double(value(brdf, light.wl, wv).g),
                double(pdf(brdf, light.wl, wv)), double(light.weight.g), double(albedo(brdf, wv.z).g));
    std::puts(shading_code(fitted->model, "paper", "glsl")->c_str());
}
