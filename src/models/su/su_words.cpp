// Describes a view-by-view model to programs and people.

#include <algorithm>

#include "brdf/info_rows.h"
#include "models/kind/parameters.h"
#include "models/su/su_functions.h"
#include "models/su/su_kind.h"
#include "srbf/model.h"

namespace SRBF_NAMESPACE {

std::string Kind<SuModel>::summary(const SuModel& model) {
    return fmt::format("su, {} lobes for each of {} directions to the {}, interpolation {}", model.lobes,
                       model.direction.size(), model.discretise == Discretise::view ? "viewer" : "light",
                       srbf::name(model.interpolation));
}

void Kind<SuModel>::add_rows(std::string& text, const SuModel& model) {
    const auto J = std::size_t(model.lobes);
    const bool by_view = model.discretise == Discretise::view;
    add_row(text, "model", "su: scattered univariate SRBFs, a sum of lobes for each sampled direction");
    add_row(text, "size",
            fmt::format("{} lobes × {} sampled directions to the {}, {} bytes", J, model.direction.size(),
                        by_view ? "viewer" : "light", grouped(payload_bytes(model))));
    add_row(text, "between samples",
            model.interpolation == SuInterpolation::rotated
                ? "the two adjacent in elevation, rotated to the azimuth of the direction"
                : fmt::format("the {} nearest, not rotated", model.neighbours));
    add_row(
        text, "index texture",
        fmt::format("{}, {} bytes with the direction table",
                    model.index ? fmt::format("{} of {} texels a side", srbf::name(model.index->map), model.index->size)
                                : "built on load, a cube",
                    grouped(auxiliary_bytes(model))));
    ValueRange bandwidth;
    std::size_t empty = 0;
    for (std::size_t i = 0; i < model.direction.size(); ++i) {
        const auto first = model.coefficient.begin() + std::ptrdiff_t(i * J);
        empty += std::all_of(first, first + std::ptrdiff_t(J), [](const Rgb& beta) { return beta == Rgb{}; });
    }
    for (std::size_t k = 0; k < model.bandwidth.size(); ++k)
        if (!(model.coefficient[k] == Rgb{})) bandwidth.add(model.bandwidth[k]);
    add_row(text, "empty samples", empty ? grouped(empty) : "none");
    add_row(text, "bandwidth", bandwidth.text());
    add_channel_ranges(text, "coefficient", model.coefficient);
}

Parameters Kind<SuModel>::members(const SuModel& model) {
    Parameters all{{"form", std::string(k_gaussian_in_files)},
                   {"lobes", model.lobes},
                   {"variates", 1},
                   {"axial", false},
                   {"discretise", std::string(srbf::name(model.discretise))},
                   {"directions", int(model.direction.size())},
                   {"interpolation", std::string(srbf::name(model.interpolation))},
                   {"index", {}}};
    if (model.index) all.back().value = std::string(srbf::name(model.index->map));
    return all;
}

Parameters Kind<SuModel>::parameters(const SuModel& model) {
    const std::size_t J = std::size_t(model.lobes), n = model.direction.size();
    Parameters all{{"interpolation", std::string(srbf::name(model.interpolation))},
                   {"neighbours", model.neighbours},
                   {"discretise", std::string(srbf::name(model.discretise))}};
    if (model.index) all.push_back({"index", std::string(srbf::name(model.index->map))});
    if (model.index) all.push_back({"index_size", model.index->size});
    all.push_back({"direction", array_of({n, 3}, model.direction)});
    all.push_back({"coefficient", array_of({n, J, 3}, model.coefficient)});
    all.push_back({"centre", array_of({n, J, 3}, model.centre)});
    all.push_back({"bandwidth", array_of({n, J}, model.bandwidth)});
    return all;
}

bool Kind<SuModel>::matches(const ParameterReader& reader) { return reader.has("bandwidth"); }

SuModel Kind<SuModel>::from_parameters(ParameterReader& reader) {
    SuModel model;
    model.bandwidth = reader.numbers("bandwidth", "nJ");
    model.coefficient = reader.vectors<Rgb>("coefficient", "nJ3");
    model.centre = reader.units("centre", "nJ3");
    const int n = int(reader.length('n'));
    model.lobes = int(reader.length('J'));
    if (n > 0) model.direction = fibonacci_directions(n, k_pi / 2);
    const auto is_near = [](const Vec3f& a, const Vec3f& b) { return dot(a - b, a - b) <= 1e-10f; };
    if (reader.has("direction") &&
        !std::ranges::equal(reader.vectors<Vec3f>("direction", "n3"), model.direction, is_near))
        reader.refuse("direction", "the Fibonacci set of the hemisphere", "");
    model.interpolation = *interpolation_named(reader.word("interpolation", {"rotated", "plain"}, "rotated"));
    model.discretise = *discretise_named(reader.word("discretise", {"view", "light"}, "view"));
    model.neighbours = reader.integer("neighbours", 1, k_max_neighbours, 3);
    if (!reader.has("index")) return model;
    const auto map = map_named(reader.word("index", {"cube", "parabolic"}, "cube"));
    const int size = reader.integer("index_size", 0, k_largest_texture, 0);
    if (!reader.error() && n >= k_min_views) model.index = index_texture(model, *map, size);
    return model;
}

std::string Kind<SuModel>::formula_text(const SuModel& model, const NumberText&) {
    return fmt::format("    Su su;\n    return su_rotated_value(su, {});\n",
                       model.discretise == Discretise::view ? "wl, wv" : "wv, wl");
}

}  // namespace
