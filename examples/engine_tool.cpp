// An engine's import tool: fits a measurement with a progress bar, can be cancelled with Ctrl-C, and writes a fragment
// shader and the model's numbers.
//   engine_tool MEASUREMENT OUT.frag
#include <csignal>
#include <cstdio>
#include <string>

#include "srbf/file.h"
#include "srbf/fit.h"
#include "srbf/shader.h"

namespace {

volatile std::sig_atomic_t g_interrupted = 0;

bool show(const srbf::Progress& now) {
    std::fprintf(stderr, "\r%3.0f %%  %-24.*s", 100 * now.fraction, int(now.stage.size()), now.stage.data());
    return !g_interrupted;  // false cancels the fit
}

/// A shader that shows the material under a light along the normal, and below it the contents of its uniform block.
std::string shader_of(const srbf::PmModel& model) {
    std::string text = srbf::version_text(srbf::Dialect::es_300) + srbf::brdf_text(model) +
                       "in vec3 wv;\nout vec4 pixel;\n"
                       "void main() { pixel = vec4(brdf(vec3(0.0, 0.0, 1.0), normalize(wv)), 1.0); }\n"
                       "// The uniform block PmNumbers (std140):\n";
    for (const srbf::Float4& four : srbf::pm_numbers(model)) {
        char line[128];
        std::snprintf(line, sizeof line, "// %.9g %.9g %.9g %.9g\n", double(four[0]), double(four[1]), double(four[2]),
                      double(four[3]));
        text += line;
    }
    return text;
}

int fail(const srbf::Error& error) { return std::fprintf(stderr, "\n%s\n", message(error).c_str()), 1; }

}  // namespace

int main(int count, char** arguments) {
    if (count != 3) return std::puts("usage: engine_tool MEASUREMENT OUT.frag"), 2;
    std::signal(SIGINT, [](int) { g_interrupted = 1; });
    const auto measured = srbf::load_measured(arguments[1]);
    if (!measured) return fail(measured.error());

    srbf::FitRequest request;
    srbf::PmRequest pm;
    pm.size = srbf::LobeCount{4};
    request.model = pm;
    request.objective = srbf::Objective::cube_root;
    const auto outcome = fit(*measured, request, show);
    if (!outcome) return fail(outcome.error());

    const auto& model = std::get<srbf::PmModel>(outcome->model.model);
    const auto written = srbf::write_file(arguments[2], srbf::as_bytes(shader_of(model)));
    if (!written) return fail(written.error());
    std::printf("\n%zu bytes, held-out error %.2f %%\n", payload_bytes(model),
                100 * error_of(outcome->errors->heldout, request.objective));
}
