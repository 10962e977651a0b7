// Quantiles of weighted numbers: level 1.
#pragma once
#include <algorithm>
#include <utility>
#include <vector>

namespace srbf {

/// The least number for which the weights of all numbers up to it sum to at least `share`, in (0, 1], of all weights;
/// 0 if there are none. `of`: numbers and their weights ≥ 0. Halves them about a median until one is left.
inline double weighted_quantile(std::vector<std::pair<double, double>> of, double share) {
    if (of.empty()) return 0;
    const auto weight = [](auto from, auto to) {
        double sum = 0;
        for (; from != to; ++from) sum += from->second;
        return sum;
    };
    auto begin = of.begin(), end = of.end();
    double left = share * weight(begin, end);  // what the weights from `begin` on have to sum to
    while (end - begin > 1) {
        const auto middle = begin + (end - begin) / 2;
        std::nth_element(begin, middle, end);
        const double lower = weight(begin, middle);
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
