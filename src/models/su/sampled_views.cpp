#include "models/su/sampled_views.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/weighted_quantile.h"
#include "observe/costs.h"
#include "observe/pair_weights.h"
#include "srbf/directions.h"
#include "srbf/elementary.h"
#include "srbf/pictures.h"

namespace srbf {
namespace {

/// Upper bound on the maximum of a lobe over the hemisphere times the cosine there, relative to the largest measured
/// such product of neighbouring views, so that a lobe between the samples cannot diverge. The bound is lower beyond
/// θmax, where no peak is needed.
constexpr double k_most_peak = 2, k_most_peak_beyond = 1;
/// Number of views on either side that count as neighbouring: their cosines differ by less than 1/64 of 1536 views'.
constexpr std::size_t k_peak_views = 24;
/// A cosine counts as no less, relative to that of θmax, where a bound is divided by it.
constexpr double k_least_view_cosine = 0.5;
/// Every eighth view tells what all have in common: the typical value, the exposures, the energies of pictures. Their
/// cosines are a 192nd apart.
constexpr std::size_t k_typical_views = 8;
/// The height of the light beside the view, relative to its horizontal distance: 27° above the horizon of the normal.
constexpr double k_elevation = 0.5;
/// Of broad lights, e^{κ (w·centre − 1)}: about the mirror direction, and those beside and about the view.
constexpr double k_mirror_light = 2, k_view_light = 4;
/// Pixels of each view, a row of the loops' blocks each.
constexpr std::size_t k_pixels_of_view = 256;
/// The sine of a phase angle counts as no less, where the density of directions is divided by it: it is uniform in the
/// phase angle but for 3° about 0 and π, where few directions are.
constexpr double k_least_sine = 0.05;

/// Equal intervals of the phase angle [0, π], of 5°, for each of which pictures have an exposure.
constexpr std::size_t k_exposure_intervals = 36;

/// The angle between light and viewer [rad].
double phase_angle(Vec3f l, Vec3f v) {
    return 2 * elementary::asin(std::min(1.0, std::sqrt(double(dot(l - v, l - v))) / 2));
}

void take_largest(Rgb& largest, const Rgb& value, float factor = 1) {
    for (int c = 0; c < 3; ++c) largest[c] = std::max(largest[c], value[c] * factor);
}

}  // namespace

SampledViews::SampledViews(const RawMatrix& matrix, Objective objective, double theta_max)
    : matrix_(matrix), objective_(objective), cos_max_(elementary::cos(theta_max)) {
    find_typical();
    if (traits(objective).of_pictures) expose_pictures();
    find_largest();
    rows_.resize(count());
    parallel_for(count(), [&](std::size_t view) { rows_[view] = rows_of(view); });
}

void SampledViews::find_typical() {
    std::vector<Vec3f> wl, wv;
    std::vector<Rgb> some;
    for (std::size_t view = 0; view < count(); view += k_typical_views)
        for (std::size_t i = 0; i < count(); ++i) {
            if (!within(direction(view)) || !within(direction(i)) || !is_finite(f(view, i))) continue;
            const auto [l, v] = pair(view, direction(i));
            wl.push_back(l), wv.push_back(v), some.push_back(f(view, i));
        }
    typical_ = typical_value(objective_, wl, wv, some, std::vector<double>(some.size(), 1.0));
    if (!(typical_ > 0)) typical_ = 1;  // black in those views
}

void SampledViews::find_largest() {
    const std::size_t n = count();
    std::vector<Rgb> of_view(n);
    parallel_for(n, [&](std::size_t view) {
        const auto take = [&](Vec3f w, const Rgb& value) {
            if (within(w) && is_finite(value)) take_largest(of_view[view], value, w.z);
        };
        for (std::size_t i = 0; i < n; ++i) take(direction(i), f(view, i));
        for (const RawMatrix::Between& between : between_of(view)) take(between.direction, between.f);
    });
    largest_.resize(n);
    for (std::size_t view = 0; view < n; ++view)
        for (std::size_t i = view - std::min(view, k_peak_views); i < std::min(n, view + k_peak_views + 1); ++i)
            take_largest(largest_[view], of_view[i]);
}

std::size_t SampledViews::valid(std::size_t view) const {
    std::size_t valid = 0;
    for (std::size_t i = 0; i < count(); ++i) valid += within(direction(i)) && is_finite(f(view, i));
    return valid;
}

double SampledViews::weight(std::size_t view, Vec3f other, const Rgb& value) const {
    const auto [wl, wv] = pair(view, other);
    return traits(objective_).weight(mean_of(value), typical_, double(wl.z), double(wv.z));
}

double SampledViews::highlight_weight(std::size_t view, Vec3f other, const Rgb& value) const {
    const auto& of = traits(objective_);
    if (!of.of_pictures) return 0;
    const auto [wl, wv] = pair(view, other);
    return of.further.front().weight(mean_of(value), typical_, double(wl.z), double(wv.z));
}

std::span<const RawMatrix::Between> SampledViews::between_of(std::size_t view) const {
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
    for (const RawMatrix::Between& between : between_of(view)) {
        if (!within(between.direction) || !is_finite(between.f)) continue;
        table.direction.push_back(between.direction);
        table.f.push_back(between.f);
        table.pdf_between.push_back(double(between.pdf));
    }
    if (!traits(objective_).of_pictures) return table;
    const MirrorMixture mixture(k_pi / 2);
    for (std::size_t i = 0; i < table.f.size(); ++i)
        table.solid_angle.push_back(
            1 / density(i < n ? mixture.pdf(to_double(table.direction[i]), to_double(direction(view)))
                              : table.pdf_between[i - n]));
    return table;
}

// The weights of highlights are relative to the Σ w |f|² of the others.
SampledViews::Weights SampledViews::weights_of(const Table& table) const {
    const std::size_t n = count();
    Weights weights{std::vector<double>(table.f.size(), 0.0)};
    double energy = 0, highlights = 0, peak = 0, horizon_pairs = 0;
    for (std::size_t i = 0; i < n; ++i) {
        const Vec3f w = table.direction[i];
        const Rgb& value = table.f[i];
        if (!is_finite(value)) continue;
        peak = std::max(peak, square_of(value) * double(w.z) * double(w.z));
        horizon_pairs += !within(w);
        if (!within(w)) continue;
        weights.of_row[i] = weight(table.view, w, value);
        energy += weights.of_row[i] * square_of(value);
        highlights += highlight_weight(table.view, w, value) * square_of(value);
    }
    const double share = highlights > 0 ? k_highlights.view * energy / highlights : 0;
    const auto whole_weight = [&](std::size_t i) {
        return weight(table.view, table.direction[i], table.f[i]) +
               share * highlight_weight(table.view, table.direction[i], table.f[i]);
    };
    for (std::size_t i = 0; i < n; ++i)
        if (weights.of_row[i] > 0) {
            weights.of_row[i] = whole_weight(i);
            weights.energy += weights.of_row[i] * square_of(table.f[i]);
        }
    for (std::size_t i = 0; i < n; ++i) {
        const double cosine = double(table.direction[i].z);
        if (is_finite(table.f[i]) && !within(table.direction[i]))
            weights.of_row[i] = k_horizon_importance * weights.energy * cosine * cosine / (horizon_pairs * peak);
        weights.whole += weights.of_row[i];
    }
    for (std::size_t i = n; i < table.f.size(); ++i)
        weights.of_row[i] =
            k_between_views_directions * density(0) / density(table.pdf_between[i - n]) * whole_weight(i);
    return weights;
}

ViewRows SampledViews::rows_of(std::size_t view) const {
    const bool of_pictures = traits(objective_).of_pictures;
    const Table table = table_of(view);
    Weights weights = weights_of(table);
    ViewRows rows;
    if (!(weights.energy > 0)) return rows;
    if (of_pictures && within(direction(view))) add_point_lights(weights, table);
    rows.directions = DirectionRows(table.direction);
    rows.view = direction(view);
    rows.scale = std::sqrt(weights.energy / weights.whole);
    rows.root_weight.assign(rows.directions.blocks * k_block, 0.f);
    for (auto& y : rows.y) y.assign(rows.root_weight.size(), 0.f);
    for (std::size_t i = 0; i < table.f.size(); ++i) {
        if (!(weights.of_row[i] > 0)) continue;
        const double root = std::sqrt(weights.of_row[i] / weights.whole);
        rows.root_weight[i] = float(root);
        for (int c = 0; c < 3; ++c) rows.y[std::size_t(c)][i] = float(root / rows.scale * double(table.f[i][c]));
    }
    if (of_pictures) add_radiances(rows, table);
    if (of_pictures && within(direction(view))) add_pixels(rows, table);
    rows.least_cosine = k_least_view_cosine * cos_max_;
    const double most = within(direction(view)) ? k_most_peak : k_most_peak_beyond;
    for (int c = 0; c < 3; ++c) rows.largest[std::size_t(c)] = most * double(largest_[view][c]) / rows.scale;
    return rows;
}

// cos(φ/2) is the root of the share of the sphere's disc that is lit.
void SampledViews::add_point_lights(Weights& weights, const Table& table) const {
    std::vector<double> added(weights.of_row.size(), 0.0);
    double sum = 0;
    for (std::size_t i = 0; i < added.size(); ++i) {
        if (!(weights.of_row[i] > 0) || !within(table.direction[i])) continue;
        const auto [l, v] = pair(table.view, table.direction[i]);
        added[i] = elementary::cos(phase_angle(l, v) / 2) * energies_.weight(l, v, table.f[i], table.solid_angle[i]);
        sum += added[i] * square_of(table.f[i]);
    }
    if (!(sum > 0)) return;
    for (std::size_t i = 0; i < added.size(); ++i)
        weights.of_row[i] += k_point_lights.view * weights.energy / sum * added[i];
}

void SampledViews::add_radiances(ViewRows& rows, const Table& table) const {
    const Vec3d about = to_double(direction(table.view));
    const Vec3d beside = normalize(Vec3d{-about.y, about.x, k_elevation});
    const std::pair<Vec3d, double> lights[] = {
        {about, 0}, {mirror(about), k_mirror_light}, {beside, k_view_light}, {about, k_view_light}};
    for (const auto& [centre, kappa] : lights) {
        Aligned<float> light(rows.root_weight.size(), 0.f);
        double luminous = 0;
        for (std::size_t i = 0; i < table.f.size(); ++i) {
            const Vec3f w = table.direction[i];
            if (!(rows.root_weight[i] > 0) || !within(w)) continue;
            const double of_light = elementary::exp(kappa * (dot(to_double(w), centre) - 1)),
                         measure = table.solid_angle[i] * double(w.z) * of_light;
            light[i] = float(measure / double(rows.root_weight[i]));
            luminous += measure * double(luminance(table.f[i]));
        }
        if (!(luminous > 0)) continue;
        const auto factor = float(rows.scale / luminous * std::sqrt(k_lights_of_view / std::size(lights)));
        for (float& x : light) x *= factor;
        rows.lights.push_back(std::move(light));
    }
}

void SampledViews::expose_pictures() {
    std::vector<std::vector<std::pair<double, double>>> lit(k_exposure_intervals);  // radiances and areas of pixels
    std::vector<Vec3f> wl, wv;
    std::vector<Rgb> some;
    std::vector<double> measure;
    for (std::size_t view = 0; view < count(); view += k_typical_views) {
        if (!within(direction(view))) continue;
        const Table table = table_of(view);
        for (std::size_t i = 0; i < table.f.size(); ++i) {
            const Rgb& value = table.f[i];
            if (!within(table.direction[i]) || !is_finite(value)) continue;
            const auto [l, v] = pair(view, table.direction[i]);
            wl.push_back(l), wv.push_back(v), some.push_back(value);
            measure.push_back(table.solid_angle[i] * 2 * k_pi * double(k_typical_views) / double(count()));
            const double radiance = double(std::max({value.r, value.g, value.b}) * l.z);
            if (i >= count() || !(radiance > 0)) continue;
            const auto interval = std::size_t(phase_angle(l, v) / k_pi * double(k_exposure_intervals));
            lit[std::min(interval, k_exposure_intervals - 1)].emplace_back(radiance, double(v.z));
        }
    }
    energies_ = PhaseEnergies(wl, wv, some, measure);
    white_.assign(k_exposure_intervals, 0.0);
    for (std::size_t k = 0; k < k_exposure_intervals; ++k) {
        white_[k] = weighted_quantile(std::move(lit[k]), k_exposed) / k_exposed_value;
        if (!(white_[k] > 0)) white_[k] = k > 0 ? white_[k - 1] : typical_;
    }
}

double SampledViews::white_at(double phase_angle) const {
    constexpr double n = double(k_exposure_intervals);
    const double at = std::clamp(phase_angle / k_pi * n - 0.5, 0.0, n - 1);
    const auto below = std::min(std::size_t(at), k_exposure_intervals - 2);
    return white_[below] + (at - double(below)) * (white_[below + 1] - white_[below]);
}

// Rows in the order of their phase angles, each as often as its share of the distribution asks for.
void SampledViews::add_pixels(ViewRows& rows, const Table& table) const {
    struct Seen {
        double phase_angle, share;
        std::size_t row;
    };
    std::vector<Seen> seen;
    double whole = 0;
    for (std::size_t i = 0; i < table.f.size(); ++i) {
        if (!(rows.root_weight[i] > 0) || !within(table.direction[i])) continue;
        const auto [l, v] = pair(table.view, table.direction[i]);
        const double angle = phase_angle(l, v);
        seen.push_back({angle, table.solid_angle[i] * double(v.z) / std::max(elementary::sin(angle), k_least_sine), i});
        whole += seen.back().share;
    }
    if (seen.empty()) return;
    std::ranges::sort(seen, {}, [](const Seen& of) { return std::pair(of.phase_angle, of.row); });
    std::vector<Vec3f> towards;
    std::vector<Pixels::Triplet> colours;
    rows.pixels.exposure.assign(blocks_for(k_pixels_of_view) * k_block, 0.f);
    constexpr double n = double(k_pixels_of_view);
    double sum = 0;
    for (const Seen& of : seen) {
        sum += of.share;
        const Rgb& f = table.f[of.row];
        const Vec3f w = table.direction[of.row];
        const double exposure = double(pair(table.view, w).first.z) / white_at(of.phase_angle);
        while (colours.size() < k_pixels_of_view && (double(colours.size()) + 0.5) * whole <= sum * n) {
            rows.pixels.exposure[colours.size()] = float(exposure * rows.scale);
            towards.push_back(w);
            colours.push_back({exposure * double(f.r), exposure * double(f.g), exposure * double(f.b)});
        }
    }
    rows.pixels.directions = DirectionRows(towards);
    rows.pixels.reference = Pixels(colours);
}

}  // namespace srbf
