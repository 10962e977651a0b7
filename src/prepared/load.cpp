#include "srbf/load.h"

#include <fmt/format.h>

#include <filesystem>

#include "measured/bytes.h"
#include "models/texel.h"
#include "srbf/file.h"
#include "srbf/library.h"
#include "srbf/text.h"

namespace srbf {

namespace {

/// The parts of "FILE#NAME": a stack or library, and a texel or material in it.
struct TexelName {
    std::string file, name;
};
std::optional<TexelName> parse_texel_name(const std::string& path) {
    const auto sign = path.rfind('#');
    std::error_code ignored;
    if (sign == path.npos || std::filesystem::exists(path, ignored)) return {};
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

namespace {

TableSource table_source(const Model& model) {
    const auto* bsdf = std::get_if<BsdfModel>(&model.model);
    TableSource source{.values = evaluator(model), .two_sided = bsdf != nullptr};
    if (!bsdf) return source;
    for (std::size_t p = 0; p < k_parts; ++p) source.has[p] = answering(bsdf->part, Part(p)).brdf != nullptr;
    source.beams = bsdf->beam;
    return source;
}

/// Evaluates `values` until it is cancelled; then does nothing, so that callers end soon.
Evaluate until_cancelled(Evaluate values, const ProgressToken& token) {
    return [values = std::move(values), token](auto wl, auto wv, auto f) {
        if (!token.cancelled()) values(wl, wv, f);
    };
}

TableSource source_of(const AnyBrdf& brdf) {
    return std::visit([](const auto& content) { return table_source(content); }, brdf);
}

}  // namespace

bool has_part(const AnyBrdf& brdf, Part part) { return source_of(brdf).has[std::size_t(part)]; }

Result<std::vector<std::byte>> table_file(const AnyBrdf& brdf, const Format& format, const TableOptions& options) {
    const auto refuse = [](std::string expected, std::string found) {
        return Error{"table", {}, "input", std::move(expected), std::move(found), ErrorCode::argument};
    };
    TableSource source = source_of(brdf);
    if (!format.anisotropic && !source.isotropic) return refuse("an isotropic BRDF", "an anisotropic one");
    if (format.one_sided && source.two_sided) return refuse("a BRDF", "a BSDF");
    source.values = until_cancelled(std::move(source.values), options.progress);
    auto bytes = format.write(source, options);
    if (options.progress.cancelled()) return cancelled_error("table");
    return bytes;
}

}  // namespace srbf
