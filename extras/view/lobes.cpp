#include "extras/view/lobes.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace srbf {
namespace {

/// The indices of the `max_count` largest weights, in decreasing order.
std::vector<std::size_t> largest(const std::vector<double>& weight, std::size_t max_count) {
    std::vector<std::size_t> order(weight.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return weight[a] > weight[b]; });
    order.resize(std::min(order.size(), max_count));
    return order;
}

std::vector<Model> terms(const PmModel& model, std::size_t max_count) {
    const auto J = std::size_t(model.lobes), N = std::size_t(model.variates), F = std::size_t(features(model.form));
    std::vector<double> weight;
    for (std::size_t j = 0; j < J; ++j)
        weight.push_back(luminance(model.coefficient[j]) * std::exp(double(model.log_scale[j])));
    std::vector<Model> one_lobe_models;
    for (const std::size_t j : largest(weight, max_count)) {
        const auto part = [j](const auto& numbers, std::size_t count) {
            const auto first = numbers.begin() + std::ptrdiff_t(j * count);
            return std::remove_cvref_t<decltype(numbers)>(first, first + std::ptrdiff_t(count));
        };
        PmModel term = model;
        term.lobes = 1;
        term.coefficient = part(model.coefficient, 1);
        term.wavelength.clear(), term.spectrum.clear();
        term.log_scale = part(model.log_scale, 1);
        term.centre = part(model.centre, N);
        term.bandwidth = part(model.bandwidth, N);
        term.exponent = part(model.exponent, F);
        one_lobe_models.emplace_back().model = std::move(term);
    }
    return one_lobe_models;
}

std::vector<Model> terms(const SuModel& model, std::size_t max_count) {
    std::vector<Model> one_lobe_models;
    for (int j = 0; j < model.lobes && one_lobe_models.size() < max_count; ++j) {
        SuModel term = model;
        for (std::size_t i = 0; i < term.coefficient.size(); ++i)
            if (int(i % std::size_t(model.lobes)) != j) term.coefficient[i] = {};
        one_lobe_models.emplace_back().model = std::move(term);
    }
    return one_lobe_models;
}

std::vector<Model> terms(const GgxModel& model, std::size_t) {
    GgxModel black = model;
    black.diffuse = {};
    for (GgxModel::Lobe& lobe : black.lobes) lobe.f0 = {}, lobe.f90 = 0;
    std::vector<Model> models;
    GgxModel diffuse = black;
    diffuse.diffuse = model.diffuse;
    models.push_back({diffuse, {}});
    for (std::size_t i = 0; i < model.lobes.size(); ++i) {
        GgxModel term = black;
        term.lobes[i] = model.lobes[i];
        models.push_back({term, {}});
    }
    return models;
}

/// The layers of a surface are not terms of a sum. Instead, these are the surface, the surface without fuzz, and
/// the one without fuzz and coat.
std::vector<Model> terms(const OpenPbrModel& model, std::size_t) {
    std::vector<Model> layers{{model, {}}};
    for (float OpenPbrModel::*const weight : {&OpenPbrModel::fuzz_weight, &OpenPbrModel::coat_weight}) {
        OpenPbrModel reduced = std::get<OpenPbrModel>(layers.back().model);
        if (reduced.*weight == 0) continue;
        reduced.*weight = 0;
        layers.push_back({reduced, {}});
    }
    return layers;
}

constexpr double k_last_ring = 89.5 * k_degree;

}  // namespace

std::vector<Model> terms_of(const Model& model, std::size_t max_count) {
    if (const auto* bsdf = std::get_if<BsdfModel>(&model.model)) {
        const Answering<Model> front = answering(bsdf->part, Part::reflection_front);
        return front.brdf ? terms_of(*front.brdf, max_count) : std::vector<Model>{};
    }
    return std::visit(
        [&](const auto& content) -> std::vector<Model> {
            if constexpr (std::is_same_v<decltype(content), const BsdfModel&>)
                return {};
            else
                return terms(content, max_count);
        },
        model.model);
}

