#include "samples/folds.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <numeric>
#include <optional>
#include <random>

#include "base/parallel.h"
#include "brdf/directions.h"
#include "errors/measures.h"
#include "samples/near_samples.h"
#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {
namespace {

/// Sorts the groups for the assignment of folds: those within θmax first, then by brightness.
std::vector<std::size_t> sort_by_brightness(const ScatteredSamples& samples, const SampleGroups& groups,
                                            double max_theta) {
    const auto count = std::size_t(groups.count);
    std::vector<double> brightness(count), size(count);
    std::vector<bool> within(count, false);
    for (std::size_t i = 0; i < groups.group_of.size(); ++i) {
        const auto group = std::size_t(groups.group_of[i]);
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
    NearSamples places(samples);
    const std::vector<int> group = places.groups();
    SampleGroups groups{{}, group.empty() ? 0 : 1 + *std::ranges::max_element(group), 0};
    const bool is_single = groups.count < 2;
    std::vector<double> distance(samples.wl.size());
    groups.group_of.resize(samples.wl.size());
    for (std::size_t k = 0; k < group.size(); ++k) {
        groups.group_of[places.sample(k)] = group[k];
        distance[places.sample(k)] = is_single ? 0 : places.distance_to_other_group(k, group);
    }
    for (std::size_t i = 0; i < groups.group_of.size(); ++i) {
        groups.group_of[i] = groups.group_of[places.first_like(i)];
        distance[i] = distance[places.first_like(i)];
    }
    if (is_single) return groups;
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
    const std::vector<std::size_t> order = sort_by_brightness(samples, groups, max_theta);
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
    for (const int group : groups.group_of) fold_of_sample.push_back(fold_of_group[std::size_t(group)]);
    return fold_of_sample;
}

std::optional<IncidenceFolds> incidence_folds(const ScatteredSamples& samples) {
    constexpr double k_apart = 0.1 * k_degree;
    constexpr std::size_t k_fewest = 3, k_most = 64, k_fewest_samples = 8;
    std::vector<std::size_t> order(samples.wl.size());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::stable_sort(order, std::greater(), [&](std::size_t i) { return samples.wl[i].z; });
    IncidenceFolds folds{std::vector<int>(order.size()), 0};
    std::vector<std::size_t> first;  // index in `order` of each incidence's first sample
    const auto theta = [&](std::size_t k) { return elementary::acos(std::min(double(samples.wl[order[k]].z), 1.0)); };
    for (std::size_t k = 0; k < order.size(); ++k) {
        if (k == 0 || theta(k) - theta(k - 1) > k_apart) first.push_back(k);
        folds.fold_of[order[k]] = int(first.size() - 1) % k_folds;
    }
    if (first.size() < k_fewest || first.size() > k_most) return std::nullopt;
    folds.incidences = int(first.size());
    first.push_back(order.size());
    for (std::size_t k = 1; k < first.size(); ++k)
        if (first[k] - first[k - 1] < k_fewest_samples) return std::nullopt;
    return folds;
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

}  // namespace srbf
