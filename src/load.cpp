#include "srbf/load.h"

#include "srbf/convert.h"
#include "srbf/file.h"

namespace srbf {

Result<AnyBrdf> load_brdf(const std::string& path) {
    auto bytes = read_file(path);
    if (!bytes) return bytes.error();
    if (is_safetensors(*bytes)) {
        auto model = read_model(*bytes, path);
        if (!model) return model.error();
        return AnyBrdf(*std::move(model));
    }
    auto measured = read_measured(*std::move(bytes), path);
    if (!measured) return measured.error();
    return AnyBrdf(*std::move(measured));
}

const TableFormatRow* table_format(std::string_view path) {
    for (const TableFormatRow& row : k_table_formats)
        if (path.size() > row.extension.size() && path.ends_with(row.extension)) return &row;
    return nullptr;
}

Result<std::vector<std::byte>> table_file(const AnyBrdf& brdf, TableFormat format, const TableOptions& options) {
    const auto* measured = std::get_if<Measured>(&brdf);
    const bool isotropic = !measured || is_isotropic(*measured);
    const Evaluate values = measured ? signed_evaluator(*measured) : evaluator(std::get<Model>(brdf));
    if (format != TableFormat::csv && !isotropic)
        return Error{"table", {}, "input", "an isotropic BRDF", "an anisotropic one", ErrorCode::argument};
    switch (format) {
        case TableFormat::merl:
            return write_merl(to_merl(measured ? evaluator(*measured) : values, k_merl_size, options.threads));
        case TableFormat::rgl:
            return write_rgl(to_rgl(values, {.description = options.description, .threads = options.threads}),
                             options.spectra);
        case TableFormat::mbsdf:
            return write_mbsdf(
                to_mbsdf(values, {.metadata = {{"description", options.description}}, .threads = options.threads}));
        case TableFormat::csv:
            break;
    }
    const auto* samples = measured ? std::get_if<ScatteredSamples>(&measured->table) : nullptr;
    const std::string csv =
        write_csv(samples ? *samples : to_samples(values, isotropic, options.directions, options.max_theta));
    const auto bytes = as_bytes(csv);
    return std::vector<std::byte>(bytes.begin(), bytes.end());
}

}  // namespace srbf
