#include "srbf/load.h"

#include <fmt/format.h>

#include "base/errors.h"
#include "base/files.h"
#include "base/paths.h"
#include "measured/bytes.h"
#include "measured/readers.h"
#include "models/model_files.h"
#include "srbf/file.h"

namespace SRBF_NAMESPACE {
namespace {

using AnyFile = std::variant<Measured, Model, TexelMap>;

/// The parts of "FILE#NAME": a map, and a texel in it.
struct TexelName {
    std::string file, name;
};
std::optional<TexelName> parse_texel_name(const std::string& path) {
    const auto sign = path.rfind('#');
    std::error_code ignored;
    if (sign == path.npos || std::filesystem::exists(system_files::path_of(path), ignored)) return {};
    return TexelName{path.substr(0, sign), path.substr(sign + 1)};
}

Result<AnyFile> load_fitted(std::span<const std::byte> bytes, const std::string& path,
                            const std::optional<TexelName>& name) {
    const std::string& file = name ? name->file : path;
    if (!is_map_file(bytes)) {
        auto model = read_model(bytes, file);
        if (!model) return model.error();
        if (name) return argument_error(path, "input", "a map, of which # names a texel", "a model");
        return AnyFile(*std::move(model));
    }
    auto map = read_map(bytes, file);
    if (!map) return map.error();
    if (!name) return AnyFile(*std::move(map));
    if (const auto t = find_texel(*map, name->name)) return AnyFile(texel(*map, *t));
    return argument_error(path, "texel",
                          fmt::format("0 to {}, or 0,0 to {},{}", map->count() - 1, map->width - 1, map->height() - 1),
                          fmt::format("{:.80}", name->name));
}

}  // namespace

Result<AnyFile> load_brdf_or_map(const std::string& path, const ReadOptions& options) {
    return within_memory(path, [&]() -> Result<AnyFile> {
        const auto name = parse_texel_name(path);
        auto bytes = read_input(name && options.columns.empty() ? name->file : path, options);
        if (!bytes) return bytes.error();
        if (is_safetensors(*bytes) && options.any())
            return argument_error(path, "input", "samples, for --columns, --quantity and --floor", "a fitted model");
        if (name || is_safetensors(*bytes)) return load_fitted(*bytes, path, name);
        auto measured = read_measured(*std::move(bytes), path, options);
        if (!measured) return measured.error();
        return AnyFile(*std::move(measured));
    });
}

Result<AnyBrdf> load_brdf(const std::string& path, const ReadOptions& options) {
    auto file = load_brdf_or_map(path, options);
    if (!file) return file.error();
    if (auto* measured = std::get_if<Measured>(&*file)) return AnyBrdf(std::move(*measured));
    if (auto* model = std::get_if<Model>(&*file)) return AnyBrdf(std::move(*model));
    return map_error(path);
}

bool is_two_sided(const AnyBrdf& brdf) {
    if (const auto* measured = std::get_if<Measured>(&brdf)) return std::holds_alternative<BsdfTable>(measured->table);
    return std::holds_alternative<BsdfModel>(std::get<Model>(brdf).model);
}

}  // namespace
