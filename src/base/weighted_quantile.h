#pragma once
#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace SRBF_NAMESPACE {

/// The smallest number for which the weights of all numbers up to it sum to at least `share`, in (0, 1], of all
/// weights; 0 if there are no numbers. `numbers` are pairs of a number and its weight ≥ 0. Halves them about a median
/// until one is left. Weights are rounded to multiples of 2⁻⁵² of their sum, so that sums do not depend on the order in
/// which nth_element leaves them.
inline double weighted_quantile(std::span<const std::pair<double, double>> numbers, double share) {
    if (numbers.empty()) return 0;
    double total = 0;
    for (const auto& [number, weight] : numbers) total += weight;
    std::vector<std::pair<double, std::int64_t>> parts;
    parts.reserve(numbers.size());
    for (const auto& [number, weight] : numbers)
        parts.emplace_back(number, total > 0 ? std::int64_t(weight / total * 0x1p52) : 0);
    const auto weight = [](auto from, auto to) {
        std::int64_t sum = 0;
        for (; from != to; ++from) sum += from->second;
        return sum;
    };
    auto begin = parts.begin(), end = parts.end();
    auto target = std::int64_t(share * double(weight(begin, end)));  // the sum of weights from `begin` to the quantile
    while (end - begin > 1) {
        const auto middle = begin + (end - begin) / 2;
        std::nth_element(begin, middle, end);
        const std::int64_t lower = weight(begin, middle);
        if (lower >= target) {
            end = middle;
        } else {
            target -= lower;
            begin = middle;
        }
    }
    return begin->first;
}

}  // namespace srbf
