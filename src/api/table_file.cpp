#include "api/table_file.h"

#include "base/errors.h"

namespace SRBF_NAMESPACE {

namespace {

TableSource table_source(const Model& model) {
    const auto* bsdf = std::get_if<BsdfModel>(&model.model);
    TableSource source{.values = evaluator(model), .isotropic = is_isotropic(model)};
    if (bsdf) set_parts(source, bsdf->part, bsdf->beam);
    if (!wavelengths(model).empty()) source.spectra = channels(model);
    return source;
}

/// The values of `brdf`; no values once it is cancelled, so that the caller ends soon.
Evaluate until_cancelled(Evaluate brdf, const ProgressToken& token) {
    return [brdf = std::move(brdf), token](auto wl, auto wv, auto f) {
        if (!token.cancelled()) brdf(wl, wv, f);
    };
}

TableSource source_of(const AnyBrdf& brdf) {
    return std::visit([](const auto& content) { return table_source(content); }, brdf);
}

}  // namespace

bool has_part(const AnyBrdf& brdf, Part part) { return source_of(brdf).has[std::size_t(part)]; }
Beams beams_of(const AnyBrdf& brdf) { return source_of(brdf).beams; }

Result<std::vector<std::byte>> table_file(const AnyBrdf& brdf, const Format& format, const TableOptions& options) {
    const auto refused = [](std::string expected, std::string found) {
        return argument_error("table", "input", std::move(expected), std::move(found));
    };
    TableSource source = source_of(brdf);
    if (!format.anisotropic && !source.isotropic) return refused("an isotropic BRDF", "an anisotropic one");
    if (format.one_sided && source.two_sided) return refused("a BRDF", "a BSDF");
    if (!format.beams && source.beams != Beams{}) return refused("a BSDF without beams", "light that is not scattered");
    source.values = until_cancelled(std::move(source.values), options.progress);
    auto bytes = format.write(source, options);
    if (options.progress.cancelled()) return cancelled_error("table");
    return bytes;
}

}  // namespace
