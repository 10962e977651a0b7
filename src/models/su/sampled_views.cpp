#include "models/su/sampled_views.h"

#include <tuple>

#include "base/parallel.h"
#include "brdf/directions.h"
#include "observe/observations.h"
#include "observe/pair_weights.h"
#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {
namespace {

/// Bounds a lobe's maximum over the hemisphere times the cosine there, relative to the largest such product that was
/// measured in neighbouring views, so that a lobe between samples cannot diverge. The bound is lower beyond θmax.
constexpr double k_max_peak = 2, k_max_peak_beyond = 1;
/// Number of neighbouring views on either side: of 1536 views, their cosines differ by less than 1/64.
constexpr std::size_t k_peak_views = 24;
/// Lower bound on the cosine by which a bound is divided, relative to the cosine of θmax.
constexpr double k_min_view_cosine = 0.5;
/// The typical value is computed from every eighth view; of 1536 views, their cosines are 1/192 apart.
constexpr std::size_t k_typical_views = 8;
/// The slope of the light beside the view, 27° above the horizon.
constexpr double k_elevation = 0.5;
/// κ of the broad lights e^{κ (w·centre − 1)} around the mirror direction, and of those beside and around the view.
constexpr double k_mirror_light = 2, k_view_light = 4;

void raise_to(Rgb& largest, const Rgb& value, float factor = 1) {
    for (int c = 0; c < 3; ++c) largest[c] = std::max(largest[c], value[c] * factor);
}

}  // namespace

SampledViews::SampledViews(const RawMatrix& matrix, Objective objective, double theta_max)
    : matrix_(matrix), objective_(objective), cos_max_(elementary::cos(theta_max)) {
    find_typical();
    find_largest();
    rows_.resize(count());
    parallel_for(count(), [&](std::size_t view) { rows_[view] = make_rows(view); });
}

void SampledViews::find_typical() {
    std::vector<Vec3f> wl, wv;
    std::vector<Rgb> values;
    for (std::size_t view = 0; view < count(); view += k_typical_views)
        for (std::size_t i = 0; i < count(); ++i) {
            if (!within(direction(view)) || !within(direction(i)) || !is_finite(f(view, i))) continue;
            const auto [l, v] = pair(view, direction(i));
            wl.push_back(l);
            wv.push_back(v);
            values.push_back(f(view, i));
        }
    typical_ = typical_value(objective_, wl, wv, values, std::vector<double>(values.size(), 1.0));
    if (!(typical_ > 0)) typical_ = 1;  // all these views are black
}

void SampledViews::find_largest() {
    const std::size_t n = count();
    std::vector<Rgb> largest(n);  // the largest product of each view
    parallel_for(n, [&](std::size_t view) {
        const auto add = [&](Vec3f w, const Rgb& value) {
            if (within(w) && is_finite(value)) raise_to(largest[view], value, w.z);
        };
        for (std::size_t i = 0; i < n; ++i) add(direction(i), f(view, i));
        for (const RawMatrix::DrawnValue& between : between_of(view)) add(between.direction, between.f);
    });
    largest_.resize(n);
    for (std::size_t view = 0; view < n; ++view)
        for (std::size_t i = view - std::min(view, k_peak_views); i < std::min(n, view + k_peak_views + 1); ++i)
            raise_to(largest_[view], largest[i]);
}

std::size_t SampledViews::valid(std::size_t view) const {
    std::size_t valid = 0;
    for (std::size_t i = 0; i < count(); ++i) valid += within(direction(i)) && is_finite(f(view, i));
    return valid;
}

std::span<const RawMatrix::DrawnValue> SampledViews::between_of(std::size_t view) const {
    const std::size_t m = matrix_.between.size() / count();
    return std::span(matrix_.between).subspan(view * m, m);
}

double SampledViews::density(double pdf_between) const {
    const double n = double(count()), m = double(matrix_.between.size()) / n;
    return n / (2 * k_pi) + m * pdf_between;
}

SampledViews::Table SampledViews::table_of(std::size_t view) const {
    const std::size_t n = count();
    Table table{view, matrix_.direction, std::vector<Rgb>(n), {}, {}};
    for (std::size_t i = 0; i < n; ++i) table.f[i] = f(view, i);
    for (const RawMatrix::DrawnValue& between : between_of(view)) {
        if (!within(between.direction) || !is_finite(between.f)) continue;
        table.direction.push_back(between.direction);
        table.f.push_back(between.f);
        table.pdf_between.push_back(double(between.pdf));
    }
    const MirrorMixture mixture(k_pi / 2);
    for (std::size_t i = 0; i < table.f.size(); ++i)
        table.solid_angle.push_back(
            1 / density(i < n ? mixture.pdf(to_double(table.direction[i]), to_double(direction(view)))
                              : table.pdf_between[i - n]));
    return table;
}

