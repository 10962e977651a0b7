// Radiance's tensor trees: parsing and look-up.
#include "extras/daylight/tensor_tree.h"

#include <fmt/format.h>

#include <cmath>

#include "base/text.h"
#include "brdf/colour.h"
#include "measured/bytes.h"
#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {

namespace {

/// The characters between numbers.
constexpr std::string_view k_blanks_in_tree = " \t\r\n,";
/// Limit on the levels of a tree, whose leaves are then at least 2^−16 wide. Radiance makes at most seven.
constexpr int k_deepest_tree = 16;

/// Parses the text of a tree.
class TreeText {
  public:
    TreeText(std::string_view text, TensorTree& tree) : text_(text), tree_(tree) {}

    std::optional<Error> read() {
        const auto root = node(0);
        if (!root) return root.error();
        tree_.root = *root;
        if (skip() < text_.size()) return wrong("the end of the tree", next_text());
        return {};
    }

  private:
    std::size_t skip() { return offset_ = std::min(text_.find_first_not_of(k_blanks_in_tree, offset_), text_.size()); }
    std::string next_text() const { return offset_ < text_.size() ? quoted(text_.substr(offset_, 12)) : "the end"; }
    Error wrong(std::string expected, std::string next_text) const {
        return {{}, offset_, "tensor tree", std::move(expected), std::move(next_text)};
    }
    bool take(char c) {
        if (skip() == text_.size() || text_[offset_] != c) return false;
        ++offset_;
        return true;
    }

    /// Reads a node, which begins with a brace.
    Result<std::uint32_t> node(int depth) {
        if (depth > k_deepest_tree) return wrong(fmt::format("at most {} levels", k_deepest_tree), "more");
        if (!take('{')) return wrong("'{'", next_text());
        const std::size_t children = std::size_t(1) << tree_.rank;
        if (skip() == text_.size() || text_[offset_] != '{') return grid();
        const std::size_t first = tree_.nodes.size();
        tree_.nodes.resize(first + children);
        for (std::size_t n = 0; n < children; ++n) {
            const auto child = node(depth + 1);
            if (!child) return child;
            tree_.nodes[first + n] = *child;
        }
        if (!take('}')) return wrong(fmt::format("'}}' after {} trees", children), next_text());
        return TensorTree::branch(std::uint32_t(first));
    }

    Result<std::uint32_t> grid() {
        const std::size_t first = tree_.leaves.size();
        while (!take('}')) {
            const std::size_t end = std::min(text_.find_first_of(" \t\r\n,{}", offset_), text_.size());
            const auto number = to_number<float>(text_.substr(offset_, end - offset_));
            if (!number || !(std::abs(*number) <= k_largest_value)) return wrong("numbers, then '}'", next_text());
            tree_.leaves.push_back(*number);
            offset_ = end;
        }
        const std::size_t count = tree_.leaves.size() - first;
        for (int level = 0; level * tree_.rank < 32; ++level)
            if (count == std::size_t(1) << level * tree_.rank) return TensorTree::grid(level, std::uint32_t(first));
        return wrong(fmt::format("2^{}k numbers between braces", tree_.rank), fmt::format("{}", count));
    }

    std::string_view text_;
    std::size_t offset_ = 0;
    TensorTree& tree_;
};

struct TreeCounts {
    std::size_t braces = 0, numbers = 0;
};
TreeCounts counts_of(std::string_view text) {
    TreeCounts counts;
    bool in_number = false;
    for (const char c : text) {
        const bool separates = c == '{' || c == '}' || k_blanks_in_tree.find(c) != k_blanks_in_tree.npos;
        counts.braces += c == '{';
        counts.numbers += !separates && !in_number;
        in_number = !separates;
    }
    return counts;
}

/// Maps a point of the unit disc to the unit square and preserves areas (Shirley and Chiu, "A low distortion map
/// between disk and square", 1997).
std::array<double, 2> shirley_square(double x, double y) {
    constexpr double eighth = k_pi / 4;
    const double r = elementary::hypot(x, y);
    double phi = elementary::atan2(y, x), a, b;
    if (phi < -eighth) phi += 2 * k_pi;
    if (phi < eighth) {
        a = r;
        b = phi * a / eighth;
    } else if (phi < 3 * eighth) {
        b = r;
        a = -(phi - 2 * eighth) * b / eighth;
    } else if (phi < 5 * eighth) {
        a = -r;
        b = (phi - 4 * eighth) * a / eighth;
    } else {
        b = -r;
        a = -(phi - 6 * eighth) * b / eighth;
    }
    return {(a + 1) / 2, (b + 1) / 2};
}

/// The point in the cube of a tree for a pair of directions in a part's frame.
std::array<double, 4> tree_point(int rank, Vec3f wl, Vec3f wv) {
    // In Radiance's convention, p = (x, y) of −in and q = (x, y) of out, so p = q for mirror reflection and
    // straight transmission.
    const double px = double(wl.x), py = -double(wl.y), qx = -double(wv.x), qy = double(wv.y);
    if (rank == 4) {
        const auto p = shirley_square(px, py), q = shirley_square(qx, qy);
        return {p[0], p[1], q[0], q[1]};
    }
    const double sine = elementary::hypot(px, py);
    const double c = sine > 0 ? px / sine : 1, s = sine > 0 ? py / sine : 0;
    const auto q = shirley_square(c * qx + s * qy, c * qy - s * qx);
    constexpr double tiny = 1e-6;  // Radiance's constant; puts the normal in the lower half of the tree
    return {0.5 - tiny - 0.5 * sine, q[0], q[1], 0};
}

}  // namespace

