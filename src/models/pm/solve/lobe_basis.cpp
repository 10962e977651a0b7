#include "models/pm/solve/lobe_basis.h"

#include <algorithm>
#include <limits>

#include "models/pm/solve/columns.h"
#include "models/pm/solve/row_features.h"
#include "srbf/elementary.h"

namespace srbf {

LobeBasis::LobeBasis(const Rows& rows, const LobeShape& shape, bool parallel)
    : rows_(rows), shape_(shape), parallel_(parallel), factor_(rows.total_blocks() * std::size_t(factors()) * k_block) {
    if (features(shape.form) == 0) return;
    for (std::size_t block = 0; block < rows_.total_blocks(); ++block)
        further_features(rows_, block, features(shape.form), factor(block, shape.directional()));
}

void LobeBasis::evaluate_factors(const Eigen::VectorXd& x, std::size_t block) {
    const auto C = std::size_t(shape_.components());
    thread_local Aligned<float> swapped, swapped_by_angle;
    swapped.resize(C * k_block), swapped_by_angle.resize(C * k_block);
    for (int n = 0; n < shape_.variates; ++n) {
        const auto a = float(elementary::cos(x[n])), b = float(elementary::sin(x[n]));
        float *const values = factor(block, n * shape_.components()), *const derivatives =
                                                                          by_angle(block, n * shape_.components());
        variate_features(rows_, block, a, b, shape_.axial, values, derivatives);
        if (!shape_.reciprocal) continue;
        variate_features(rows_, block, b, a, shape_.axial, swapped.data(), swapped_by_angle.data());
        for (std::size_t i = 0; i < swapped.size(); ++i) {
            values[i] += swapped[i];
            derivatives[i] -= swapped_by_angle[i];  // the angle of (b, a) is π/2 minus that of (a, b)
        }
    }
}

// The offset of a lobe is its largest exponent over all rows, so that exponentials neither overflow nor vanish.
void LobeBasis::evaluate(const Eigen::VectorXd& x) {
    constexpr float k_lowest = -std::numeric_limits<float>::infinity();
    const auto W = std::size_t(shape_.width());
    count_ = (int(x.size()) - shape_.variates) / shape_.width();
    const auto J = std::size_t(count_);
    lobe_.resize(rows_.total_blocks() * J * k_block);
    const Eigen::VectorXf weight = x.tail(Eigen::Index(J * W)).cast<float>();

    std::vector<std::vector<float>> largest(rows_.total_chunks(), std::vector<float>(J, k_lowest));
    rows_.for_chunks(rows_.total_chunks(), parallel_, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
        std::vector<const float*> s(W);
        for (std::size_t block = begin; block < end; ++block) {
            evaluate_factors(x, block);
            for (std::size_t n = 0; n < W; ++n) s[n] = factor(block, int(n));
            for (std::size_t j = 0; j < J; ++j)
                largest[chunk][j] = std::max(
                    largest[chunk][j], exponent({weight.data() + j * W, W}, s, &rows_.root_weight[block * k_block],
                                                lobe(block, int(j)), rows_.rows_in(block)));
        }
    });
    offset_.assign(J, 0.0);
    for (std::size_t j = 0; j < J; ++j) {
        float maximum = k_lowest;
        for (const auto& chunk_largest : largest) maximum = std::max(maximum, chunk_largest[j]);
        offset_[j] = double(maximum);
    }
    rows_.for_chunks(rows_.total_chunks(), parallel_, [&](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t block = begin; block < end; ++block)
            for (std::size_t j = 0; j < J; ++j)
                exponentiate(lobe(block, int(j)), &rows_.root_weight[block * k_block], float(offset_[j]),
                             lobe(block, int(j)), rows_.rows_in(block));
    });
}

}  // namespace srbf
