#include "srbf/load.h"

#include <fmt/format.h>

#include "base/files.h"
#include "base/paths.h"
#include "base/text.h"
#include "measured/bytes.h"
#include "measured/readers.h"
#include "models/library_file.h"
#include "models/texel.h"
#include "srbf/file.h"
#include "srbf/library.h"

namespace SRBF_NAMESPACE {

namespace {

/// The parts of "FILE#NAME": a stack or library, and a texel or material in it.
struct TexelName {
    std::string file, name;
};
std::optional<TexelName> parse_texel_name(const std::string& path) {
    const auto sign = path.rfind('#');
    std::error_code ignored;
    if (sign == path.npos || std::filesystem::exists(system_files::path_of(path), ignored)) return {};
    return TexelName{path.substr(0, sign), path.substr(sign + 1)};
}

Result<AnyBrdf> to_any(Result<Model> model) {
    if (!model) return model.error();
    return AnyBrdf(*std::move(model));
}

/// Loads the model with this name from a library or a stack.
Result<AnyBrdf> load_named(std::span<const std::byte> bytes, const TexelName& texel_name, const std::string& path) {
    if (is_library(bytes)) {
        const auto library = read_library(bytes, texel_name.file);
        if (!library) return library.error();
        if (const auto index = find_material(*library, texel_name.name)) return AnyBrdf(material(*library, *index));
        return Error{path,
                     {},
                     "material",
                     library->names.empty() ? fmt::format("0 to {}", library->count() - 1)
                                            : fmt::format("a name such as {}", library->names[0]),
                     fmt::format("{:.80}", texel_name.name),
                     ErrorCode::argument};
    }
    const auto texel = to_number<std::uint64_t>(texel_name.name);
    if (!texel)
        return Error{path, {}, "texel", "a number", fmt::format("{:.80}", texel_name.name), ErrorCode::argument};
    return to_any(read_texel(bytes, *texel, path));
}

}  // namespace

Result<AnyBrdf> load_brdf(const std::string& path, const ReadOptions& options) {
    return within_memory(path, [&]() -> Result<AnyBrdf> {
        const auto texel_name = parse_texel_name(path);
        auto bytes = read_input(texel_name && options.columns.empty() ? texel_name->file : path, options);
        if (!bytes) return bytes.error();
        if (is_safetensors(*bytes) && options.any())
            return Error{path,
                         {},
                         "input",
                         "samples, for --columns, --quantity and --floor",
                         "a fitted model",
                         ErrorCode::argument};
        if (texel_name) return load_named(*bytes, *texel_name, path);
        if (is_safetensors(*bytes)) return to_any(read_model(*bytes, path));
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
