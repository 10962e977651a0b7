#include "observe/albedo_bound.h"

#include <numeric>
#include <ranges>

#include "brdf/values.h"
#include "observe/excess.h"
#include "observe/pairs.h"
#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {
namespace {

/// The views' cosθv fall from 1 to this by a constant factor. Views of the same cosine share k_light_directions.
constexpr double k_min_bounded_cosine = 1e-3;
constexpr int k_bounded_views = 36, k_light_directions = 4096;
/// In the end a model that is above this fraction of the limit is checked at more views by finer quadratures.
constexpr double k_checked_excess = 0.97;
constexpr int k_fine_views = 80, k_fine_light_directions = 16384;
constexpr double k_steepest_trusted = 80 * k_degree;
/// Albedos are brought below this fraction of the limit, so that rounding to 16 bits does not exceed it.
constexpr double k_aimed_fraction = 0.995;
/// The cost grows by this factor where a round still exceeds the bound.
constexpr double k_bound_cost_growth = 4;

double max_albedo(std::span<const Rgb> f, std::span<const double> weight) {
    return std::ranges::max(weighted_sum(f, weight));
}

PmModel lowered_at_views(const AlbedoBound& bound, PmModel model) {
    constexpr double k_lowered = 1 / 1.002;  // fraction of the limit, for rounding and for views between
    const auto lobes = std::size_t(model.lobes);
    std::vector<std::vector<double>> albedo;  // albedos of each lobe alone
    for (int j = 0; j < model.lobes; ++j) albedo.push_back(bound.albedos(evaluator(only_lobe(model, j))));
    std::vector<double> factor(lobes, 1), total(albedo[0].size());
    for (;;) {
        std::ranges::fill(total, 0);
        for (std::size_t j = 0; j < lobes; ++j)
            for (std::size_t i = 0; i < total.size(); ++i) total[i] += factor[j] * albedo[j][i];
        const auto brightest = std::size_t(std::ranges::max_element(total) - total.begin());
        if (total[brightest] <= 1) break;
        const auto concentration = [&](std::size_t j) {
            const double sum = std::accumulate(albedo[j].begin(), albedo[j].end(), 0.0);
            return factor[j] > 0 && sum > 0 ? albedo[j][brightest] / sum : 0;
        };
        const std::size_t j = std::ranges::max(std::views::iota(std::size_t(0), lobes), {}, concentration);
        factor[j] = std::max(0.0, factor[j] - (total[brightest] - k_lowered) / albedo[j][brightest]);
    }
    const std::size_t C = model.spectrum.size() / lobes;
    for (std::size_t j = 0; j < lobes; ++j) {
        Rgb& beta = model.coefficient[j];
        const auto k = float(factor[j]);
        beta = {k * beta.r, k * beta.g, k * beta.b};
        for (std::size_t c = 0; c < C; ++c) model.spectrum[j * C + c] *= k;
    }
    return model;
}

}  // namespace

double max_measured_albedo(const Observations& observations) {
    double max = 0;
    for (const ObservedIntegral& integral : observations.integrals) {
        if (integral.wv.empty() || elementary::acos(double(integral.wv[0].z)) > k_steepest_trusted) continue;
        max = std::max(max, max_albedo(integral.f, integral.weight));
    }
    return max;
}

AlbedoBound::AlbedoBound(double limit, int azimuths, Resolution resolution) : limit_(limit) {
    const bool is_fine = resolution == Resolution::fine;
    const MirrorMixture mixture(k_horizon_theta);
    const int cosines = is_fine ? k_fine_views : k_bounded_views;
    for (int i = 0; i < cosines * azimuths; ++i) {
        const double cosine = elementary::pow(k_min_bounded_cosine, double(i % cosines) / (cosines - 1));
        const Vec3d wv = spherical(elementary::acos(cosine), k_golden_angle * double(i));
        views_.push_back({to_float(wv),
                          is_fine ? albedo_quadrature(wv, k_pi / 2, k_fine_light_directions)
                                  : with_cosines(mixture.quadrature(wv, k_light_directions / azimuths)),
                          {}});
    }
}

std::vector<double> AlbedoBound::albedos(const Evaluate& model) const {
    std::vector<double> albedos;
    for (const View& view : views_)
        for (const double albedo : weighted_sum(values_towards(model, view.light.w, view.wv), view.light.weight))
            albedos.push_back(albedo / limit_);
    return albedos;
}

double AlbedoBound::excess(const Evaluate& model) const { return std::ranges::max(albedos(model)); }

ObservedIntegral AlbedoBound::bound_of(const View& view, std::vector<Rgb> values, double albedo) const {
    const auto factor = float(k_aimed_fraction * limit_ / albedo);
    ObservedIntegral bound;
    bound.wl = view.light.w;
    bound.wv.assign(bound.wl.size(), view.wv);
    bound.weight = view.light.weight;
    for (const Rgb& f : values) bound.f.push_back({factor * f.r, factor * f.g, factor * f.b});
    bound.min_unit = 1;
    bound.is_bound = true;
    return bound;
}

std::size_t AlbedoBound::add_exceeded(Observations& observations, const Evaluate& model) {
    double costs = 0;
    for (const ObservedIntegral& integral : observations.integrals) costs += integral.is_bound ? 0 : integral.cost;
    std::size_t count = 0;
    for (View& view : views_) {
        std::vector<Rgb> values = values_towards(model, view.light.w, view.wv);
        const double albedo = max_albedo(values, view.light.weight);
        if (albedo <= limit_) continue;
        ++count;
        if (view.integral) {
            observations.integrals[*view.integral].cost *= k_bound_cost_growth;
        } else {
            view.integral = observations.integrals.size();
            observations.integrals.push_back(bound_of(view, std::move(values), albedo));
            observations.integrals.back().cost = k_albedo_bound_cost * std::max(costs, 1.0);
        }
    }
    return count;
}

PmModel limit_albedo(const AlbedoBound& bound, PmModel model) {
    const auto excess = [&](const AlbedoBound& checked) { return checked.excess(evaluator(model)); };
    if (excess(bound) > 1) model = lowered_at_views(bound, std::move(model));
    if (excess(bound) < k_checked_excess) return model;
    const AlbedoBound fine(bound.limit(), 1, AlbedoBound::Resolution::fine);
    return excess(fine) > 1 ? lowered_at_views(fine, std::move(model)) : model;
}

}  // namespace