std::vector<Vec3f> view_directions() {
    std::vector<Vec3f> directions;
    for (int ring = 0; ring <= k_rings; ++ring)
        for (int i = 0; i < k_ring_azimuths; ++i)
            directions.push_back(to_float(spherical(k_last_ring * ring / k_rings, 2 * k_pi * i / k_ring_azimuths)));
    return directions;
}

bool is_over_lights(const Model& model) {
    const auto* su = std::get_if<SuModel>(&model.model);
    return su && su->discretise == Discretise::view;
}

std::vector<LobeSlice> lobe_slices(const Model& model, Vec3f wl) {
    static const std::vector<Vec3f> views = view_directions();
    const std::vector<Vec3f> lights(views.size(), wl);
    std::vector<Rgb> f(views.size());
    std::vector<LobeSlice> lobes;
    const bool over_lights = is_over_lights(model);
    double total = 0;
    for (const Model& term : terms_of(model)) {
        over_lights ? evaluate(term, views, lights, f) : evaluate(term, lights, views, f);
        LobeSlice lobe;
        double peak_luminance = 0, solid_angle = 0;
        for (std::size_t i = 0; i < f.size(); ++i) {
            const double luminance_here = luminance(f[i]);
            if (luminance_here > peak_luminance)
                peak_luminance = luminance_here, lobe.centre = views[i], lobe.peak = f[i];
            lobe.relative.push_back(float(luminance_here));
        }
        if (!(peak_luminance > 0)) continue;
        for (float& x : lobe.relative) x = std::min(1.f, float(double(x) / peak_luminance));
        for (int ring = 0; ring <= k_rings; ++ring) {
            // A node of a ring represents the band up to halfway to the adjacent rings.
            const auto edge = [&](double position) {
                return std::cos(k_last_ring * std::clamp(position, 0.0, double(k_rings)) / k_rings);
            };
            const double cell = (edge(ring - 0.5) - edge(ring + 0.5)) * 2 * k_pi / k_ring_azimuths;
            for (int i = 0; i < k_ring_azimuths; ++i) {
                const auto index = std::size_t(ring * k_ring_azimuths + i);
                lobe.share += double(lobe.relative[index]) * peak_luminance * double(views[index].z) * cell;
                if (lobe.relative[index] >= 0.5f) solid_angle += cell;
            }
        }
        lobe.width = std::acos(std::clamp(1 - solid_angle / (2 * k_pi), -1.0, 1.0));
        total += lobe.share;
        lobes.push_back(std::move(lobe));
    }
    for (LobeSlice& lobe : lobes) lobe.share = total > 0 ? lobe.share / total : 0;
    std::stable_sort(lobes.begin(), lobes.end(), [](const auto& a, const auto& b) { return a.share > b.share; });
    return lobes;
}

float Slice::most() const {
    float max_value = 0;
    for (const Rgb& value : f)
        for (int c = 0; c < 3; ++c)
            if (value[c] > max_value) max_value = value[c];
    return max_value;
}

Slice slice(const Evaluate& brdf, double theta_l, double phi, bool both_sides) {
    constexpr int steps = 356;  // half a degree
    Slice result;
    result.both_sides = both_sides;
    std::vector<Vec3f> wl, wv;
    for (const double normal : {0.0, 180.0})
        for (int i = 0; i <= steps && (normal == 0 || both_sides); ++i) {
            const double angle = (normal - 89 + 178.0 * i / steps) * k_degree;
            result.angle.push_back(float(angle));
            wl.push_back(to_float(spherical(theta_l, k_pi)));
            const double s = std::sin(angle);
            wv.push_back(to_float(Vec3d{s * std::cos(phi), s * std::sin(phi), std::cos(angle)}));
        }
    result.f.resize(wl.size());
    brdf(wl, wv, result.f);
    for (std::size_t i = 0; i < wl.size(); ++i)
        for (int c = 0; c < 3; ++c) result.f[i][c] *= std::abs(wv[i].z);
    return result;
}

}  // namespace srbf
