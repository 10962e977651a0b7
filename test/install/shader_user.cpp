// Prints a fragment shader of the model in a file, lit along the normal, and the model's numbers.
#include <cstdio>

#include "srbf/shader.h"

int main(int, char** arguments) {
    const auto loaded = srbf::load_model(arguments[1]);
    if (!loaded) return std::puts(message(loaded.error()).c_str()), 1;
    const auto* model = std::get_if<srbf::PmModel>(&loaded->model);
    if (!model) return std::puts("no multivariate model"), 1;
    std::printf(
        "%s%s%s", srbf::version_text(srbf::Dialect::es_300).c_str(), srbf::brdf_text(*model).c_str(),
        "in vec3 wv;\nout vec4 pixel;\nvoid main() { pixel = vec4(brdf(vec3(0.0, 0.0, 1.0), normalize(wv)), 1.0); }\n");
    std::puts("// The block PmNumbers:");
    for (const srbf::Float4& four : srbf::pm_numbers(*model))
        std::printf("// %g %g %g %g\n", double(four[0]), double(four[1]), double(four[2]), double(four[3]));
}
