// Uses part of every header: reads the named measurement, tabulates it, fits it and saves the fit.
#include <cstdio>

#include "srbf/convert.h"
#include "srbf/fit.h"
#include "srbf/kernel.h"
#include "srbf/measured.h"
#include "srbf/metrics.h"
#include "srbf/model.h"

int main(int, char** arguments) {
    const auto measured = srbf::load_measured(arguments[1]);
    if (!measured) return std::puts(message(measured.error()).c_str()), 1;
    const auto fit = srbf::fit(*measured, {.model = srbf::PmRequest{.variates = 2, .size = srbf::LobeCount{2}}});
    if (!fit) return std::puts(message(fit.error()).c_str()), 1;
    const auto saved = srbf::save_model(fit->model, arguments[2]);
    if (!saved) return std::puts(message(saved.error()).c_str()), 1;
    const auto again = srbf::load_model(arguments[2]);
    const srbf::Rgb f = value(*again, {0, 0, 1}, {0.6f, 0, 0.8f}), g = value(*measured, {0, 0, 1}, {0.6f, 0, 0.8f});
    std::printf("%zu bytes, green %.3f for %.3f\n", payload_bytes(fit->model), double(f.g), double(g.g));
    return f.g > 0.5f * g.g && f.g < 2 * g.g ? 0 : 1;
}
