#include "samples/near_samples.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/k_d_tree.h"
#include "samples/folds.h"
#include "srbf/elementary.h"

namespace srbf {
namespace {

/// A point for each pair such that distances between points are, to first order, √(|Δωl|² + |Δωv|²); for isotropic
/// samples the minimum over all rotations about the normal and reflections.
std::array<double, 6> point_of(Vec3f l, Vec3f v, bool isotropic) {
    constexpr double least = 1e-30;  // not 0 where both directions are the normal
    const Vec3d wl = to_double(l), wv = to_double(v);
    if (!isotropic) return {wl.x, wl.y, wl.z, wv.x, wv.y, wv.z};
    const double rl = elementary::hypot(wl.x, wl.y), rv = elementary::hypot(wv.x, wv.y),
                 both = std::max(elementary::hypot(rl, rv), least);
    // Under a relative rotation by δ the distance is rl rv / √(rl² + rv²) δ, shared between both directions.
    const double across = std::abs(wl.x * wv.y - wl.y * wv.x) / both, along = (wl.x * wv.x + wl.y * wv.y) / both;
    return {rl, wl.z, rv, wv.z, along, across};
}

double squared_distance(const std::array<double, 6>& a, const std::array<double, 6>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
    return sum;
}

/// To the nearest place of the box low..high; as rounded no more than to any point in it.
double squared_distance(const std::array<double, 6>& a, const std::array<double, 6>& low,
                        const std::array<double, 6>& high) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double apart = std::max({low[i] - a[i], a[i] - high[i], 0.0});
        sum += apart * apart;
    }
    return sum;
}

}  // namespace

NearSamples::NearSamples(const ScatteredSamples& samples) {
    PointCloud<double, 6> all;
    for (std::size_t i = 0; i < samples.wl.size(); ++i)
        all.at.push_back(point_of(samples.wl[i], samples.wv[i], samples.isotropic));
    first_ = first_at_its_place(all);
    for (std::size_t i = 0; i < first_.size(); ++i) {
        if (first_[i] != i) continue;
        sample_.push_back(std::uint32_t(i));
        point_.push_back(all.at[i]);
        point_.push_back(point_of(samples.wv[i], samples.wl[i], samples.isotropic));
    }
    order_.resize(point_.size()), place_.resize(point_.size());
    std::iota(order_.begin(), order_.end(), 0u);
    if (!order_.empty()) build(0, std::uint32_t(order_.size()));
    for (std::uint32_t at = 0; at < order_.size(); ++at) place_[order_[at]] = at;
}

std::uint32_t NearSamples::build(std::uint32_t begin, std::uint32_t end) {
    const auto number = std::uint32_t(node_.size());
    Node node{point_[order_[begin]], point_[order_[begin]], begin, end};
    node.waiting = end - begin;
    for (std::uint32_t at = begin; at < end; ++at)
        for (std::size_t i = 0; i < node.low.size(); ++i) {
            node.low[i] = std::min(node.low[i], point_[order_[at]][i]);
            node.high[i] = std::max(node.high[i], point_[order_[at]][i]);
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
    node_[number].second = build(middle, end);
    return number;
}

void NearSamples::close(std::size_t k) {
    for (const std::size_t point : {2 * k, 2 * k + 1})
        for (std::uint32_t at = 0;;) {
            --node_[at].waiting;
            const std::uint32_t second = node_[at].second;
            if (second == 0) break;
            at = place_[point] < node_[second].begin ? at + 1 : second;
        }
}

void NearSamples::take_near(const Point& from, int number, std::vector<int>& group, std::vector<std::uint32_t>& taken) {
    constexpr double reach = k_group_distance * k_group_distance;
    for (std::vector<std::uint32_t> open{0}; !open.empty();) {
        const std::uint32_t at = open.back();
        const Node& node = node_[at];
        open.pop_back();
        if (node.waiting == 0 || !(squared_distance(from, node.low, node.high) < reach)) continue;
        if (node.second != 0) {
            open.insert(open.end(), {node.second, at + 1});
            continue;
        }
        for (std::uint32_t i = node.begin; i < node.end; ++i) {
            const std::uint32_t k = order_[i] / 2;
            if (group[k] != k_several || !(squared_distance(from, point_[order_[i]]) < reach)) continue;
            group[k] = number;
            close(k);
            taken.push_back(k);
        }
    }
}

std::vector<int> NearSamples::groups() {
    std::vector<int> group(count(), k_several);
    int number = 0;
    for (std::uint32_t first = 0; first < group.size(); ++first) {
        if (group[first] != k_several) continue;
        group[first] = number;
        close(first);
        for (std::vector<std::uint32_t> open{first}; !open.empty();) {
            const std::uint32_t k = open.back();
            open.pop_back();
            take_near(point_[2 * k], number, group, open);
        }
        ++number;
    }
    mark_groups(group);
    return group;
}

void NearSamples::mark_groups(const std::vector<int>& group) {
    for (auto node = node_.rbegin(); node != node_.rend(); ++node) {  // children before their parent
        if (node->second != 0) {
            const int one = (node.base())->group;  // the node behind it
            node->group = one == node_[node->second].group ? one : k_several;
            continue;
        }
        node->group = group[order_[node->begin] / 2];
        for (std::uint32_t i = node->begin; i < node->end; ++i)
            if (group[order_[i] / 2] != node->group) node->group = k_several;
    }
}

double NearSamples::to_other_group(std::size_t k, const std::vector<int>& group) const {
    const Point& from = point_[2 * k];
    double least = std::numeric_limits<double>::infinity();
    const auto distance = [&](std::uint32_t at) { return squared_distance(from, node_[at].low, node_[at].high); };
    for (std::vector<std::pair<double, std::uint32_t>> open{{0, 0}}; !open.empty();) {
        const auto [bound, at] = open.back();
        const Node& node = node_[at];
        open.pop_back();
        if (bound >= least || node.group == group[k]) continue;
        if (node.second == 0) {
            for (std::uint32_t i = node.begin; i < node.end; ++i)
                if (group[order_[i] / 2] != group[k])
                    least = std::min(least, squared_distance(from, point_[order_[i]]));
            continue;
        }
        std::pair near(distance(at + 1), at + 1), far(distance(node.second), node.second);
        if (far.first < near.first) std::swap(near, far);
        open.insert(open.end(), {far, near});  // the nearer one is next
    }
    return std::sqrt(least);
}

}  // namespace srbf
