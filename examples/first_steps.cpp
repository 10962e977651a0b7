// The library on one page: fits a measurement, writes the model and its GLSL, and asks values and samples of it.
//   first_steps paper_white_rgb.bsdf
#include <cstdio>

#include "srbf/srbf.h"

int failed(const srbf::Error& error) {  // of which file, at which offset, what was expected, and what was found
    std::fprintf(stderr, "%s\n", srbf::message(error).c_str());
    return 1;
}

int main(int count, char** arguments) {
    const auto measured = srbf::load(count > 1 ? arguments[1] : "paper_white_rgb.bsdf");
    if (!measured) return failed(measured.error());
    const auto fitted = srbf::fit(*measured);
    if (!fitted) return failed(fitted.error());
    if (const auto done = srbf::save(fitted->model, "fitted.srbf"); !done) return failed(done.error());
    std::printf("%zu bytes, visible error %.2f\n", fitted->bytes, fitted->delta_e);

    const srbf::PreparedBrdf brdf = srbf::prepare(fitted->model);
    const srbf::Vec3f wv{0, 0.6f, 0.8f};
    const srbf::LightSample light = srbf::sample(brdf, wv, {0.3f, 0.7f}, 0.5f);  // numbers uniform in [0, 1)
    if (light.pdf > 0)  // otherwise the sample has no direction
        std::printf("f %.4f, pdf %.4f, weight %.4f\n", double(srbf::value(brdf, light.wl, wv).g), double(light.pdf),
                    double(light.weight.g));
    std::printf("albedo %.4f\n", double(srbf::albedo(brdf, wv.z).g));
    const auto code = srbf::shading_code(fitted->model, "paper", "glsl");
    if (!code) return failed(code.error());
    std::puts(code->c_str());
}
