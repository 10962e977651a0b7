// Quantiles of weighted numbers.
#pragma once
#include <algorithm>
#include <utility>
#include <vector>

namespace SRBF_NAMESPACE {

/// The smallest number for which the weights of all numbers up to it sum to at least `fraction`, in (0, 1], of all
/// weights; 0 if there are no numbers. `numbers` are pairs of a number and its weight ≥ 0.
inline double weighted_quantile(std::vector<std::pair<double, double>> numbers, double fraction) {
    std::ranges::sort(numbers);
    double total = 0, sum = 0;
    for (const auto& [number, weight] : numbers) total += weight;
    for (const auto& [number, weight] : numbers)
        if ((sum += weight) >= fraction * total) return number;
    return 0;
}

}  // namespace