std::size_t max_tree_bytes(std::string_view text) {
    const TreeCounts counts = counts_of(text);
    return counts.braces * sizeof(std::uint32_t) + counts.numbers * sizeof(float);
}

Result<TensorTree> read_tensor_tree(std::string_view text, int rank) {
    const TreeCounts counts = counts_of(text);
    if (counts.numbers > TensorTree::k_max_leaves || counts.braces > TensorTree::k_max_leaves)
        return Error{{}, {}, "tensor tree", fmt::format("at most {} leaves", TensorTree::k_max_leaves), "more"};
    TensorTree tree;
    tree.rank = rank;
    tree.nodes.reserve(counts.braces + (std::size_t(1) << rank));
    tree.leaves.reserve(counts.numbers);
    if (auto error = TreeText(text, tree).read()) return *std::move(error);
    return tree;
}

float TensorTree::at(std::array<double, 4> x) const {
    constexpr double below_one = 1 - 0x1p-30;
    for (double& coordinate : x) coordinate = std::clamp(coordinate, 0.0, below_one);
    std::uint32_t node = root;
    while (level_of(node) == k_branch) {
        std::uint32_t child = 0;
        for (int i = 0; i < rank; ++i) {
            double& coordinate = x[std::size_t(i)];
            coordinate *= 2;
            if (coordinate < 1) continue;
            coordinate -= 1;
            child |= 1u << i;
        }
        node = nodes[first_of(node) + child];
    }
    const std::uint32_t level = level_of(node);
    std::size_t index = 0;
    for (int i = 0; i < rank; ++i) index = (index << level) + std::size_t(x[std::size_t(i)] * double(1u << level));
    return leaves[first_of(node) + index];
}

float TensorTree::smallest_leaf() const {
    // Children follow their branch, so that widths are known from the root down.
    float smallest = 1;
    std::vector<std::pair<std::uint32_t, float>> pending{{root, 1.f}};
    while (!pending.empty()) {
        const auto [node, width] = pending.back();
        pending.pop_back();
        if (level_of(node) != k_branch) {
            smallest = std::min(smallest, width / float(1u << level_of(node)));
            continue;
        }
        for (std::uint32_t n = 0; n < 1u << rank; ++n) pending.emplace_back(nodes[first_of(node) + n], width / 2);
    }
    return smallest;
}

Rgb signed_value(const TreeTable& table, Vec3f wl, Vec3f wv) {
    if (!above_horizon(wl, wv)) return {};
    const auto x = tree_point(table.y.rank, wl, wv);
    const float y = table.y.at(x);
    if (table.chromaticity.empty()) return {y, y, y};
    const auto value_in = [&](const TensorTree& tree) { return double(tree.at(x)); };
    const double u = value_in(table.chromaticity[0]), v = value_in(table.chromaticity[1]), white_u = 4.0 / 19,
                 white_v = 9.0 / 19;
    // Chromaticities that are not colours, as where y is 0, count as white.
    const bool is_colour = u >= 0 && v > 1e-3 && 3 * u + 20 * v <= 12;
    const double cu = is_colour ? u : white_u, cv = is_colour ? v : white_v;
    const Xyz white = white_point(),
              xyz{double(y) * 9 * cu / (4 * cv), double(y), double(y) * (12 - 3 * cu - 20 * cv) / (4 * cv)};
    return to_rgb(Xyz{xyz.x * white.x, xyz.y, xyz.z * white.z});
}

}  // namespace
