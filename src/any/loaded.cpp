// The functions of srbf.h, implemented with those of the other headers.
#include <fmt/format.h>

#include <atomic>

#include "base/errors.h"
#include "base/files.h"
#include "base/paths.h"
#include "base/text.h"
#include "errors/picture_errors.h"
#include "measured/bytes.h"
#include "measured/readers.h"
#include "models/library_file.h"
#include "models/texel.h"
#include "srbf/file.h"
#include "srbf/fit.h"
#include "srbf/library.h"
#include "srbf/load.h"
#include "srbf/prepared.h"

namespace SRBF_NAMESPACE {

struct LoadedBrdf::Contents {
    AnyBrdf brdf;
    mutable std::atomic<int> uses = 1;

    explicit Contents(AnyBrdf content) : brdf(std::move(content)) {}
};
void add_use(const LoadedBrdf::Contents& contents) { contents.uses.fetch_add(1, std::memory_order_relaxed); }
void end_use(const LoadedBrdf::Contents& contents) {
    if (contents.uses.fetch_sub(1, std::memory_order_acq_rel) == 1) delete &contents;
}

const AnyBrdf& content(const LoadedBrdf& brdf) {
    if (!brdf.contents) misused("a LoadedBrdf without content: expected what load or fit returned");
    return brdf.contents->brdf;
}
LoadedBrdf loaded_brdf(AnyBrdf content) { return {Shared(new LoadedBrdf::Contents(std::move(content)))}; }

Result<LoadedBrdf> load(const std::string& path) {
    auto brdf = load_brdf(path);
    if (!brdf) return brdf.error();
    return loaded_brdf(*std::move(brdf));
}

LoadedBrdf exchanged(const LoadedBrdf& brdf) {
    AnyBrdf copy = content(brdf);
    std::visit([](auto& any) { exchange(any); }, copy);
    return loaded_brdf(std::move(copy));
}

Result<FittedBrdf> fit(const LoadedBrdf& measured) {
    const auto* measurement = std::get_if<Measured>(&content(measured));
    if (!measurement) return Error{"fit", {}, "input", "a measurement", "a fitted model", ErrorCode::wrong_kind};
    auto outcome = fit(*measurement, FitRequest{});
    if (!outcome) return outcome.error();
    const std::size_t bytes = payload_bytes(outcome->model);
    return FittedBrdf{loaded_brdf(std::move(outcome->model)), bytes, judged(*outcome->errors).mean.delta_e};
}

Result<Done> save(const LoadedBrdf& model, const std::string& path) {
    const auto* fitted = std::get_if<Model>(&content(model));
    if (!fitted) return Error{path, {}, "output", "a fitted model", "a measurement", ErrorCode::wrong_kind};
    return save_model(*fitted, path);
}

PreparedBrdf prepare(const LoadedBrdf& brdf, int threads) {
    const auto prepared = [threads](const auto& any) {
        return prepare(any, {.azimuths = azimuths_for(is_isotropic(any)), .threads = threads});
    };
    return std::visit(prepared, content(brdf));
}

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
        return argument_error(path, "material",
                              library->names.empty() ? fmt::format("0 to {}", library->count() - 1)
                                                     : fmt::format("a name such as {}", library->names[0]),
                              fmt::format("{:.80}", texel_name.name));
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
            return argument_error(path, "input", "samples, for --columns, --quantity and --floor", "a fitted model");
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
