#include "extras/view/lobes.h"

#include <algorithm>
#include <cmath>

#include "srbf/parameters.h"

namespace srbf {
namespace {

constexpr double k_last_ring = 89.5 * k_degree;

}  // namespace

std::vector<Vec3f> view_directions() {
    std::vector<Vec3f> all;
    for (int ring = 0; ring <= k_rings; ++ring)
        for (int i = 0; i < k_around; ++i)
            all.push_back(to_float(spherical(k_last_ring * ring / k_rings, 2 * k_pi * i / k_around)));
    return all;
}

bool is_seen_over_lights(const Model& model) {
    const auto* su = std::get_if<SuModel>(&model.model);
    return su && su->discretise == Discretise::view;
}

std::vector<SeenLobe> seen_lobes(const Model& model, Vec3f wl) {
    static const std::vector<Vec3f> views = view_directions();
    const std::vector<Vec3f> lights(views.size(), wl);
    std::vector<Rgb> f(views.size());
    std::vector<SeenLobe> lobes;
    const bool over_lights = is_seen_over_lights(model);
    double total = 0;
    for (const Model& term : terms_of(model)) {
        over_lights ? evaluate(term, views, lights, f) : evaluate(term, lights, views, f);
        SeenLobe lobe;
        double most = 0, solid_angle = 0;
        for (std::size_t i = 0; i < f.size(); ++i) {
            const double here = luminance(f[i]);
            if (here > most) most = here, lobe.centre = views[i], lobe.peak = f[i];
            lobe.relative.push_back(float(here));
        }
        if (!(most > 0)) continue;
        for (float& x : lobe.relative) x = std::min(1.f, float(double(x) / most));
        for (int ring = 0; ring <= k_rings; ++ring) {
            // Nodes of a ring represent the band up to halfway to its neighbours.
            const auto edge = [&](double at) {
                return std::cos(k_last_ring * std::clamp(at, 0.0, double(k_rings)) / k_rings);
            };
            const double cell = (edge(ring - 0.5) - edge(ring + 0.5)) * 2 * k_pi / k_around;
            for (int i = 0; i < k_around; ++i) {
                const auto at = std::size_t(ring * k_around + i);
                lobe.share += double(lobe.relative[at]) * most * double(views[at].z) * cell;
                if (lobe.relative[at] >= 0.5f) solid_angle += cell;
            }
        }
        lobe.width = std::acos(std::clamp(1 - solid_angle / (2 * k_pi), -1.0, 1.0));
        total += lobe.share;
        lobes.push_back(std::move(lobe));
    }
    for (SeenLobe& lobe : lobes) lobe.share = total > 0 ? lobe.share / total : 0;
    std::stable_sort(lobes.begin(), lobes.end(), [](const auto& a, const auto& b) { return a.share > b.share; });
    return lobes;
}

float Slice::most() const {
    float most = 0;
    for (const Rgb& value : f)
        for (int c = 0; c < 3; ++c)
            if (value[c] > most) most = value[c];
    return most;
}

Slice slice(const Evaluate& brdf, double theta_l, double phi, bool both_sides) {
    constexpr int steps = 356;  // half a degree
    Slice all;
    all.both_sides = both_sides;
    std::vector<Vec3f> wl, wv;
    for (const double normal : {0.0, 180.0})
        for (int i = 0; i <= steps && (normal == 0 || both_sides); ++i) {
            const double angle = (normal - 89 + 178.0 * i / steps) * k_degree;
            all.angle.push_back(float(angle));
            wl.push_back(to_float(spherical(theta_l, k_pi)));
            const double s = std::sin(angle);
            wv.push_back(to_float(Vec3d{s * std::cos(phi), s * std::sin(phi), std::cos(angle)}));
        }
    all.f.resize(wl.size());
    brdf(wl, wv, all.f);
    for (std::size_t i = 0; i < wl.size(); ++i)
        for (int c = 0; c < 3; ++c) all.f[i][c] *= std::abs(wv[i].z);
    return all;
}

}  // namespace srbf
