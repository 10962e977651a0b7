// The search for the numbers of a mixture that samples a BRDF.
#include <cassert>
#include <limits>
#include <map>

#include "base/parallel.h"
#include "sampling/mixture.h"
#include "sampling/sampling_points.h"
#include "srbf/elementary.h"
#include "srbf/kernel.h"
#include "srbf/sampling.h"

namespace SRBF_NAMESPACE {
namespace {

// Numbers of points for each lobe and view, and of steps of the weights. The search for shapes uses fewer.
constexpr int k_points = 64, k_steps = 200;
constexpr int k_search_points = 12, k_search_steps = 30;
// The relative gains of the second moment that justify an anisotropy axis, and a step of a lobe's shape.
constexpr double k_min_gain = 0.01, k_min_change = 0.003;

/// Views at cosθv = z.
std::vector<Vec3f> views_at(double z, int azimuths) {
    std::vector<Vec3f> views;
    for (int i = 0; i < azimuths; ++i)
        views.push_back(to_float(spherical(elementary::acos(z), 2 * k_pi * i / azimuths)));
    return views;
}

/// cosθv at a position between nodes.
double node_cosine(double position) {
    return Kernel<double>::mixture_cosine(position / (MixtureProposal::k_nodes - 1));
}

/// The views at a node and a third of the way to its neighbours, because a table's highlights differ between
/// measured views.
std::vector<Vec3f> views_about(std::size_t node, int azimuths) {
    std::vector<Vec3f> views;
    for (const double offset : {-1. / 3, 0., 1. / 3}) {
        const double position = double(node) + offset;
        if (position < 0 || position > MixtureProposal::k_nodes - 1) continue;
        const std::vector<Vec3f> shifted = views_at(node_cosine(position), azimuths);
        views.insert(views.end(), shifted.begin(), shifted.end());
    }
    return views;
}

/// A shape of half-vector lobes: the stretch 0.8^i and the power 0.8^(2 - 2j).
struct ShapeSteps {
    int i, j;
    auto operator<=>(const ShapeSteps&) const = default;
};
// Limits of the steps. Towards the horizon, highlights are up to a hundred times as long in the plane of incidence as
// they are wide, or far from the mirror direction.
constexpr int k_min_stretch_step = -4, k_max_stretch_step = 20, k_max_power_step = 15;
ProposalShape shape_of(const ShapeSteps& steps, const ProposalShape& start) {
    ProposalShape shape = start;
    if (!start.has_axis()) shape.lobes.stretch = float(elementary::pow(0.8, steps.i));
    shape.lobes.power = float(elementary::pow(0.8, 2 - 2 * steps.j));
    return shape;
}
/// A wide shape, a narrow one, and a ridge across the plane of incidence. All shapes are compared by points that are
/// sampled from these.
std::array<ProposalShape, 3> sampled_shapes(const ProposalShape& start) {
    return {shape_of({0, 1}, start), shape_of({4, 3}, start), shape_of({12, 4}, start)};
}

/// The search for the shape of a node. With an anisotropy axis the stretch is kept.
class NodeSearch {
  public:
    NodeSearch(const Evaluate& brdf, std::size_t node, int azimuths, const ProposalShape& start)
        : start_(start), views_(views_about(node, azimuths)) {
        // At the normal the plane of incidence is undefined.
        if (node == 0) return;
        points_ = make_points(brdf, views_, k_search_points, sampled_shapes(start));
        best_ = descend({stretch_step(1), 2});
    }
    /// Searches from the shape of the next node too, so that shapes of neighbours are alike.
    void follow(const NodeSearch& next) {
        const ShapeSteps other = descend(next.best_);
        if (moment(other) < moment(best_)) best_ = other;
    }
    ProposalShape shape() const { return points_.size() == 0 ? start_ : shape_of(best_, start_); }
    const std::vector<Vec3f>& views() const { return views_; }

