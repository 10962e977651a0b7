// Quantiles of weighted numbers.
#pragma once
#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace srbf {

/// The least number for which the weights of all numbers up to it sum to at least `share`, in (0, 1], of all weights;
/// 0 if there are none. `of`: numbers and their weights ≥ 0. Halves them about a median until one is left. Weights are
/// whole multiples of 2⁻⁵² of their sum, so that their order does not matter, which a library chooses.
inline double weighted_quantile(std::span<const std::pair<double, double>> of, double share) {
    if (of.empty()) return 0;
    double whole = 0;
    for (const auto& [number, weight] : of) whole += weight;
    std::vector<std::pair<double, std::int64_t>> parts;
    parts.reserve(of.size());
    for (const auto& [number, weight] : of)
        parts.emplace_back(number, whole > 0 ? std::int64_t(weight / whole * 0x1p52) : 0);
    const auto weight = [](auto from, auto to) {
        std::int64_t sum = 0;
        for (; from != to; ++from) sum += from->second;
        return sum;
    };
    auto begin = parts.begin(), end = parts.end();
    auto left = std::int64_t(share * double(weight(begin, end)));  // what the weights from `begin` on have to sum to
    while (end - begin > 1) {
        const auto middle = begin + (end - begin) / 2;
        std::nth_element(begin, middle, end);
        const std::int64_t lower = weight(begin, middle);
        if (lower >= left) {
            end = middle;
        } else {
            left -= lower;
            begin = middle;
        }
    }
    return begin->first;
}

}  // namespace srbf
