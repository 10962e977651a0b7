#include "fit/data/folds.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "k_d_tree.h"
#include "parallel.h"
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

/// Searches among samples, of those at the same place for the first.
class NearSamples {
  public:
    explicit NearSamples(const ScatteredSamples& samples) {
        PointCloud<double, 6> all;
        for (std::size_t i = 0; i < samples.wl.size(); ++i)
            all.at.push_back(point_of(samples.wl[i], samples.wv[i], samples.isotropic));
        first_ = first_at_its_place(all);
        for (std::size_t i = 0; i < first_.size(); ++i) {
            if (first_[i] != i) continue;
            sample_.push_back(std::uint32_t(i));
            cloud_.at.push_back(all.at[i]);
            cloud_.at.push_back(point_of(samples.wv[i], samples.wl[i], samples.isotropic));
        }
        tree_.buildIndex();
    }
    NearSamples(const NearSamples&) = delete;

    /// The first sample at the place of sample i.
    std::size_t first_like(std::size_t i) const { return first_[i]; }
    /// How many samples are first at their place, and the k-th of them.
    std::size_t count() const { return sample_.size(); }
    std::size_t sample(std::size_t k) const { return sample_[k]; }

    /// Those within `k_group_distance` of the k-th: each stands for one or, with directions exchanged, another.
    std::vector<std::size_t> near(std::size_t k) const {
        FoundPoints<double> found;
        tree_.radiusSearch(cloud_.at[2 * k].data(), k_group_distance * k_group_distance, found, {});
        std::vector<std::size_t> all;
        for (const auto& [point, distance] : found) all.push_back(point / 2);
        return all;
    }
    /// The distance of the k-th to the nearest point of another group, among as many neighbours as necessary.
    double to_other_group(std::size_t k, const std::vector<int>& group) const {
        const std::size_t all = cloud_.at.size();
        std::vector<std::uint32_t> point;
        std::vector<double> distance;
        for (std::size_t wanted = k_first_neighbours;; wanted = std::min(4 * wanted, all)) {
            point.resize(wanted), distance.resize(wanted);
            const std::size_t count = tree_.knnSearch(cloud_.at[2 * k].data(), wanted, point.data(), distance.data());
            for (std::size_t n = 0; n < count; ++n)
                if (group[point[n] / 2] != group[k]) return std::sqrt(distance[n]);
            if (wanted >= all) return std::numeric_limits<double>::infinity();
        }
    }

  private:
    static constexpr std::size_t k_first_neighbours = 8, k_leaf = 16;  // of the tree, for speed alone
    std::vector<std::uint32_t> first_, sample_;
    PointCloud<double, 6> cloud_;  ///< of the k-th point 2k; with exchanged directions 2k + 1
    KdTree<double, 6> tree_{6, cloud_, nanoflann::KDTreeSingleIndexAdaptorParams(k_leaf)};
};

