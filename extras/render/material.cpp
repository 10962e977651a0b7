#include "extras/render/material.h"

#include <algorithm>

#include "api/table_file.h"
#include "models/bsdf/bsdf_functions.h"
#include "models/su/su_functions.h"

namespace SRBF_NAMESPACE {

namespace {

/// Sets each cell without a measurement to the mean of its measured neighbours.
void extrapolate(MerlTable& table) {
    const std::size_t n_h = table.size[0], n_d = table.size[1], n_p = table.size[2];
    const MerlTable before = table;
    const auto index = [&](std::size_t h, std::size_t d, std::size_t p) { return p + n_p * (d + n_d * h); };
    for (std::size_t h = 0; h < n_h; ++h)
        for (std::size_t d = 0; d < n_d; ++d)
            for (std::size_t p = 0; p < n_p; ++p) {
                Rgb& f = table.cells[index(h, d, p)];
                if (is_finite(f)) continue;
                Rgb sum;
                int count = 0;
                const auto add = [&](std::size_t i, std::size_t j, std::size_t k) {
                    if (i >= n_h || j >= n_d) return;
                    const Rgb& neighbour = before.cells[index(i, j, k)];
                    if (!is_finite(neighbour)) return;
                    for (int c = 0; c < 3; ++c) sum[c] += neighbour[c];
                    ++count;
                };
                add(h - 1, d, p);
                add(h + 1, d, p);
                add(h, d - 1, p);
                add(h, d + 1, p);
                add(h, d, (p + n_p - 1) % n_p);
                add(h, d, (p + 1) % n_p);
                for (int c = 0; count > 0 && c < 3; ++c) f[c] = sum[c] / float(count);
            }
}

/// The existing parts as tables.
BsdfTables tables_of(const AnyBrdf& bsdf, const Evaluate& values) {
    BsdfTables tables{{}, beams_of(bsdf)};
    for (std::size_t p = 0; p < k_parts; ++p)
        if (has_part(bsdf, Part(p)))
            tables.part[p] = std::make_shared<const MerlTable>(tabulate_merl(part_of(values, Part(p)), k_bsdf_table));
    return tables;
}

}  // namespace

MerlTable tabulate_merl(const Evaluate& brdf, std::array<std::uint32_t, 3> size) {
    MerlTable table = to_merl(brdf, size);
    for (int layer = 0; layer < 2; ++layer) extrapolate(table);
    return table;
}

Material material_of(const Model& model) {
    const auto* bsdf = std::get_if<BsdfModel>(&model.model);
    const bool has_views = bsdf && std::ranges::any_of(bsdf->part, [](const auto& part) {
                               return part && std::holds_alternative<SuModel>(part->model);
                           });
    if (has_views) return tables_of(model, evaluator(model));
    return std::visit([](const auto& content) { return Material(content); }, model.model);
}

Result<Material> material_of(const AnyBrdf& brdf, const std::string& path) {
    if (const auto* model = std::get_if<Model>(&brdf)) return material_of(*model);
    const Measured& measured = std::get<Measured>(brdf);
    if (const auto* table = std::get_if<MerlTable>(&measured.table)) return Material(*table);
    if (!is_isotropic(measured))
        return Error{path, {}, "measurement for the renderer raster", "an isotropic one", "an anisotropic one"};
    if (is_two_sided(brdf)) return Material(tables_of(brdf, evaluator(measured)));
    return Material(tabulate_merl(evaluator(measured)));
}

}  // namespace
