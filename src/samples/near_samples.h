// Neighbour search for grouping samples that are close to each other.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "srbf/measured.h"

namespace SRBF_NAMESPACE {

/// Neighbour search over distinct sample positions. Its cost depends on the samples found, not on how densely they
/// lie: whole branches of a tree are skipped once all their points have a group.
class NearSamples {
  public:
    explicit NearSamples(const ScatteredSamples& samples);

    /// The first sample at the same position as sample i.
    std::size_t first_like(std::size_t i) const { return first_[i]; }
    /// The number of distinct positions, and the index of the sample that is first at the k-th of them.
    std::size_t count() const { return sample_.size(); }
    std::size_t sample(std::size_t k) const { return sample_[k]; }

    /// The group of each position, numbered in the order of their first positions. Positions within
    /// `k_group_distance` of each other belong to the same group. Each stands for the sample itself and for the
    /// sample with directions swapped.
    std::vector<int> groups();
    /// The distance of the k-th position to the nearest point of another group; infinity if there is only one
    /// group.
    double distance_to_other_group(std::size_t k, const std::vector<int>& group) const;

  private:
    using Point = std::array<double, 6>;
    /// A node of the tree over points begin..end of `order_`. Its children are the next node and `second_child`,
    /// which is 0 for a leaf.
    struct Node {
        Point low, high;
        std::uint32_t begin, end, second_child = 0;
        std::uint32_t ungrouped = 0;  ///< points without a group
        int group = k_several;        ///< of all its points, if they have the same one
    };
    static constexpr int k_several = -1;
    static constexpr std::uint32_t k_leaf = 16;  // points; affects speed only

    std::uint32_t build(std::uint32_t begin, std::uint32_t end);
    /// Assigns the group `number` to all ungrouped positions within reach of `centre`, and adds them to `added`.
    void add_near(const Point& centre, int number, std::vector<int>& group, std::vector<std::uint32_t>& added);
    void mark_grouped(std::size_t k);
    void mark_groups(const std::vector<int>& group);

    std::vector<std::uint32_t> first_, sample_;
    std::vector<Point> point_;  ///< of the k-th position: 2k; with swapped directions: 2k + 1
    /// points in the order of the nodes, and the position of each point in that order
    std::vector<std::uint32_t> order_, place_;
    std::vector<Node> node_;
};

}  // namespace srbf
