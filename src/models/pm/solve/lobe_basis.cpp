#include "models/pm/solve/lobe_basis.h"

#include <algorithm>
#include <limits>

#include "models/pm/solve/simd_columns.h"
#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {

LobeBasis::LobeBasis(const PackedObservations& rows, const LobeShape& shape, bool parallel)
    : rows_(rows),
      shape_(shape),
      parallel_(parallel),
      factor_(rows.total_blocks() * std::size_t(shape.orders() * factors()) * k_block) {
    if (features(shape.form) == 0) return;
    for (std::size_t block = 0; block < rows_.total_blocks(); ++block)
        for (int order = 0; order < shape.orders(); ++order)
            further_features(rows_, block, features(shape.form), factor(block, shape.directional(), order));
}

void LobeBasis::evaluate_factors(const Eigen::VectorXd& x, std::size_t block) {
    for (int n = 0; n < shape_.variates; ++n) {
        const auto a = float(elementary::cos(x[n])), b = float(elementary::sin(x[n]));
        const int first = n * shape_.components();
        for (int order = 0; order < shape_.orders(); ++order)
            variate_features(rows_, block, order, a, b, shape_.axial, factor(block, first, order),
                             by_angle(block, first, order));
    }
}

// The offset of a lobe is its largest exponent over all rows, so that exponentials neither overflow nor vanish.
void LobeBasis::evaluate(const Eigen::VectorXd& x) {
    constexpr float k_lowest = -std::numeric_limits<float>::infinity();
    const auto W = std::size_t(shape_.width());
    count_ = (int(x.size()) - shape_.variates) / shape_.width();
    const auto J = std::size_t(count_);
    const std::size_t columns = rows_.total_blocks() * J * k_block;
    lobe_.resize(columns), summand_.resize(shape_.orders() == 1 ? 0 : 2 * columns);
    const Eigen::VectorXf lobe_x = x.tail(Eigen::Index(J * W)).cast<float>();

    std::vector<std::vector<float>> largest(rows_.total_chunks(), std::vector<float>(J, k_lowest));
    rows_.for_chunks(rows_.total_chunks(), parallel_, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
        std::vector<const float*> s(W);
        for (std::size_t block = begin; block < end; ++block) {
            evaluate_factors(x, block);
            for (int order = 0; order < shape_.orders(); ++order) {
                for (std::size_t n = 0; n < W; ++n) s[n] = factor(block, int(n), order);
                for (std::size_t j = 0; j < J; ++j)
                    largest[chunk][j] = std::max(
                        largest[chunk][j], exponent({lobe_x.data() + j * W, W}, s, &rows_.root_weight[block * k_block],
                                                    summand(block, int(j), order), rows_.rows_in(block)));
            }
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
            for (std::size_t j = 0; j < J; ++j) exponentiate_lobe(block, int(j));
    });
}

void LobeBasis::exponentiate_lobe(std::size_t block, int j) {
    const std::size_t count = rows_.rows_in(block);
    const auto offset = float(offset_[std::size_t(j)]);
    for (int order = 0; order < shape_.orders(); ++order) {
        float* const values = summand(block, j, order);
        exponentiate(values, &rows_.root_weight[block * k_block], offset, values, count);
    }
    if (shape_.orders() == 2) add(summand(block, j, 0), summand(block, j, 1), lobe(block, j), count);
}

}  // namespace
