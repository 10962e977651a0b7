// Models as shaders for the Universal Render Pipeline of Unity.
#include "base/errors.h"
#include "extras/environment/code/materials.h"
#include "generated/extras/environment/texts.h"
#include "srbf/environment_code.h"

namespace SRBF_NAMESPACE {

Result<std::string> unity_shader(std::span<const NamedModel> models, int threads) {
    if (models.size() != 1) return argument_error("unity", "models", "one", std::to_string(models.size()));
    if (const auto valid = check_materials(models); !valid) return valid.error();
    const std::string& name = models[0].name;
    const auto functions =
        environment_code(models, name, {.language = CodeLanguage::hlsl, .threads = threads}, {.environment = true});
    if (!functions) return functions.error();
    std::string text = k_unity_urp_text;
    replace_all(text, "$NAME", name);
    replace_all(text, "$TITLE", capitalised(name));
    replace_all(text, "$FUNCTIONS", *functions);
    return text;
}

}  // namespace
