#include <fmt/format.h>

#include <algorithm>
#include <ranges>

#include "srbf/load.h"
#include "srbf/shading_code.h"

namespace srbf {

Result<std::string> shading_code(const LoadedBrdf& model, const std::string& name, std::string_view language) {
    const auto* fitted = std::get_if<Model>(&content(model));
    if (!fitted) return Error{name, {}, "input", "a fitted model", "a measurement", ErrorCode::wrong_kind};
    const auto row = std::ranges::find(k_code_languages, language, &CodeLanguageRow::name);
    if (row == std::end(k_code_languages))
        return Error{
            name,
            {},
            "language",
            fmt::format("{}", fmt::join(std::views::transform(k_code_languages, &CodeLanguageRow::name), ", ")),
            std::string(language),
            ErrorCode::argument};
    const NamedModel named{identifier(name), fitted};
    return shading_code({&named, 1}, named.name, {.language = row->language});
}

}  // namespace srbf