SampledViews::Weights SampledViews::weights_of(const Table& table) const {
    const std::size_t n = count(), rows = table.f.size();
    std::vector<Vec3f> wl(rows), wv(rows);
    std::vector<Rgb> f(rows);
    Weights weights{std::vector<double>(rows, 0.0)};
    double peak = 0, horizon_pairs = 0;
    for (std::size_t i = 0; i < rows; ++i) {
        const Vec3f w = table.direction[i];
        const Rgb& value = table.f[i];
        std::tie(wl[i], wv[i]) = pair(table.view, w);
        if (!is_finite(value)) continue;
        if (i < n) peak = std::max(peak, square_of(value) * double(w.z) * double(w.z));
        if (i < n) horizon_pairs += !within(w);
        if (!within(w)) continue;
        f[i] = value;
        weights.row[i] = i < n ? 1 : k_between_views_directions * density(0) / density(table.pdf_between[i - n]);
    }
    weigh(objective_, typical_, wl, wv, f, weights.row, 1);
    for (std::size_t i = 0; i < n; ++i) weights.energy += weights.row[i] * square_of(f[i]);
    for (std::size_t i = 0; i < n; ++i) {
        const double cosine = double(table.direction[i].z);
        if (is_finite(table.f[i]) && !within(table.direction[i]))
            weights.row[i] = k_horizon_importance * weights.energy * cosine * cosine / (horizon_pairs * peak);
        weights.total += weights.row[i];
    }
    return weights;
}

ViewRows SampledViews::make_rows(std::size_t view) const {
    const Table table = table_of(view);
    const Weights weights = weights_of(table);
    ViewRows rows;
    if (!(weights.energy > 0)) return rows;
    rows.directions = DirectionRows(table.direction);
    rows.scale = std::sqrt(weights.energy / weights.total);
    rows.root_weight.assign(rows.directions.blocks * k_block, 0.f);
    for (auto& y : rows.y) y.assign(rows.root_weight.size(), 0.f);
    for (std::size_t i = 0; i < table.f.size(); ++i) {
        if (!(weights.row[i] > 0)) continue;
        const double root = std::sqrt(weights.row[i] / weights.total);
        rows.root_weight[i] = float(root);
        for (int c = 0; c < 3; ++c) rows.y[std::size_t(c)][i] = float(root / rows.scale * double(table.f[i][c]));
    }
    if (traits(objective_).uses_pictures) add_radiances(rows, table);
    rows.min_cosine = k_min_view_cosine * cos_max_;
    const double max = within(direction(view)) ? k_max_peak : k_max_peak_beyond;
    for (int c = 0; c < 3; ++c) rows.largest[std::size_t(c)] = max * double(largest_[view][c]) / rows.scale;
    return rows;
}

void SampledViews::add_radiances(ViewRows& rows, const Table& table) const {
    const Vec3d view = to_double(direction(table.view));
    const Vec3d beside = normalize(Vec3d{-view.y, view.x, k_elevation});
    const std::pair<Vec3d, double> lights[] = {
        {view, 0}, {mirror(view), k_mirror_light}, {beside, k_view_light}, {view, k_view_light}};
    for (const auto& [centre, kappa] : lights) {
        Aligned<float> light(rows.root_weight.size(), 0.f);
        double radiance = 0;
        for (std::size_t i = 0; i < table.f.size(); ++i) {
            const Vec3f w = table.direction[i];
            if (!(rows.root_weight[i] > 0) || !within(w)) continue;
            const double intensity = elementary::exp(kappa * (dot(to_double(w), centre) - 1)),
                         measure = table.solid_angle[i] * double(w.z) * intensity;
            light[i] = float(measure / double(rows.root_weight[i]));
            radiance += measure * double(luminance(table.f[i]));
        }
        if (!(radiance > 0)) continue;
        const auto factor = float(rows.scale / radiance * std::sqrt(k_lights_of_view / std::size(lights)));
        for (float& x : light) x *= factor;
        rows.lights.push_back(std::move(light));
    }
}

}  // namespace
