#include "code/offered_code.h"
#include "srbf/load.h"
#include "srbf/srbf.h"

namespace SRBF_NAMESPACE {

Result<std::string> shading_code(const LoadedBrdf& model, const std::string& name, std::string_view language) {
    const auto* fitted = std::get_if<Model>(&content(model));
    if (!fitted) return Error{name, {}, "input", "a fitted model", "a measurement", ErrorCode::wrong_kind};
    const auto known = code_language_named(language);
    if (!known) return Error{name, {}, "language", code_language_names(), std::string(language), ErrorCode::argument};
    const NamedModel named{identifier(name), fitted};
    return shading_code({&named, 1}, named.name, {.language = *known});
}

}  // namespace
