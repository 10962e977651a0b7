#include "extras/render/app/page_of.h"

#include <fmt/format.h>

#include "app/output.h"
#include "base/half.h"
#include "base/printable.h"
#include "errors/picture_errors.h"
#include "extras/render/material.h"
#include "measured/tables.h"
#include "models/kind/parameters.h"
#include "srbf/convert.h"

namespace SRBF_NAMESPACE {

namespace {

std::string kind_of(const LoadedFile& subject) {
    if (const auto* measured = std::get_if<Measured>(&subject.content))
        return fmt::format("{}, {} bytes", measured->format, grouped(measured->bytes));
    const Model& model = std::get<Model>(subject.content);
    return fmt::format("{}, {} bytes", kind_words(model), grouped(payload_bytes(model)));
}

/// The θmax [degrees] that all models have in common: their minimum.
double common_theta(const std::vector<LoadedFile>& models) {
    double min = 90;
    for (const LoadedFile& model : models)
        if (const double fitted = fitted_theta(model); fitted > 0) min = std::min(min, fitted);
    return min < 90 ? min : 80;
}

/// The material of the measurement, with its picture unless it is anisotropic. The page's note describes the loss
/// of its table.
PageMaterial measured_material(Page& page, const LoadedFile& reference, const MeasureOptions& options) {
    PageMaterial entry = shown(reference);
    entry.name = "Measured";
    if (!is_isotropic(std::get<Measured>(reference.content))) {
        page.picture_note =
            "The measurement depends on rotation about the normal and has no picture here; "
            "the plots are of one turn.";
        return entry;
    }
    const Evaluate measured = evaluator(reference);
    const MerlTable table = tabulate_merl(measured, k_page_table);
    const Evaluate pictured[] = {evaluator(table)}, symmetrised = [&](auto wl, auto wv, auto f) {
        std::vector<Rgb> swapped(f.size());
        measured(wl, wv, f);
        measured(wv, wl, swapped);
        for (std::size_t i = 0; i < f.size(); ++i)
            for (int c = 0; c < 3; ++c) f[i][c] = (f[i][c] + swapped[i][c]) / 2;
    };
    MeasureOptions numbers = options;
    numbers.pictures = false;
    const auto error_against = [&](const Evaluate& against) {
        return percent(compare(against, pictured, numbers, {})[0].heldout.squared_error_ratio_cosine);
    };
    page.picture_note = fmt::format(
        "The picture of the measurement is drawn from a table of {} × {} × {} colours made of the file, so that "
        "this page stays small. Its "
        "squared error (f cosθl, θ ≤ {:g}°) is {} against the file, and {} against the mean of the file's values "
        "with light and viewer "
        "exchanged: such a table takes them to be exchangeable. The plots and the figures below are of the file "
        "itself.",
        k_page_table[0], k_page_table[1], k_page_table[2], options.max_theta / k_degree, error_against(measured),
        error_against(symmetrised));
    if (std::ranges::any_of(table.cells, [](const Rgb& f) { return std::max({f.r, f.g, f.b}) > k_half_max; }))
        page.picture_note += fmt::format(" Values above {:g} are drawn as that.", k_half_max);
    entry.material = table;
    return entry;
}

/// Adds the errors of the models against the measurement, one row for each measure.
void add_errors(Page& page, const LoadedFile& reference, const std::vector<LoadedFile>& models,
                const MeasureOptions& options) {
    const Evaluate measured = evaluator(reference);
    std::vector<Evaluate> others;
    for (const LoadedFile& model : models) others.push_back(evaluator(model));
    const std::vector<Comparison> errors = compare(measured, others, options, {});
    const auto add_row = [&](const char* name, const char* meaning, auto&& cell_text) {
        Page::Row& row = page.table.emplace_back(Page::Row{name, meaning, {"–"}});
        for (std::size_t k = 0; k < models.size(); ++k) row.cells.push_back(cell_text(k));
    };
    add_row(
        "visible error",
        "how different pictures of a sphere look beside the measurement's: ΔE_ITP, of which 1 is just noticeable, mean "
        "over eight lightings, and the worst of them; of the measurement, where light and viewer are exchanged",
        [&](std::size_t k) {
            return fmt::format("{:.2g} (worst {:.2g}): {}", errors[k].appearance.mean.delta_e,
                               errors[k].appearance.worst_delta_e, name(verdict(errors[k].appearance.mean)));
        });
    if (const auto exchanged = reciprocity_errors(reference.content))
        page.table.back().cells[0] =
            fmt::format("{:.2g} (worst {:.2g})", exchanged->mean.delta_e, exchanged->worst_delta_e);
    add_row("image error", "what reaches an image: squared error ratio of f cosθl, each view by its cosine",
            [&](std::size_t k) { return percent(errors[k].heldout.squared_error_ratio_cosine); });
    add_row("dark-part error", "nearer to the eye, which sees the dark parts too: the same ratio of the cube root of f",
            [&](std::size_t k) { return percent(errors[k].heldout.cube_root_error_ratio); });
    add_row("raw error",
            "the same ratio of f itself, dominated by grazing angles, where f grows without bound and little is seen",
            [&](std::size_t k) { return percent(errors[k].heldout.squared_error_ratio); });
    add_row("log error", "root mean square of the differences of log(1 + f cosθl)",
            [&](std::size_t k) { return fmt::format("{:.4f}", errors[k].heldout.log_rms_cosine); });
    add_row("albedo error",
            "largest relative error of the share of light that comes back at all, from 0, 30, 60 and 75°",
            [&](std::size_t k) { return percent(errors[k].albedo_error); });
    page.table_note = fmt::format(
        "Against the measurement, at 200,000 pairs of directions within {:g}° of the normal that no fit has seen.",
        options.max_theta / k_degree);
}

/// Adds the measurement as the first material, and the errors of the models.
void add_reference(Page& page, const LoadedFile& reference, const std::vector<LoadedFile>& models) {
    const MeasureOptions options{common_theta(models) * k_degree, 0};
    page.title = stem_of(reference.path);
    page.materials.insert(page.materials.begin(), measured_material(page, reference, options));
    page.table[0].cells.insert(page.table[0].cells.begin(), grouped(std::get<Measured>(reference.content).bytes));
    add_errors(page, reference, models, options);
}

}  // namespace

PageMaterial shown(const LoadedFile& subject) {
    PageMaterial entry{
        stem_of(subject.path), kind_of(subject), {}, evaluator(subject), is_two_sided(subject.content), {}};
    if (const auto* model = std::get_if<Model>(&subject.content)) {
        entry.material = material_of(*model);
        entry.parameters = rows_text(*model);
        for (const auto& [key, text] : model->provenance)
            entry.parameters += fmt::format("  {:<36}{}\n", printable(key), printable(text));
    }
    return entry;
}

Page page_of(const std::vector<LoadedFile>& models, const LoadedFile* measured) {
    Page page;
    page.title = stem_of(models[0].path);
    page.generator = "Written by srbf " SRBF_VERSION ". This page is one file and asks nothing of the network.";
    page.table.push_back({"bytes", "", {}});
    for (const LoadedFile& model : models) {
        page.materials.push_back(shown(model));
        page.table[0].cells.push_back(grouped(payload_bytes(std::get<Model>(model.content))));
    }
    if (measured) add_reference(page, *measured, models);
    return page;
}

}  // namespace