  private:
    int stretch_step(int i) const {
        return start_.has_axis() ? 0 : std::clamp(i, k_min_stretch_step, k_max_stretch_step);
    }
    /// The moment of a shape, summed over the views. The weights begin with the weights of the best shape.
    double moment(const ShapeSteps& steps) {
        double& value = known_[steps];
        if (value > 0) return value;
        set_densities(points_, shape_of(steps, start_));
        std::vector<float> weight = weight_.empty() ? uniform_weights(points_.density.size()) : weight_;
        for (float& w : weight) w = 0.9f * w + 0.1f / float(weight.size());
        // Most shapes are far from the best one, which a few steps show.
        value = improve(points_, 4, weight);
        if (value > 1.1 * least_) return value;
        improve(points_, 8, weight);
        value = moment_of(points_, drop_small_weights(weight));
        if (value < least_) least_ = value, weight_ = std::move(weight);
        return value;
    }
    /// Changes the shape while that lowers the moment.
    ShapeSteps descend(ShapeSteps best) {
        for (bool better = true; better;) {
            better = false;
            const ShapeSteps centre = best;
            for (int di = -1; di <= 1; ++di)
                for (int dj = -1; dj <= 1; ++dj) {
                    const ShapeSteps next{stretch_step(centre.i + di), std::clamp(centre.j + dj, 0, k_max_power_step)};
                    if (moment(next) < (1 - k_min_change) * moment(best)) best = next, better = true;
                }
        }
        return best;
    }

    ProposalShape start_;
    std::vector<Vec3f> views_;
    SamplingPoints points_;
    std::map<ShapeSteps, double> known_;
    std::vector<float> weight_;  // weights of the least moment
    double least_ = std::numeric_limits<double>::infinity();
    ShapeSteps best_{};
};

/// Computes the shapes and weights of all nodes.
void make_nodes(const Evaluate& brdf, const ProposeOptions& options, MixtureProposal& proposal) {
    constexpr std::size_t nodes = MixtureProposal::k_nodes;
    std::array<std::optional<NodeSearch>, nodes> search;
    parallel_for(nodes, options.threads, [&](std::size_t node) {
        const ProposalShape start{proposal.shape[node], proposal.cosine, proposal.sine, proposal.facets};
        search[node].emplace(brdf, node, options.azimuths, start);
    });
    for (std::size_t node = nodes - 1; node-- > 1;) search[node]->follow(*search[node + 1]);
    parallel_for(nodes, options.threads, [&](std::size_t node) {
        const ProposalShape shape = search[node]->shape();
        const SamplingPoints points = make_points(brdf, search[node]->views(), k_points, {&shape, 1});
        const std::vector<float> weight = best_weights(points, shape.components(), k_steps);
        proposal.set_weights(node, std::span(weight).first<MixtureProposal::k_lobes>());
        std::copy(weight.begin() + MixtureProposal::k_lobes, weight.end(), proposal.facet_weight[node].begin());
        proposal.shape[node] = shape.lobes;
    });
}

/// Sets the anisotropy axis and the stretch along it.
void find_axis(const Evaluate& brdf, int threads, MixtureProposal& proposal) {
    constexpr std::size_t azimuths = 12;
    constexpr int count = 32;
    const std::vector<Vec3f> views = views_at(std::sqrt(0.5), 8);
    std::array<ProposalShape, azimuths * k_stretches.size()> candidates;
    std::array<double, candidates.size()> moment;
    parallel_for(candidates.size(), threads, [&](std::size_t i) {
        const double azimuth = k_pi * double(i % azimuths) / azimuths;
        const HalfVectorShape shape{k_stretches[i / azimuths], 1};
        candidates[i] = {shape, float(elementary::cos(azimuth)), float(elementary::sin(azimuth))};
        const SamplingPoints points = make_points(brdf, views, count, {&candidates[i], 1});
        moment[i] = moment_of(points, best_weights(points, candidates[i].components(), k_search_steps));
    });
    const auto best = std::size_t(std::min_element(moment.begin(), moment.end()) - moment.begin());
    if (!(moment[best] < (1 - k_min_gain) * moment[0])) return;
    proposal.shape.fill(candidates[best].lobes);
    proposal.cosine = candidates[best].cosine, proposal.sine = candidates[best].sine;
}

}  // namespace

MixtureProposal propose(const Evaluate& brdf, const ProposeOptions& options) {
    const StandardArithmetic mode;
    assert(brdf && options.azimuths >= 1);
    MixtureProposal proposal;
    proposal.facets = options.facets;
    if (options.azimuths > 1) find_axis(brdf, options.threads, proposal);
    make_nodes(brdf, options, proposal);
    return proposal;
}

}  // namespace
