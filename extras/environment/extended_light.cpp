#include "srbf/extended_light.h"

#include <cassert>

#include "base/parallel.h"
#include "extras/environment/lobe_tracks.h"
#include "sampling/elevation_nodes.h"

namespace SRBF_NAMESPACE {

namespace {

using Lobe = ExtendedLight::Lobe;
using Eigen::MatrixXd;

}  // namespace

double ExtendedLight::cosine(int node) { return elevation_cosine(double(node) / (k_views - 1)); }

std::vector<Lobe> lobes_at(const ExtendedLight& light, float cos_v) {
    const float position = elevation_coordinate(cos_v) * float(ExtendedLight::k_views - 1);
    const auto below = std::size_t(std::clamp(int(position), 0, ExtendedLight::k_views - 2)),
               K = std::size_t(light.lobes);
    const float fraction = position - float(below);
    const auto mix = [&](float x, float y) { return x + fraction * (y - x); };
    const Rgb total = albedo(light.brdf, cos_v);
    std::vector<Lobe> lobes;
    for (std::size_t k = 0; k < K; ++k) {
        const Lobe &a = light.lobe[below * K + k], &b = light.lobe[(below + 1) * K + k];
        Lobe& lobe = lobes.emplace_back(Lobe{mix(a.axis, b.axis), mix(a.roughness, b.roughness), {}});
        for (int c = 0; c < 3; ++c) lobe.weight[c] = std::min(total[c], 1.f) * mix(a.weight[c], b.weight[c]);
    }
    return lobes;
}

Vec3f axis_of(const Lobe& lobe, const Vec3f& wv) {
    const float p = lobe.axis;
    return {-p * wv.x, -p * wv.y, std::sqrt(std::max(1 - p * p * (1 - wv.z * wv.z), 0.f))};
}

ExtendedLight extended_light(const PreparedBrdf& brdf, const ExtendedLightOptions& options) {
    assert(options.lobes >= k_min_extended_lobes && options.lobes <= k_max_extended_lobes);
    const BlurredKernels kernels(options.levels, options.threads);
    const AveragedBrdf averaged(brdf, options.isotropic);
    std::vector<LitView> views(ExtendedLight::k_views);
    parallel_for(views.size(), options.threads,
                 [&](std::size_t v) { views[v] = lit_view(averaged, fitted_cosine(v)); });
    const LobeTracks tracks(views, kernels, options.lobes, options.fixed, options.threads);
    const MatrixXd fractions = fractions_of(views, kernels, tracks);
    ExtendedLight light{options.lobes, {}, {}, brdf};
    const int others = options.lobes - 1;
    for (std::size_t v = 0; v < views.size(); ++v) {
        light.width.push_back(views[v].width);
        const std::size_t first = light.lobe.size();
        light.lobe.push_back({0, 1, {1, 1, 1}});
        for (int k = 0; k < others; ++k) {
            Lobe& lobe = light.lobe.emplace_back(Lobe{float(tracks[v][2 * k]), float(tracks[v][2 * k + 1]), {}});
            for (int c = 0; c < 3; ++c) {
                lobe.weight[c] = float(fractions(Eigen::Index(v) * others + k, c));
                light.lobe[first].weight[c] -= lobe.weight[c];
            }
        }
    }
    return light;
}

}  // namespace
