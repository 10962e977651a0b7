#include "samples/near_samples.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/k_d_tree.h"
#include "samples/folds.h"
#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {
namespace {

/// Maps a pair to a point such that distances between points are √(|Δωl|² + |Δωv|²), to first order. For isotropic
/// samples this is the minimum over all rotations about the normal and reflections.
std::array<double, 6> point_of(Vec3f l, Vec3f v, bool isotropic) {
    constexpr double least = 1e-30;  // avoids a division by 0 where both directions are the normal
    const Vec3d wl = to_double(l), wv = to_double(v);
    if (!isotropic) return {wl.x, wl.y, wl.z, wv.x, wv.y, wv.z};
    const double rl = elementary::hypot(wl.x, wl.y), rv = elementary::hypot(wv.x, wv.y),
                 norm = std::max(elementary::hypot(rl, rv), least);
    // Under a relative rotation by δ the distance is rl rv / √(rl² + rv²) δ, distributed over both directions.
    const double across = std::abs(wl.x * wv.y - wl.y * wv.x) / norm, along = (wl.x * wv.x + wl.y * wv.y) / norm;
    return {rl, wl.z, rv, wv.z, along, across};
}

double squared_distance(const std::array<double, 6>& a, const std::array<double, 6>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
    return sum;
}

/// The squared distance to the nearest point of the box low..high. Even when rounded, it is no larger than the
/// distance to any point in the box.
double squared_distance(const std::array<double, 6>& a, const std::array<double, 6>& low,
                        const std::array<double, 6>& high) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double outside = std::max({low[i] - a[i], a[i] - high[i], 0.0});
        sum += outside * outside;
    }
    return sum;
}

}  // namespace

NearSamples::NearSamples(const ScatteredSamples& samples) {
    PointCloud<double, 6> points;
    for (std::size_t i = 0; i < samples.wl.size(); ++i)
        points.coordinates.push_back(point_of(samples.wl[i], samples.wv[i], samples.isotropic));
    first_ = first_coincident_points(points);
    for (std::size_t i = 0; i < first_.size(); ++i) {
        if (first_[i] != i) continue;
        sample_.push_back(std::uint32_t(i));
        point_.push_back(points.coordinates[i]);
        point_.push_back(point_of(samples.wv[i], samples.wl[i], samples.isotropic));
    }
    order_.resize(point_.size()), place_.resize(point_.size());
    std::iota(order_.begin(), order_.end(), 0u);
    if (!order_.empty()) build(0, std::uint32_t(order_.size()));
    for (std::uint32_t position = 0; position < order_.size(); ++position) place_[order_[position]] = position;
}

std::uint32_t NearSamples::build(std::uint32_t begin, std::uint32_t end) {
    const auto number = std::uint32_t(node_.size());
    Node node{point_[order_[begin]], point_[order_[begin]], begin, end};
    node.ungrouped = end - begin;
    for (std::uint32_t position = begin; position < end; ++position)
        for (std::size_t i = 0; i < node.low.size(); ++i) {
            node.low[i] = std::min(node.low[i], point_[order_[position]][i]);
            node.high[i] = std::max(node.high[i], point_[order_[position]][i]);
        }
    node_.push_back(node);
    if (end - begin <= k_leaf) return number;
    std::size_t widest = 0;
    for (std::size_t i = 0; i < node.low.size(); ++i)
        if (node.high[i] - node.low[i] > node.high[widest] - node.low[widest]) widest = i;
    const std::uint32_t middle = begin + (end - begin) / 2;
    std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                     [&](std::uint32_t a, std::uint32_t b) { return point_[a][widest] < point_[b][widest]; });
    build(begin, middle);
    node_[number].second_child = build(middle, end);
    return number;
}

void NearSamples::mark_grouped(std::size_t k) {
    for (const std::size_t point : {2 * k, 2 * k + 1})
        for (std::uint32_t index = 0;;) {
            --node_[index].ungrouped;
            const std::uint32_t second_child = node_[index].second_child;
            if (second_child == 0) break;
            index = place_[point] < node_[second_child].begin ? index + 1 : second_child;
        }
}

void NearSamples::add_near(const Point& centre, int number, std::vector<int>& group,
                           std::vector<std::uint32_t>& added) {
    constexpr double reach = k_group_distance * k_group_distance;
    for (std::vector<std::uint32_t> open{0}; !open.empty();) {
        const std::uint32_t index = open.back();
        const Node& node = node_[index];
        open.pop_back();
        if (node.ungrouped == 0 || !(squared_distance(centre, node.low, node.high) < reach)) continue;
        if (node.second_child != 0) {
            open.insert(open.end(), {node.second_child, index + 1});
            continue;
        }
        for (std::uint32_t i = node.begin; i < node.end; ++i) {
            const std::uint32_t k = order_[i] / 2;
            if (group[k] != k_several || !(squared_distance(centre, point_[order_[i]]) < reach)) continue;
            group[k] = number;
            mark_grouped(k);
            added.push_back(k);
        }
    }
}

std::vector<int> NearSamples::groups() {
    std::vector<int> group(count(), k_several);
    int number = 0;
    for (std::uint32_t first = 0; first < group.size(); ++first) {
        if (group[first] != k_several) continue;
        group[first] = number;
        mark_grouped(first);
        for (std::vector<std::uint32_t> open{first}; !open.empty();) {
            const std::uint32_t k = open.back();
            open.pop_back();
            add_near(point_[2 * k], number, group, open);
        }
        ++number;
    }
    mark_groups(group);
    return group;
}

void NearSamples::mark_groups(const std::vector<int>& group) {
    for (auto node = node_.rbegin(); node != node_.rend(); ++node) {  // children before their parent
        if (node->second_child != 0) {
            const int first_group = (node.base())->group;  // the next node, its first child
            node->group = first_group == node_[node->second_child].group ? first_group : k_several;
            continue;
        }
        node->group = group[order_[node->begin] / 2];
        for (std::uint32_t i = node->begin; i < node->end; ++i)
            if (group[order_[i] / 2] != node->group) node->group = k_several;
    }
}

double NearSamples::distance_to_other_group(std::size_t k, const std::vector<int>& group) const {
    const Point& centre = point_[2 * k];
    double least = std::numeric_limits<double>::infinity();
    const auto distance = [&](std::uint32_t index) {
        return squared_distance(centre, node_[index].low, node_[index].high);
    };
    for (std::vector<std::pair<double, std::uint32_t>> open{{0, 0}}; !open.empty();) {
        const auto [bound, index] = open.back();
        const Node& node = node_[index];
        open.pop_back();
        if (bound >= least || node.group == group[k]) continue;
        if (node.second_child == 0) {
            for (std::uint32_t i = node.begin; i < node.end; ++i)
                if (group[order_[i] / 2] != group[k])
                    least = std::min(least, squared_distance(centre, point_[order_[i]]));
            continue;
        }
        std::pair near(distance(index + 1), index + 1), far(distance(node.second_child), node.second_child);
        if (far.first < near.first) std::swap(near, far);
        open.insert(open.end(), {far, near});  // the nearer one is next
    }
    return std::sqrt(least);
}

}  // namespace srbf