/// The groups in the order of their folds: those within θmax first, then by brightness.
std::vector<std::size_t> by_brightness(const ScatteredSamples& samples, const SampleGroups& groups, double max_theta) {
    const auto count = std::size_t(groups.count);
    std::vector<double> brightness(count), size(count);
    std::vector<bool> within(count, false);
    for (std::size_t i = 0; i < groups.of.size(); ++i) {
        const auto group = std::size_t(groups.of[i]);
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

SampleGroups group_samples(const ScatteredSamples& samples) {
    const NearSamples places(samples);
    std::vector<int> group(places.count(), -1);
    SampleGroups groups{{}, 0, 0};
    for (std::size_t first = 0; first < group.size(); ++first) {
        if (group[first] >= 0) continue;
        group[first] = groups.count;
        for (std::vector<std::size_t> open{first}; !open.empty();) {
            const std::size_t k = open.back();
            open.pop_back();
            for (const std::size_t other : places.near(k))
                if (group[other] < 0) group[other] = groups.count, open.push_back(other);
        }
        ++groups.count;
    }
    const bool is_one = groups.count < 2;
    std::vector<double> distance(samples.wl.size());
    groups.of.resize(samples.wl.size());
    for (std::size_t k = 0; k < group.size(); ++k) {
        groups.of[places.sample(k)] = group[k];
        distance[places.sample(k)] = is_one ? 0 : places.to_other_group(k, group);
    }
    for (std::size_t i = 0; i < groups.of.size(); ++i) {
        groups.of[i] = groups.of[places.first_like(i)];
        distance[i] = distance[places.first_like(i)];
    }
    if (is_one) return groups;
    const auto twentieth = distance.begin() + std::ptrdiff_t(distance.size() / 20);
    std::nth_element(distance.begin(), twentieth, distance.end());
    groups.spacing = *twentieth;
    return groups;
}

double spacing(const ScatteredSamples& samples) { return group_samples(samples).spacing; }

Result<std::vector<int>> assign_folds(const ScatteredSamples& samples, double max_theta, std::uint64_t seed) {
    return assign_folds(samples, group_samples(samples), max_theta, seed);
}

Result<std::vector<int>> assign_folds(const ScatteredSamples& samples, const SampleGroups& groups, double max_theta,
                                      std::uint64_t seed) {
    if (groups.count < k_folds)
        return Error{"samples",
                     {},
                     "samples at different directions",
                     fmt::format("at least {}", k_folds),
                     fmt::format("{}", groups.count)};
    const std::vector<std::size_t> order = by_brightness(samples, groups, max_theta);
    std::mt19937_64 random(seed);
    std::vector<int> of_group(order.size()), of_sample;
    for (std::size_t first = 0; first < order.size(); first += k_folds) {
        std::array<int, k_folds> fold;
        std::iota(fold.begin(), fold.end(), 0);
        for (std::size_t k = k_folds - 1; k > 0; --k)
            std::swap(fold[k], fold[std::size_t(uniform(random) * double(k + 1))]);
        for (std::size_t k = first; k < std::min(first + k_folds, order.size()); ++k)
            of_group[order[k]] = fold[k - first];
    }
    for (const int group : groups.of) of_sample.push_back(of_group[std::size_t(group)]);
    return of_sample;
}

ScatteredSamples without_fold(const ScatteredSamples& samples, std::span<const int> fold, int left_out) {
    ScatteredSamples rest;
    rest.description = samples.description;
    rest.isotropic = samples.isotropic;
    rest.wavelengths = samples.wavelengths;
    const std::size_t C = samples.wavelengths.size();
    for (std::size_t i = 0; i < fold.size(); ++i) {
        if (fold[i] == left_out) continue;
        rest.wl.push_back(samples.wl[i]);
        rest.wv.push_back(samples.wv[i]);
        rest.colour.push_back(samples.colour[i]);
        const auto spectrum = samples.spectrum.begin() + std::ptrdiff_t(i * C);
        if (!samples.spectrum.empty())
            rest.spectrum.insert(rest.spectrum.end(), spectrum, spectrum + std::ptrdiff_t(C));
    }
    make_index(rest);
    return rest;
}

Result<std::vector<std::vector<float>>> cross_validate(const ScatteredSamples& samples, std::span<const int> fold,
                                                       const FitToSamples& fit) {
    std::array<std::optional<Result<std::vector<Model>>>, k_folds> models;
    const FlushSubnormals mode;
    parallel_for(std::size_t(k_folds),
                 [&](std::size_t left_out) { models[left_out] = fit(without_fold(samples, fold, int(left_out))); });
    std::vector<std::vector<float>> predicted;
    for (int left_out = 0; left_out < k_folds; ++left_out) {
        const auto& of_fold = *models[std::size_t(left_out)];
        if (!of_fold) return of_fold.error();
        predicted.resize(of_fold->size());
        for (std::size_t k = 0; k < predicted.size(); ++k) {
            // Colours come from `value`, which is the same on any machine.
            const Model& fitted = (*of_fold)[k];
            const Channels model =
                wavelengths(fitted).empty() ? rgb_channels(evaluator<Model>(fitted)) : channels(fitted);
            const std::size_t C = model.count();
            std::vector<float> f(C * samples.wl.size());
            model.evaluate(samples.wl, samples.wv, f);
            predicted[k].resize(f.size());
            for (std::size_t i = 0; i < fold.size(); ++i)
                if (fold[i] == left_out) std::copy_n(&f[i * C], C, &predicted[k][i * C]);
        }
    }
    return predicted;
}

}  // namespace srbf
