#include "srbf/load.h"

#include <fmt/format.h>

#include <filesystem>

#include "base/text.h"
#include "measured/bytes.h"
#include "models/texel.h"
#include "srbf/file.h"
#include "srbf/library.h"

namespace srbf {

namespace {

/// The stack or library and the texel or material that "FILE#NAME" names.
struct TexelName {
    std::string file, name;
};
std::optional<TexelName> texel_named(const std::string& path) {
    const auto sign = path.rfind('#');
    std::error_code none;
    if (sign == path.npos || std::filesystem::exists(path, none)) return {};
    return TexelName{path.substr(0, sign), path.substr(sign + 1)};
}

Result<AnyBrdf> any(Result<Model> model) {
    if (!model) return model.error();
    return AnyBrdf(*std::move(model));
}

/// The model that a name stands for in a library or a stack.
Result<AnyBrdf> named(std::span<const std::byte> bytes, const TexelName& of, const std::string& path) {
    if (is_library(bytes)) {
        const auto library = read_library(bytes, of.file);
        if (!library) return library.error();
        if (const auto t = find_material(*library, of.name)) return AnyBrdf(material(*library, *t));
        return Error{path,
                     {},
                     "material",
                     library->names.empty() ? fmt::format("0 to {}", library->count() - 1)
                                            : fmt::format("a name such as {}", library->names[0]),
                     fmt::format("{:.80}", of.name),
                     ErrorCode::argument};
    }
    const auto texel = to_number<std::uint64_t>(of.name);
    if (!texel) return Error{path, {}, "texel", "a number", fmt::format("{:.80}", of.name), ErrorCode::argument};
    return any(read_texel(bytes, *texel, path));
}

}  // namespace

Result<AnyBrdf> load_brdf(const std::string& path, const ReadOptions& options) {
    return within_memory(path, [&]() -> Result<AnyBrdf> {
        const auto of_stack = texel_named(path);
        auto bytes = read_input(of_stack && options.columns.empty() ? of_stack->file : path, options);
        if (!bytes) return bytes.error();
        if (is_safetensors(*bytes) && options.any())
            return Error{path,
                         {},
                         "input",
                         "samples, for --columns, --quantity and --floor",
                         "a fitted model",
                         ErrorCode::argument};
        if (of_stack) return named(*bytes, *of_stack, path);
        if (is_safetensors(*bytes)) return any(read_model(*bytes, path));
        auto measured = read_measured(*std::move(bytes), path, options);
        if (!measured) return measured.error();
        return AnyBrdf(*std::move(measured));
    });
}

bool is_two_sided(const AnyBrdf& brdf) {
    if (const auto* measured = std::get_if<Measured>(&brdf)) return std::holds_alternative<BsdfTable>(measured->table);
    return std::holds_alternative<BsdfModel>(std::get<Model>(brdf).model);
}

}  // namespace srbf
