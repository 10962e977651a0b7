#include "samples/folds.h"

#include <fmt/format.h>

#include <map>

#include "base/k_d_tree.h"
#include "brdf/directions.h"
#include "errors/measures.h"
#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {
namespace {

using Point = std::array<double, 6>;

/// Maps a pair to a point such that distances between points are √(|Δωl|² + |Δωv|²), to first order. For isotropic
/// samples this is the minimum over all rotations about the normal and reflections.
Point point_of(Vec3f l, Vec3f v, bool isotropic) {
    constexpr double min = 1e-30;  // avoids a division by 0 where both directions are the normal
    const Vec3d wl = to_double(l), wv = to_double(v);
    if (!isotropic) return {wl.x, wl.y, wl.z, wv.x, wv.y, wv.z};
    const double rl = elementary::hypot(wl.x, wl.y), rv = elementary::hypot(wv.x, wv.y),
                 norm = std::max(elementary::hypot(rl, rv), min);
    // Under a relative rotation by δ the distance is rl rv / √(rl² + rv²) δ, distributed over both directions.
    const double across = std::abs(wl.x * wv.y - wl.y * wv.x) / norm, along = (wl.x * wv.x + wl.y * wv.y) / norm;
    return {rl, wl.z, rv, wv.z, along, across};
}

/// The group of each sample, numbered in the order of their first samples. Points are put into cells of half that
/// distance first, of which there are few however densely the samples lie.
std::vector<int> groups_of(const ScatteredSamples& samples) {
    constexpr double k_reach = 1.001 * k_group_distance;  // includes a neighbour at the distance itself, as rounded
    const double side = k_group_distance / (2 * std::sqrt(6.0));
    std::map<std::array<int, 6>, std::uint32_t> cells;
    PointCloud<double, 6> points;        // the first of each cell
    std::vector<std::uint32_t> cell_of;  // cells of the samples, and of the samples exchanged
    const auto add = [&](Vec3f wl, Vec3f wv) {
        const Point point = point_of(wl, wv, samples.isotropic);
        std::array<int, 6> cell;
        std::ranges::transform(point, cell.begin(), [&](double x) { return int(std::floor(x / side)); });
        const auto [entry, is_new] = cells.try_emplace(cell, std::uint32_t(points.coordinates.size()));
        if (is_new) points.coordinates.push_back(point);
        cell_of.push_back(entry->second);
    };
    for (std::size_t i = 0; i < samples.wl.size(); ++i) {
        add(samples.wl[i], samples.wv[i]);
        add(samples.wv[i], samples.wl[i]);
    }

    std::vector<std::uint32_t> parent(points.coordinates.size());
    std::iota(parent.begin(), parent.end(), 0u);
    const auto root = [&](std::uint32_t cell) {
        for (; parent[cell] != cell; cell = parent[cell]) parent[cell] = parent[parent[cell]];  // halves the path
        return cell;
    };
    const KdTree<double, 6> tree(6, points);
    for (std::uint32_t cell = 0; cell < parent.size(); ++cell) {
        FoundPoints<double> found;
        nanoflann::RadiusResultSet<double, std::uint32_t> near(k_reach * k_reach, found);
        tree.findNeighbors(near, points.coordinates[cell].data(), {});
        for (const auto& [other, distance] : found) parent[root(other)] = root(cell);
    }
    for (std::size_t i = 0; i < cell_of.size(); i += 2) parent[root(cell_of[i + 1])] = root(cell_of[i]);
    std::map<std::uint32_t, int> number;
    std::vector<int> group_of;
    for (std::size_t i = 0; i < cell_of.size(); i += 2)
        group_of.push_back(number.try_emplace(root(cell_of[i]), int(number.size())).first->second);
    return group_of;
}

/// Sorts the groups for the assignment of folds: groups within θmax first, then by brightness.
std::vector<std::size_t> sort_by_brightness(const ScatteredSamples& samples, const std::vector<int>& group_of,
                                            int groups, double max_theta) {
    const auto count = std::size_t(groups);
    std::vector<double> brightness(count), size(count);
    std::vector<bool> within(count, false);
    for (std::size_t i = 0; i < group_of.size(); ++i) {
        const auto group = std::size_t(group_of[i]);
        if (std::min(samples.wl[i].z, samples.wv[i].z) >= sample_cap(max_theta)) within[group] = true;
        brightness[group] += luminance(samples.colour[i]);
        size[group] += 1;
    }
    for (std::size_t group = 0; group < count; ++group) brightness[group] /= size[group];
    std::vector<std::size_t> order(count);
    std::iota(order.begin(), order.end(), 0);
    std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
        return within[a] != within[b] ? within[a] : brightness[a] > brightness[b];
    });
    return order;
}

}  // namespace

Result<std::vector<int>> assign_folds(const ScatteredSamples& samples, double max_theta, std::uint64_t seed) {
    const std::vector<int> group_of = groups_of(samples);
    const int count = group_of.empty() ? 0 : 1 + *std::ranges::max_element(group_of);
    if (count < k_folds)
        return Error{"samples",
                     {},
                     "samples at different directions",
                     fmt::format("at least {}", k_folds),
                     fmt::format("{}", count)};
    const std::vector<std::size_t> order = sort_by_brightness(samples, group_of, count, max_theta);
    std::mt19937_64 random(seed);
    std::vector<int> fold_of_group(order.size()), fold_of_sample;
    for (std::size_t first = 0; first < order.size(); first += k_folds) {
        std::array<int, k_folds> fold;
        std::iota(fold.begin(), fold.end(), 0);
        for (std::size_t k = k_folds - 1; k > 0; --k)
            std::swap(fold[k], fold[std::size_t(uniform(random) * double(k + 1))]);
        for (std::size_t k = first; k < std::min(first + k_folds, order.size()); ++k)
            fold_of_group[order[k]] = fold[k - first];
    }
    for (const int group : group_of) fold_of_sample.push_back(fold_of_group[std::size_t(group)]);
    return fold_of_sample;
}

ScatteredSamples without_fold(const ScatteredSamples& samples, std::span<const int> fold, int left_out) {
    ScatteredSamples kept;
    kept.description = samples.description;
    kept.isotropic = samples.isotropic;
    kept.wavelengths = samples.wavelengths;
    const std::size_t C = samples.wavelengths.size();
    for (std::size_t i = 0; i < fold.size(); ++i) {
        if (fold[i] == left_out) continue;
        kept.wl.push_back(samples.wl[i]);
        kept.wv.push_back(samples.wv[i]);
        kept.colour.push_back(samples.colour[i]);
        if (!samples.weight.empty()) kept.weight.push_back(samples.weight[i]);
        const auto spectrum = samples.spectrum.begin() + std::ptrdiff_t(i * C);
        if (!samples.spectrum.empty())
            kept.spectrum.insert(kept.spectrum.end(), spectrum, spectrum + std::ptrdiff_t(C));
    }
    make_index(kept);
    return kept;
}

}  // namespace
