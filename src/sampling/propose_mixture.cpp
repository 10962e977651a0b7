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

// Points for each lobe and view, and steps of the weights: at last, and in the search for shapes.
constexpr int k_points = 64, k_steps = 200, k_search_points = 12, k_search_steps = 30;
// The relative gains of the second moment that justify an anisotropy axis, and a step of a lobe's shape; the gain that
// justifies two shapes, and a variance with which no second shape is tried.
constexpr double k_least_gain = 0.01, k_least_change = 0.003, k_least_gain_of_two = 0.05, k_small_variance = 0.02;

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

/// Shapes of the even and of the odd half-vector lobes: stretches 0.8^i and powers 0.8^(2 - 2j).
struct ShapeSteps {
    std::array<int, 2> i, j;
    auto operator<=>(const ShapeSteps&) const = default;
};
ShapeSteps both(int i, int j) { return {{i, i}, {j, j}}; }
// Limits of the steps. Towards the horizon, highlights are up to a hundred times as long in the plane of incidence as
// they are wide, or far from the mirror direction.
constexpr int k_least_stretch_step = -4, k_most_stretch_step = 20, k_most_power_step = 15;
ProposalShape shape_of(const ShapeSteps& steps, const ProposalShape& start) {
    ProposalShape shape = start;
    for (std::size_t k = 0; k < 2; ++k) {
        if (!start.has_axis()) shape.lobes[k].stretch = float(elementary::pow(0.8, steps.i[k]));
        shape.lobes[k].power = float(elementary::pow(0.8, 2 - 2 * steps.j[k]));
    }
    return shape;
}
/// A wide shape, a narrow one, and a ridge across the plane of incidence. All shapes are compared by points that are
/// sampled from these.
std::array<ProposalShape, 3> sampled_shapes(const ProposalShape& start) {
    return {shape_of(both(0, 1), start), shape_of(both(4, 3), start), shape_of(both(12, 4), start)};
}

/// The search for the shape of a node. With an anisotropy axis the stretch is kept.
class NodeSearch {
  public:
    NodeSearch(const Evaluate& brdf, std::size_t node, int azimuths, const ProposalShape& start)
        : start_(start), views_(views_about(node, azimuths)) {
        // At the normal the plane of incidence is undefined.
        if (node == 0) return;
        points_ = make_points(brdf, views_, k_search_points, sampled_shapes(start));
        one_ = two_ = descend(both(stretch_step(1), 2), 0, 1);
        if (variance(one_) < k_small_variance) return;
        ShapeSteps best = one_;
        double least = std::numeric_limits<double>::infinity();
        for (int i = 1; i <= k_most_stretch_step; i += 4)
            for (int j = 0; j <= k_most_power_step; j += 5) {
                const ShapeSteps steps{{one_.i[0], stretch_step(i)}, {one_.j[0], j}};
                if (moment(steps) < least) best = steps, least = moment(steps);
            }
        two_ = settle(best);
    }
    /// Searches from the shapes of the next node, so that shapes of neighbours are alike.
    void follow(const NodeSearch& next) {
        const ShapeSteps one = descend(next.one_, 0, 1), two = settle(next.two_);
        if (moment(one) < moment(one_)) one_ = one;
        if (moment(two) < moment(two_)) two_ = two;
    }
    /// The shape that all lobes share, or two if they have less variance.
    ProposalShape shape() {
        if (points_.size() == 0) return start_;
        return shape_of(variance(two_) < variance(one_) - k_least_gain_of_two ? two_ : one_, start_);
    }
    const std::vector<Vec3f>& views() const { return views_; }

  private:
    int stretch_step(int i) const {
        return start_.has_axis() ? 0 : std::clamp(i, k_least_stretch_step, k_most_stretch_step);
    }
    double variance(const ShapeSteps& steps) { return moment(steps) / double(views_.size()) - 1; }
    /// The moment of a shape, summed over the views, from weights that begin with those of the best shape.
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
        value = moment_of(points_, cleared(weight));
        if (value < least_) least_ = value, weight_ = std::move(weight);
        return value;
    }
    /// Changes the shapes of lobes `first` to `last` while that lowers the moment.
    ShapeSteps descend(ShapeSteps best, std::size_t first, std::size_t last) {
        for (bool better = true; better;) {
            better = false;
            const ShapeSteps centre = best;
            for (int di = -1; di <= 1; ++di)
                for (int dj = -1; dj <= 1; ++dj) {
                    ShapeSteps next = centre;
                    for (std::size_t k = first; k <= last; ++k) {
                        next.i[k] = stretch_step(centre.i[k] + di);
                        next.j[k] = std::clamp(centre.j[k] + dj, 0, k_most_power_step);
                    }
                    if (moment(next) < (1 - k_least_change) * moment(best)) best = next, better = true;
                }
        }
        return best;
    }
    /// Changes the shapes of the odd and of the even lobes in turn.
    ShapeSteps settle(ShapeSteps best) {
        for (double before = 2 * moment(best); moment(best) < (1 - k_least_change) * before;) {
            before = moment(best);
            best = descend(descend(best, 1, 1), 0, 0);
        }
        return best;
    }

    ProposalShape start_;
    std::vector<Vec3f> views_;
    SamplingPoints points_;
    std::map<ShapeSteps, double> known_;
    std::vector<float> weight_;  // of the least moment
    double least_ = std::numeric_limits<double>::infinity();
    ShapeSteps one_{}, two_{};  // the best shape of all lobes, and the best two of the even and of the odd ones
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
        candidates[i] = {{shape, shape}, float(elementary::cos(azimuth)), float(elementary::sin(azimuth))};
        const SamplingPoints points = make_points(brdf, views, count, {&candidates[i], 1});
        moment[i] = moment_of(points, best_weights(points, candidates[i].components(), k_search_steps));
    });
    const auto best = std::size_t(std::min_element(moment.begin(), moment.end()) - moment.begin());
    if (!(moment[best] < (1 - k_least_gain) * moment[0])) return;
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

}  // namespace srbf
