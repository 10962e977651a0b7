#include "srbf/load.h"

#include <filesystem>

#include "measured/bytes.h"
#include "model/texel.h"
#include "srbf/convert.h"
#include "srbf/file.h"
#include "srbf/text.h"

namespace srbf {

namespace {

/// The stack and the texel that "FILE#T" names.
struct TexelName {
    std::string file;
    std::uint64_t texel;
};
std::optional<TexelName> texel_named(const std::string& path) {
    const auto sign = path.rfind('#');
    std::error_code none;
    if (sign == path.npos || std::filesystem::exists(path, none)) return {};
    const auto texel = to_number<std::uint64_t>(std::string_view(path).substr(sign + 1));
    if (!texel) return {};
    return TexelName{path.substr(0, sign), *texel};
}

Result<AnyBrdf> any(Result<Model> model) {
    if (!model) return model.error();
    return AnyBrdf(*std::move(model));
}

}  // namespace

Result<AnyBrdf> load_brdf(const std::string& path) {
    return within_memory(path, [&]() -> Result<AnyBrdf> {
        const auto of_stack = texel_named(path);
        auto bytes = read_file(of_stack ? of_stack->file : path, most_bytes_of);
        if (!bytes) return bytes.error();
        if (of_stack) return any(read_texel(*bytes, of_stack->texel, path));
        if (is_safetensors(*bytes)) return any(read_model(*bytes, path));
        auto measured = read_measured(*std::move(bytes), path);
        if (!measured) return measured.error();
        return AnyBrdf(*std::move(measured));
    });
}

bool is_two_sided(const AnyBrdf& brdf) {
    if (const auto* measured = std::get_if<Measured>(&brdf)) return std::holds_alternative<BsdfTable>(measured->table);
    return std::holds_alternative<BsdfModel>(std::get<Model>(brdf).model);
}

bool has_part(const AnyBrdf& brdf, Part part) {
    if (const auto* measured = std::get_if<Measured>(&brdf)) {
        if (const auto* bsdf = std::get_if<BsdfTable>(&measured->table))
            return answering(bsdf->band().part, part).brdf != nullptr;
    } else if (const auto* bsdf = std::get_if<BsdfModel>(&std::get<Model>(brdf).model)) {
        return answering(bsdf->part, part).brdf != nullptr;
    }
    return part == Part::reflection_front;
}

namespace {

/// CSV of all parts.
std::string csv_of_both_sides(const AnyBrdf& brdf, const Evaluate& values, bool isotropic,
                              const TableOptions& options) {
    ScatteredSamples all;
    all.isotropic = isotropic;
    for (std::size_t p = 0; p < k_parts; ++p) {
        const Part part = Part(p);
        if (!has_part(brdf, part)) continue;
        const ScatteredSamples samples =
            to_samples(part_of(values, part), isotropic, options.directions, options.max_theta);
        for (std::size_t i = 0; i < samples.wl.size(); ++i) {
            all.wl.push_back(to_side(samples.wl[i], side_of_light(part)));
            all.wv.push_back(to_side(samples.wv[i], side_of_viewer(part)));
            all.colour.push_back(samples.colour[i]);
        }
    }
    return "# both sides\n" + write_csv(all);
}

}  // namespace

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
    const bool two_sided = is_two_sided(brdf);
    if (two_sided && (format == TableFormat::merl || format == TableFormat::rgl))
        return Error{"table", {}, "input", "a BRDF", "a BSDF", ErrorCode::argument};
    switch (format) {
        case TableFormat::merl:
            return write_merl(to_merl(measured ? evaluator(*measured) : values, k_merl_size, options.threads));
        case TableFormat::rgl:
            return write_rgl(to_rgl(values, {.description = options.description, .threads = options.threads}),
                             options.spectra);
        case TableFormat::mbsdf: {
            const MbsdfOptions of{.metadata = {{"description", options.description}}, .threads = options.threads};
            if (!has_part(brdf, Part::transmission_front)) return write_mbsdf(to_mbsdf(values, of));
            const MbsdfTable transmission = to_mbsdf(part_of(values, Part::transmission_front), of);
            return write_mbsdf(to_mbsdf(values, of), &transmission);
        }
        case TableFormat::csv:
            break;
    }
    if (two_sided) {
        const std::string text = csv_of_both_sides(brdf, values, isotropic, options);
        const auto bytes = as_bytes(text);
        return std::vector<std::byte>(bytes.begin(), bytes.end());
    }
    const auto* samples = measured ? std::get_if<ScatteredSamples>(&measured->table) : nullptr;
    const std::string csv =
        write_csv(samples ? *samples : to_samples(values, isotropic, options.directions, options.max_theta));
    const auto bytes = as_bytes(csv);
    return std::vector<std::byte>(bytes.begin(), bytes.end());
}

}  // namespace srbf
