#include "extras/view/lobes.h"

#include <algorithm>
#include <cmath>

#include "models/kind/parameters.h"
#include "models/su/su_functions.h"

namespace SRBF_NAMESPACE {
namespace {

constexpr double k_last_ring = 89.5 * k_degree;

}  // namespace

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
