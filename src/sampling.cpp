#include "srbf/sampling.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <span>

#include "parallel.h"
#include "srbf/kernel.h"

namespace srbf {
namespace {

using K = Kernel<float>;

constexpr int k_steps = 200;
constexpr int k_points = 128;           // of each lobe
constexpr double k_lowest_view = 0.02;  // cosθv at which the last node is made, for at 0 nothing is reflected
constexpr float k_least_weight = 1e-3f;

/// Splits u even in [0,1) by shares that sum to 1: the first whose running sum exceeds u, and u anew even in [0,1)
/// within it.
struct Choice {
    int k;
    float u;
};
template <typename Shares> Choice choose(const Shares& shares, float u) {
    int last = 0;
    for (int k = 0; k < int(shares.size()); ++k) {
        const float share = shares[std::size_t(k)];
        if (!(share > 0)) continue;
        if (u < share) return {k, std::min(u / share, 0x1.fffffep-1f)};
        u -= share;
        last = k;
    }
    return {last, 0x1.fffffep-1f};  // what rounding left over
}

using Weights = std::vector<double>;

/// Directions to the light, weighted to stand for ∫ dωl, and the densities of a mixture's lobes there.
struct Points {
    std::size_t lobes;
    std::vector<double> weight;   ///< (f cosθl)² times the point's solid angle, relative to the square of the albedo
    std::vector<double> density;  ///< points × lobes
};

/// What a mixture is made of, for one view.
struct Lobes {
    std::size_t count;
    std::function<Vec3f(std::size_t k, float u1, float u2)> sample;
    std::function<void(Vec3f wl, std::span<double> density)> pdf;  ///< of each of them
};

/// Adds to `points` each lobe's own lattice of `count` directions, weighted by the even mixture's density; the albedo
/// (luminance) of the view.
double add_points(const Evaluate& brdf, Vec3f wv, const Lobes& lobes, int count, Points& points) {
    std::vector<Vec3f> wl;
    std::vector<double> density;
    for (std::size_t k = 0; k < lobes.count; ++k)
        for (int i = 0; i < count; ++i) {
            const double golden = (std::sqrt(5.0) - 1) / 2;
            const Vec3f w = lobes.sample(k, (float(i) + 0.5f) / float(count), float(std::fmod(i * golden, 1.0)));
            if (!(w.z > 0)) continue;
            wl.push_back(w);
            density.resize(density.size() + lobes.count);
            lobes.pdf(w, std::span(density).last(lobes.count));
        }
    std::vector<Rgb> f(wl.size());
    brdf(wl, std::vector<Vec3f>(wl.size(), wv), f);
    double albedo = 0;
    std::vector<double> squared(wl.size());
    for (std::size_t i = 0; i < wl.size(); ++i) {
        double even = 0;
        for (std::size_t k = 0; k < lobes.count; ++k) even += density[i * lobes.count + k];
        const double reflected = is_finite(f[i]) ? luminance(f[i]) * double(wl[i].z) : 0;
        const double solid_angle = even > 0 ? 1 / (count * even) : 0;
        albedo += reflected * solid_angle;
        squared[i] = reflected * reflected * solid_angle;
    }
    for (std::size_t i = 0; i < wl.size(); ++i) {
        if (!(squared[i] > 0)) continue;
        points.weight.push_back(squared[i] / (albedo * albedo));
        const auto first = density.begin() + std::ptrdiff_t(i * lobes.count);
        points.density.insert(points.density.end(), first, first + std::ptrdiff_t(lobes.count));
    }
    return albedo;
}

/// The weights of least variance over the points, of which lobe 0 (the cosine) keeps `k_least_cosine`; without points
/// the cosine alone.
std::vector<float> best_weights(const Points& points, int steps) {
    Weights weight(points.lobes, 1 / double(points.lobes));
    if (points.weight.empty()) weight.assign(points.lobes, 0);
    for (int step = 0; step < steps && !points.weight.empty(); ++step) {
        Weights slope(points.lobes);
        for (std::size_t i = 0; i < points.weight.size(); ++i) {
            const double* density = &points.density[i * points.lobes];
            double pdf = 0;
            for (std::size_t k = 0; k < points.lobes; ++k) pdf += weight[k] * density[k];
            const double factor = points.weight[i] / (pdf * pdf);
            for (std::size_t k = 0; k < points.lobes; ++k) slope[k] += factor * density[k];
        }
        double sum = 0;
        for (std::size_t k = 0; k < points.lobes; ++k) sum += weight[k] *= std::sqrt(slope[k]);
        for (double& w : weight) w /= sum;
    }
    std::vector<float> kept(points.lobes);
    float sum = 0;
    for (std::size_t k = 0; k < points.lobes; ++k) {
        if (float(weight[k]) > k_least_weight) kept[k] = float(weight[k]);
        if (k == 0) kept[k] = std::max(kept[k], k_least_cosine);
        sum += kept[k];
    }
    for (float& w : kept) w /= sum;
    return kept;
}

/// The points of views at cosθv = z, `count` of each lobe for each of them.
Points points_at(const Evaluate& brdf, double z, int azimuths, int count, const MixtureProposal& proposal) {
    Points points{MixtureProposal::k_lobes, {}, {}};
    for (int i = 0; i < azimuths; ++i) {
        const Vec3f wv = to_float(spherical(std::acos(z), 2 * k_pi * i / azimuths)), turned = into_grain(proposal, wv);
        const Lobes lobes{points.lobes,
                          [&](std::size_t k, float u1, float u2) {
                              return out_of_grain(proposal,
                                                  K::sample_proposal_lobe(int(k), turned, proposal.stretch, u1, u2));
                          },
                          [&](Vec3f wl, std::span<double> density) {
                              const auto at = K::proposal_point(into_grain(proposal, wl), turned, proposal.stretch);
                              for (std::size_t k = 0; k < density.size(); ++k)
                                  density[k] = double(K::proposal_lobe_pdf(int(k), at));
                          }};
        add_points(brdf, wv, lobes, count, points);
    }
    return points;
}

std::vector<float> node_weights(const Evaluate& brdf, int node, int azimuths, const MixtureProposal& proposal) {
    const double x = double(node) / (MixtureProposal::k_nodes - 1), z = std::max(1 - x * x, k_lowest_view);
    return best_weights(points_at(brdf, z, azimuths, k_points, proposal), k_steps);
}

/// The second moment of f cosθl / pdf at 45° with the best weights for the proposal's stretch, over the square of its
/// mean.
double moment_stretched(const Evaluate& brdf, const MixtureProposal& proposal) {
    constexpr int azimuths = 8, count = 32, steps = 40;
    const Points points = points_at(brdf, std::sqrt(0.5), azimuths, count, proposal);
    const std::vector<float> weight = best_weights(points, steps);
    double moment = 0;
    for (std::size_t i = 0; i < points.weight.size(); ++i) {
        double pdf = 0;
        for (std::size_t k = 0; k < points.lobes; ++k) pdf += double(weight[k]) * points.density[i * points.lobes + k];
        moment += points.weight[i] / pdf;
    }
    return moment;
}

/// Sets the stretch and the grain.
void find_stretch(const Evaluate& brdf, int threads, MixtureProposal& proposal) {
    constexpr std::size_t azimuths = 12;
    std::array<MixtureProposal, azimuths * k_stretches.size()> tried;
    std::array<double, tried.size()> moment;
    parallel_for(tried.size(), threads, [&](std::size_t i) {
        const double azimuth = k_pi * double(i % azimuths) / azimuths;
        tried[i].stretch = k_stretches[i / azimuths];
        tried[i].cosine = float(std::cos(azimuth)), tried[i].sine = float(std::sin(azimuth));
        moment[i] = moment_stretched(brdf, tried[i]);
    });
    const auto best = std::size_t(std::min_element(moment.begin(), moment.end()) - moment.begin());
    if (moment[best] < 0.99 * moment[0]) proposal = tried[best];
}

}  // namespace

Vec3f sample(const CosineProposal&, Vec3f, Vec2f u, float) { return K::sample_cosine(u.x, u.y); }
float pdf(const CosineProposal&, Vec3f wl, Vec3f) { return K::cosine_pdf(wl); }

void MixtureProposal::set_weights(std::size_t node, std::span<const float, k_lobes> weight) {
    weight_[node] = {};
    running_[node].fill(2);
    float sum = 0;
    for (std::size_t k = 0; k < k_lobes; ++k) {
        weight_[node][k] = weight[k];
        running_[node][k] = sum += weight[k];
    }
}

MixtureProposal propose(const Evaluate& brdf, const ProposeOptions& options) {
    const FlushSubnormals mode;
    assert(brdf && options.azimuths >= 1);
    MixtureProposal proposal;
    if (options.azimuths > 1) find_stretch(brdf, options.threads, proposal);
    parallel_for(MixtureProposal::k_nodes, options.threads, [&](std::size_t node) {
        const std::vector<float> weight = node_weights(brdf, int(node), options.azimuths, proposal);
        proposal.set_weights(node, std::span<const float, MixtureProposal::k_lobes>(weight));
    });
    return proposal;
}

namespace {

constexpr int k_view_steps = 50, k_view_points = 32;

float folded_pdf(const ViewProposal::Lobe& lobe, Vec3f wl) {
    return K::vmf_pdf(wl, lobe.centre, lobe.bandwidth) + K::vmf_pdf({wl.x, wl.y, -wl.z}, lobe.centre, lobe.bandwidth);
}

/// A lobe times cosθ^power as a lobe about the maximum of both, where the gradient λξ + power ẑ/cosθ points along the
/// direction itself; its bandwidth is that gradient's length, the curvature across the plane of incidence.
auto about_maximum(Vec3f centre, float bandwidth, float power) {
    constexpr int k_rounds = 20;
    float cosine = 0.5f;
    K::GaussianProduct product{};
    for (int round = 0; round < k_rounds; ++round) {
        product = K::gaussian_product(centre, bandwidth, {0, 0, 1}, power / cosine);
        cosine = std::sqrt(cosine * std::clamp(product.centre.z, 1e-3f, 1.f));
    }
    return product;
}

/// Makes the lobes of sampled view i.
void propose_view(std::size_t i, ViewProposal& proposal) {
    const SuModel& model = *proposal.model;
    const auto J = std::size_t(model.lobes);
    const auto of_view = std::span(proposal.lobes).subspan(i * J, J);
    for (std::size_t j = 0; j < J; ++j) {
        const std::size_t k = i * J + j;
        const float kappa = K::su_horizon(model, int(i), int(j));
        const auto lobe = kappa > 0 ? about_maximum(model.centre[k], model.bandwidth[k], kappa + 1)
                                    : K::times_cosine(model.centre[k], model.bandwidth[k]);
        // Where the two cancel any centre does.
        of_view[j] = {lobe.bandwidth > 1e-3f ? lobe.centre : Vec3f(0, 0, 1), lobe.bandwidth, 0};
    }
    const Lobes lobes{J + 1,
                      [&](std::size_t k, float u1, float u2) {
                          if (k == 0) return K::sample_cosine(u1, u2);
                          return K::folded(K::sample_vmf(of_view[k - 1].centre, of_view[k - 1].bandwidth, u1, u2));
                      },
                      [&](Vec3f wl, std::span<double> density) {
                          density[0] = double(K::cosine_pdf(wl));
                          for (std::size_t j = 0; j < J; ++j) density[j + 1] = double(folded_pdf(of_view[j], wl));
                      }};
    const Evaluate brdf = [&](std::span<const Vec3f> wl, std::span<const Vec3f>, std::span<Rgb> f) {
        for (std::size_t k = 0; k < wl.size(); ++k) {
            const Vec3f value = K::su_view_value(model, int(i), wl[k]);
            f[k] = {value.x, value.y, value.z};
        }
    };
    Points points{lobes.count, {}, {}};
    proposal.albedo[i] = float(add_points(brdf, model.direction[i], lobes, k_view_points, points));
    const std::vector<float> weight = best_weights(points, k_view_steps);
    proposal.cosine[i] = weight[0];
    for (std::size_t j = 0; j < J; ++j) of_view[j].weight = weight[j + 1];
}

}  // namespace

ViewProposal propose(const SuModel& model, const ProposeOptions& options) {
    const FlushSubnormals mode;
    assert(model.discretise == Discretise::view);
    const std::size_t views = model.direction.size();
    ViewProposal proposal{&model, std::vector<ViewProposal::Lobe>(model.centre.size()), std::vector<float>(views),
                          std::vector<float>(views)};
    parallel_for(views, options.threads, [&](std::size_t i) { propose_view(i, proposal); });
    return proposal;
}

namespace {

/// The sampled views that a view direction is interpolated from.
struct Neighbour {
    int view = 0;
    float share = 0;             ///< of the reflected light; they sum to 1
    float cosine = 1, sine = 0;  ///< of the turn from the view direction's azimuth to the sample's
};
constexpr int k_neighbours = std::max(SU_ROTATED_NEIGHBOURS, k_most_neighbours);
std::array<Neighbour, k_neighbours> neighbours_at(const ViewProposal& proposal, Vec3f wv) {
    const SuModel& model = *proposal.model;
    std::array<Neighbour, k_neighbours> all;
    if (model.interpolation == SuInterpolation::rotated) {
        for (int k = 0; k < SU_ROTATED_NEIGHBOURS; ++k) {
            const auto part = K::su_rotated_neighbour(model, wv, k);
            all[std::size_t(k)] = {part.view, part.weight, part.cosine, part.sine};
        }
    } else {
        const NearestViews nearest = nearest_views(model, wv);
        for (int k = 0; k < model.neighbours; ++k)
            all[std::size_t(k)] = {nearest[std::size_t(k)], K::su_plain_weight(model, nearest, wv, model.neighbours, k),
                                   1, 0};
    }
    // What is black is drawn from as well, though it is of no use.
    float sum = 0;
    for (Neighbour& n : all) sum += n.share *= std::max(proposal.albedo[std::size_t(n.view)], 1e-6f);
    for (Neighbour& n : all) n.share /= sum;
    return all;
}

}  // namespace

Vec3f sample(const ViewProposal& proposal, Vec3f wv, Vec2f u, float selector) {
    const auto neighbours = neighbours_at(proposal, wv);
    std::array<float, k_neighbours> share;
    for (std::size_t k = 0; k < share.size(); ++k) share[k] = neighbours[k].share;
    const Choice of_views = choose(share, selector);
    const Neighbour& neighbour = neighbours[std::size_t(of_views.k)];
    const auto view = std::size_t(neighbour.view), J = std::size_t(proposal.model->lobes);
    std::array<float, k_most_view_lobes + 1> weights{proposal.cosine[view]};
    for (std::size_t j = 0; j < J; ++j) weights[j + 1] = proposal.lobes[view * J + j].weight;
    const Choice chosen = choose(std::span(weights).first(J + 1), of_views.u);
    if (chosen.k == 0) return K::sample_cosine(u.x, u.y);
    const ViewProposal::Lobe& lobe = proposal.lobes[view * J + std::size_t(chosen.k) - 1];
    return K::folded(
        K::turned(K::sample_vmf(lobe.centre, lobe.bandwidth, u.x, u.y), neighbour.cosine, -neighbour.sine));
}

float pdf(const ViewProposal& proposal, Vec3f wl, Vec3f wv) {
    if (!above_horizon(wl, wv)) return 0;
    const auto J = std::size_t(proposal.model->lobes);
    const float by_cosine = K::cosine_pdf(wl);
    float sum = 0;
    for (const Neighbour& neighbour : neighbours_at(proposal, wv)) {
        if (!(neighbour.share > 0)) continue;
        const auto view = std::size_t(neighbour.view);
        const Vec3f turned = K::turned(wl, neighbour.cosine, neighbour.sine);
        float of_view = proposal.cosine[view] * by_cosine;
        for (const ViewProposal::Lobe& lobe : std::span(proposal.lobes).subspan(view * J, J))
            if (lobe.weight > 0) of_view += lobe.weight * folded_pdf(lobe, turned);
        sum += neighbour.share * of_view;
    }
    return sum;
}

Vec3f sample(const Proposal& proposal, Vec3f wv, Vec2f u, float selector) {
    return std::visit([&](const auto& p) { return sample(p, wv, u, selector); }, proposal);
}
DirectionSample sample_with_pdf(const Proposal& proposal, Vec3f wv, Vec2f u, float selector) {
    if (const auto* mixture = std::get_if<MixtureProposal>(&proposal))
        return sample_with_pdf(*mixture, wv, u, selector);
    return std::visit([&](const auto& p) { return sample_with_pdf(p, wv, u, selector); }, proposal);
}
float pdf(const Proposal& proposal, Vec3f wl, Vec3f wv) {
    return std::visit([&](const auto& p) { return pdf(p, wl, wv); }, proposal);
}

Proposal propose(const Model& model, const ProposeOptions& options) {
    const auto* su = std::get_if<SuModel>(&model.model);
    if (su && su->discretise == Discretise::view) return propose(*su, options);
    return propose(evaluator(model), options);
}

}  // namespace srbf
