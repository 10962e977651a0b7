// Which samples are close to each other, for groups of them.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "srbf/measured.h"

namespace srbf {

/// Searches among samples, of those at the same place for the first. However many are close together, a search takes the
/// time of what it finds: what has a group already is passed over in whole branches of a tree.
class NearSamples {
  public:
    explicit NearSamples(const ScatteredSamples& samples);

    /// The first sample at the place of sample i.
    std::size_t first_like(std::size_t i) const { return first_[i]; }
    /// How many samples are first at their place, and the k-th of them.
    std::size_t count() const { return sample_.size(); }
    std::size_t sample(std::size_t k) const { return sample_[k]; }

    /// The group of each, numbered in the order of their first ones: those within `k_group_distance` of each other have
    /// the same, each standing for itself and for the sample with directions exchanged.
    std::vector<int> groups();
    /// The distance of the k-th to the nearest point of another of these groups; infinite if there is none.
    double to_other_group(std::size_t k, const std::vector<int>& group) const;

  private:
    using Point = std::array<double, 6>;
    /// A node of the tree over points begin..end of `order_`. Its children are the next node and `second`, which is 0 for
    /// a leaf.
    struct Node {
        Point low, high;
        std::uint32_t begin, end, second = 0;
        std::uint32_t waiting = 0;  ///< points without a group
        int group = k_several;      ///< of all of them
    };
    static constexpr int k_several = -1;
    static constexpr std::uint32_t k_leaf = 16;  // points; for speed alone

    std::uint32_t build(std::uint32_t begin, std::uint32_t end);
    /// Gives a group to those without one that are within reach of `from`.
    void take_near(const Point& from, int number, std::vector<int>& group, std::vector<std::uint32_t>& taken);
    void close(std::size_t k);
    void mark_groups(const std::vector<int>& group);

    std::vector<std::uint32_t> first_, sample_;
    std::vector<Point> point_;                  ///< of the k-th sample 2k; with exchanged directions 2k + 1
    std::vector<std::uint32_t> order_, place_;  ///< points as the nodes have them, and where each is there
    std::vector<Node> node_;
};

}  // namespace srbf
