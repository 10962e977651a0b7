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
    return "# both sides\n" + write_csv(all, options.progress);
}

/// The values of `of`; none once it is cancelled, so that what asks for them ends soon.
Evaluate until_cancelled(Evaluate of, const ProgressToken& token) {
    return [of = std::move(of), token](auto wl, auto wv, auto f) {
        if (!token.cancelled()) of(wl, wv, f);
    };
}

std::vector<std::byte> table_bytes(const AnyBrdf& brdf, const Evaluate& values, TableFormat format, bool isotropic,
                                   const TableOptions& options) {
    switch (format) {
        case TableFormat::merl:
            return write_merl(to_merl(values, k_merl_size, options.threads));
        case TableFormat::rgl: {
            const RglTable table = to_rgl(values, {.description = options.description, .threads = options.threads});
            if (options.progress.cancelled()) return {};
            return write_rgl(table, options.spectra);
        }
        case TableFormat::mbsdf: {
            const MbsdfOptions of{.metadata = {{"description", options.description}}, .threads = options.threads};
            if (!has_part(brdf, Part::transmission_front)) return write_mbsdf(to_mbsdf(values, of));
            const MbsdfTable transmission = to_mbsdf(part_of(values, Part::transmission_front), of);
            return write_mbsdf(to_mbsdf(values, of), &transmission);
        }
        case TableFormat::csv:
            break;
    }
    const auto* measured = std::get_if<Measured>(&brdf);
    const auto* samples = measured ? std::get_if<ScatteredSamples>(&measured->table) : nullptr;
    const std::string csv =
        is_two_sided(brdf) ? csv_of_both_sides(brdf, values, isotropic, options)
        : samples          ? write_csv(*samples, options.progress)
                  : write_csv(to_samples(values, isotropic, options.directions, options.max_theta), options.progress);
    const auto bytes = as_bytes(csv);
    return {bytes.begin(), bytes.end()};
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
    if (format != TableFormat::csv && !isotropic)
        return Error{"table", {}, "input", "an isotropic BRDF", "an anisotropic one", ErrorCode::argument};
    if (is_two_sided(brdf) && (format == TableFormat::merl || format == TableFormat::rgl))
        return Error{"table", {}, "input", "a BRDF", "a BSDF", ErrorCode::argument};
    const Evaluate values = !measured                     ? evaluator(std::get<Model>(brdf))
                            : format == TableFormat::merl ? evaluator(*measured)
                                                          : signed_evaluator(*measured);
    auto bytes = table_bytes(brdf, until_cancelled(values, options.progress), format, isotropic, options);
    if (options.progress.cancelled()) return cancelled_error("table");
    return bytes;
}

}  // namespace srbf
