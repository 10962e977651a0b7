#include "fit/views/sampled_views.h"

#include <algorithm>
#include <cmath>

#include "fit/data/raw_matrix.h"
#include "fit/objective/objective.h"
#include "parallel.h"
#include "srbf/directions.h"
#include "srbf/elementary.h"
#include "srbf/pictures.h"
#include "weighted_quantile.h"

namespace srbf {
namespace {

/// Upper bound on the maximum of a lobe over the hemisphere times the cosine there, relative to the largest measured
/// such product of neighbouring views, so that a lobe between the samples cannot diverge. The bound is lower beyond
/// θmax, where no peak is needed.
constexpr double k_most_peak = 2, k_most_peak_beyond = 1;
constexpr std::size_t k_peak_views = 24;    ///< number of views on either side that count as neighbouring
constexpr std::size_t k_typical_views = 8;  ///< every eighth view tells the typical value
/// Weight of directions between those of the matrix, relative to those of the matrix, per solid angle.
constexpr double k_between = 0.1;
/// An error of 1 % in the radiances under all lights costs three channels times 1e-4 times this.
constexpr double k_light_importance = 12;
/// Of the objective's weights of highlights, and of those of radiance, relative to a view's Σ w |f|².
constexpr double k_highlights = 3, k_radiance = 0.3;
constexpr double k_elevation = 0.5;  ///< of the light beside, relative to 1
constexpr std::size_t k_phases = 36;
constexpr double k_least_sine = 0.05;  ///< of a phase whose density is uniform
constexpr std::size_t k_pixels = 256;  ///< of each view

/// The angle between light and viewer [rad].
double phase_of(Vec3f l, Vec3f v) {
    return 2 * elementary::asin(std::min(1.0, std::sqrt(double(dot(l - v, l - v))) / 2));
}

}  // namespace

SampledViews::SampledViews(const RawMatrix& matrix, Objective objective, double theta_max)
    : matrix_(matrix), objective_(objective), cos_max_(elementary::cos(theta_max)) {
    const std::size_t n = count(), m = matrix.between.size() / n;
    std::vector<Rgb> largest_of(n);
    parallel_for(n, [&](std::size_t view) {
        const auto take = [&](Vec3f w, const Rgb& value) {
            if (!within(w) || !is_finite(value)) return;
            for (int c = 0; c < 3; ++c) largest_of[view][c] = std::max(largest_of[view][c], value[c] * w.z);
        };
        for (std::size_t i = 0; i < n; ++i) take(direction(i), f(view, i));
        for (std::size_t i = view * m; i < (view + 1) * m; ++i) take(matrix.between[i].direction, matrix.between[i].f);
    });
    std::vector<Vec3f> wl, wv;
    std::vector<Rgb> some;
    for (std::size_t view = 0; view < n; view += k_typical_views)
        for (std::size_t i = 0; i < n; ++i) {
            if (!within(direction(view)) || !within(direction(i)) || !is_finite(f(view, i))) continue;
            const auto [l, v] = pair(view, direction(i));
            wl.push_back(l), wv.push_back(v), some.push_back(f(view, i));
        }
    typical_ = typical_value(objective, wl, wv, some, std::vector<double>(some.size(), 1.0));
    if (!(typical_ > 0)) typical_ = 1;  // black in those views
    if (traits(objective).of_pictures) see_pictures();
    largest_.resize(n);
    for (std::size_t view = 0; view < n; ++view)
        for (std::size_t i = view - std::min(view, k_peak_views); i < std::min(n, view + k_peak_views + 1); ++i)
            for (int c = 0; c < 3; ++c) largest_[view][c] = std::max(largest_[view][c], largest_of[i][c]);
    rows_.resize(n);
    parallel_for(n, [&](std::size_t view) { rows_[view] = rows_of(view); });
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

SampledViews::Tabulated SampledViews::tabulated(std::size_t view) const {
    const std::size_t n = count(), m = matrix_.between.size() / n;
    Tabulated of{matrix_.direction, std::vector<Rgb>(n), {}};
    for (std::size_t i = 0; i < n; ++i) of.f[i] = f(view, i);
    for (const RawMatrix::Between& between : std::span(matrix_.between).subspan(view * m, m)) {
        if (!within(between.direction) || !is_finite(between.f)) continue;
        of.direction.push_back(between.direction);
        of.f.push_back(between.f);
        of.pdf_between.push_back(double(between.pdf));
    }
    return of;
}

double SampledViews::density(double pdf_between) const {
    const double n = double(count()), m = double(matrix_.between.size()) / n;
    return n / (2 * k_pi) + m * pdf_between;
}

std::vector<double> SampledViews::solid_angles(std::size_t view, const Tabulated& of) const {
    const MirrorMixture mixture(k_pi / 2);
    std::vector<double> angles;
    for (std::size_t i = 0; i < of.direction.size(); ++i)
        angles.push_back(1 / density(i < count() ? mixture.pdf(to_double(of.direction[i]), to_double(direction(view)))
                                                 : of.pdf_between[i - count()]));
    return angles;
}

ViewRows SampledViews::rows_of(std::size_t view) const {
    const std::size_t n = count();
    const Tabulated of = tabulated(view);
    const auto& [directions, values, pdf_between] = of;
    std::vector<double> weights(directions.size(), 0.0);
    double energy = 0, highlights = 0, peak = 0, guards = 0;
    for (std::size_t i = 0; i < n; ++i) {
        if (!is_finite(values[i])) continue;
        const double cosine = double(directions[i].z);
        peak = std::max(peak, square_of(values[i]) * cosine * cosine);
        guards += !within(directions[i]);
        if (!within(directions[i])) continue;
        weights[i] = weight(view, directions[i], values[i]);
        energy += weights[i] * square_of(values[i]);
        highlights += highlight_weight(view, directions[i], values[i]) * square_of(values[i]);
    }
    const double share = highlights > 0 ? k_highlights * energy / highlights : 0;
    const auto whole_weight = [&](Vec3f w, const Rgb& value) {
        return weight(view, w, value) + share * highlight_weight(view, w, value);
    };
    energy = 0;
    for (std::size_t i = 0; i < n; ++i)
        if (weights[i] > 0) {
            weights[i] = whole_weight(directions[i], values[i]);
            energy += weights[i] * square_of(values[i]);
        }
    ViewRows rows;
    if (!(energy > 0)) return rows;
    double whole = 0;
    for (std::size_t i = 0; i < n; ++i) {
        const double cosine = double(directions[i].z);
        if (is_finite(values[i]) && !within(directions[i]))
            weights[i] = k_horizon_importance * energy * cosine * cosine / (guards * peak);
        whole += weights[i];
    }
    for (std::size_t i = n; i < directions.size(); ++i)
        weights[i] = k_between * density(0) / density(pdf_between[i - n]) * whole_weight(directions[i], values[i]);

    std::vector<double> solid_angle;
    if (traits(objective_).of_pictures) {
        solid_angle = solid_angles(view, of);
        if (within(direction(view))) add_radiance(weights, energy, view, directions, values, solid_angle);
    }
    rows.directions = DirectionRows(directions);
    rows.view = matrix_.direction[view];
    rows.scale = std::sqrt(energy / whole);
    rows.root_weight.assign(rows.directions.blocks * k_block, 0.f);
    for (auto& y : rows.y) y.assign(rows.root_weight.size(), 0.f);
    for (std::size_t i = 0; i < directions.size(); ++i) {
        if (!(weights[i] > 0)) continue;
        const double root = std::sqrt(weights[i] / whole);
        rows.root_weight[i] = float(root);
        for (int c = 0; c < 3; ++c) rows.y[std::size_t(c)][i] = float(root / rows.scale * double(values[i][c]));
    }
    if (traits(objective_).of_pictures) {
        add_lights(rows, view, directions, values, solid_angle);
        add_pixels(rows, view, directions, values, solid_angle);
    }
    rows.least_cosine = 0.5 * cos_max_;
    const double most = within(direction(view)) ? k_most_peak : k_most_peak_beyond;
    for (int c = 0; c < 3; ++c) rows.largest[std::size_t(c)] = most * double(largest_[view][c]) / rows.scale;
    return rows;
}

void SampledViews::add_radiance(std::span<double> weights, double energy, std::size_t view,
                                std::span<const Vec3f> directions, std::span<const Rgb> values,
                                std::span<const double> solid_angle) const {
    std::vector<double> added(weights.size(), 0.0);
    double sum = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
        if (!(weights[i] > 0) || !within(directions[i])) continue;
        const auto [l, v] = pair(view, directions[i]);
        added[i] = elementary::cos(phase_of(l, v) / 2) * energies_.weight(l, v, values[i], solid_angle[i]);
        sum += added[i] * square_of(values[i]);
    }
    if (!(sum > 0)) return;
    for (std::size_t i = 0; i < weights.size(); ++i) weights[i] += k_radiance * energy / sum * added[i];
}

void SampledViews::add_lights(ViewRows& rows, std::size_t view, std::span<const Vec3f> directions,
                              std::span<const Rgb> values, std::span<const double> solid_angle) const {
    const Vec3d about = to_double(direction(view));
    const Vec3d beside = normalize(Vec3d{-about.y, about.x, k_elevation});
    const std::pair<Vec3d, double> lights[] = {{about, 0}, {mirror(about), 2}, {beside, 4}, {about, 4}};
    for (const auto& [centre, kappa] : lights) {
        Aligned<float> light(rows.root_weight.size(), 0.f);
        double luminous = 0;
        for (std::size_t i = 0; i < directions.size(); ++i) {
            if (!(rows.root_weight[i] > 0) || !within(directions[i])) continue;
            const double of_light = elementary::exp(kappa * (dot(to_double(directions[i]), centre) - 1)),
                         measure = solid_angle[i] * double(directions[i].z) * of_light;
            light[i] = float(measure / double(rows.root_weight[i]));
            luminous += measure * double(luminance(values[i]));
        }
        if (!(luminous > 0)) continue;
        const auto factor = float(rows.scale / luminous * std::sqrt(k_light_importance / std::size(lights)));
        for (float& x : light) x *= factor;
        rows.lights.push_back(std::move(light));
    }
}

void SampledViews::see_pictures() {
    std::vector<std::vector<std::pair<double, double>>> lit(k_phases);  // radiances and areas of pixels
    std::vector<Vec3f> wl, wv;
    std::vector<Rgb> some;
    std::vector<double> measure;
    for (std::size_t view = 0; view < count(); view += k_typical_views) {
        if (!within(direction(view))) continue;
        const Tabulated of = tabulated(view);
        const auto& [directions, values, pdf_between] = of;
        const std::vector<double> angles = solid_angles(view, of);
        for (std::size_t i = 0; i < directions.size(); ++i) {
            if (!within(directions[i]) || !is_finite(values[i])) continue;
            const auto [l, v] = pair(view, directions[i]);
            wl.push_back(l), wv.push_back(v), some.push_back(values[i]);
            measure.push_back(angles[i] * 2 * k_pi * double(k_typical_views) / double(count()));
            const double radiance = double(std::max({values[i].r, values[i].g, values[i].b}) * l.z);
            if (i >= count() || !(radiance > 0)) continue;
            const auto phase = std::size_t(phase_of(l, v) / k_pi * double(k_phases));
            lit[std::min(phase, k_phases - 1)].emplace_back(radiance, double(v.z));
        }
    }
    energies_ = PhaseEnergies(wl, wv, some, measure);
    white_.assign(k_phases, 0.0);
    for (std::size_t phase = 0; phase < k_phases; ++phase) {
        white_[phase] = weighted_quantile(std::move(lit[phase]), k_exposed) / k_exposed_value;
        if (!(white_[phase] > 0)) white_[phase] = phase > 0 ? white_[phase - 1] : typical_;
    }
}

void SampledViews::add_pixels(ViewRows& rows, std::size_t view, std::span<const Vec3f> directions,
                              std::span<const Rgb> values, std::span<const double> solid_angle) const {
    if (!within(direction(view))) return;
    struct Pixel {
        double phase, share;
        std::size_t row;
    };
    std::vector<Pixel> pixels;
    double whole = 0;
    for (std::size_t i = 0; i < directions.size(); ++i) {
        if (!(rows.root_weight[i] > 0) || !within(directions[i])) continue;
        const auto [l, v] = pair(view, directions[i]);
        const double phase = phase_of(l, v),
                     share = solid_angle[i] * double(v.z) / std::max(elementary::sin(phase), k_least_sine);
        pixels.push_back({phase, share, i});
        whole += share;
    }
    if (pixels.empty()) return;
    std::ranges::sort(pixels, {}, [](const Pixel& pixel) { return std::pair(pixel.phase, pixel.row); });
    std::vector<Vec3f> towards;
    std::vector<Pixels::Triplet> colours;
    auto& seen = rows.seen;
    seen.exposure.assign(blocks_for(k_pixels) * k_block, 0.f);
    double sum = 0;
    for (const Pixel& pixel : pixels)
        for (sum += pixel.share;
             colours.size() < k_pixels && (double(colours.size()) + 0.5) * whole <= sum * double(k_pixels);) {
            const double at = std::clamp(pixel.phase / k_pi * double(k_phases) - 0.5, 0.0, double(k_phases - 1));
            const auto below = std::min(std::size_t(at), k_phases - 2);
            const double white = white_[below] + (at - double(below)) * (white_[below + 1] - white_[below]);
            const Vec3f w = directions[pixel.row];
            const Rgb& value = values[pixel.row];
            const double exposure = double(pair(view, w).first.z) / white;
            towards.push_back(w);
            seen.exposure[colours.size()] = float(exposure * rows.scale);
            colours.push_back({exposure * double(value.r), exposure * double(value.g), exposure * double(value.b)});
        }
    seen.directions = DirectionRows(towards);
    seen.pixels = Pixels(colours);
}

}  // namespace srbf
