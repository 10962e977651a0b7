// Levenberg-Marquardt and the choice of lobes on a block of threads: as least_squares.h and LobeProblem::best_addition,
// in the same order of steps.
#pragma once
#include "fit/cuda/lobes.h"

namespace srbf::on_device {

/// A problem of a batch: one candidate of one material.
struct Problem {
    Shape shape;
    Observed observed;
    double log_peak_limit;
    int iterations;                                  ///< at most this many linearisations
    double target;                                   ///< the loss to reach, see LevenbergMarquardtOptions
    double* doubles;                                 ///< its Memory
    double *x, *loss, *beta, *gram, *lower, *upper;  ///< in: x and bounds; out: x, loss, β (J × C), E·E (J × J)
    const float* candidates;                         ///< lobes to choose from: `candidate_count` × width
    int candidate_count;
    double* gain;  ///< out: of each candidate
};

/// Factors the damped Hessian, of which the lower triangle is given, and solves for the step; in place.
SRBF_CALLED void solve_step(const Block& block, const Memory& memory, int n) {
    double *const A = memory.damped, *const x = memory.step;
    for (int k = 0; k < n; ++k) {
        // Column k of L, from the columns before it; the right-hand side is one more row.
        block.each(n - k + 1, [&](int at) {
            const bool is_side = at == n - k;
            double* const row = is_side ? x : A + (k + at) * n;
            double sum = is_side ? x[k] : row[k];
            const double* const pivot_row = A + k * n;
            for (int j = 0; j < k; ++j) sum -= (is_side ? x[j] : row[j]) * pivot_row[j] * (is_side ? 1 : A[j * n + j]);
            memory.partial[at] = sum;
        });
        block.each(n - k + 1, [&](int at) {
            const double pivot = memory.partial[0] > 1e-300 ? memory.partial[0] : 1e300;
            if (at == 0)
                A[k * n + k] = pivot;
            else if (at < n - k)
                A[(k + at) * n + k] = memory.partial[at] / pivot;
            else
                x[k] = memory.partial[at];
        });
    }
    block.each(n, [&](int i) { x[i] /= A[i * n + i]; });
    for (int i = n - 1; i > 0; --i) block.each(i, [&](int j) { x[j] -= A[i * n + j] * x[i]; });
}

/// Minimises the loss of the problem from its x. Returns the loss; its x, β and Gram matrix are those of that loss.
SRBF_DEVICE inline void levenberg_marquardt(const Block& block, const Problem& problem, float* shared) {
    constexpr double k_decrease_tolerance = 1e-7;
    Memory memory;
    memory.lay_out(problem.shape, shared, problem.doubles);
    const Shape& shape = problem.shape;
    const int n = shape.variables(), J = shape.lobes;
    block.each(n, [&](int i) { memory.x[i] = problem.x[i]; });
    const auto loss_at = [&](const double* x) {
        return loss(block, shape, problem.observed, problem.log_peak_limit, memory, x);
    };
    double mu = 1e-3, growth = 2, least = loss_at(memory.x), decrease = 0;
    for (int iteration = 0; iteration < problem.iterations;) {
        linearise(block, shape, problem.observed, memory, memory.x);
        ++iteration;
        block.each(1, [&](int) {
            double largest = 1e-300;
            for (int i = 0; i < n; ++i) largest = greater(largest, memory.hessian[i * n + i]);
            memory.number[1] = 1e-12 * largest;
        });
        const double floor = block.read(memory.number[1]);
        // Variables at a bound are fixed if the gradient pushes them outwards.
        block.each(n, [&](int i) {
            const double x = memory.x[i], g = memory.gradient[i];
            memory.partial[i] = (x <= problem.lower[i] && g > 0) || (x >= problem.upper[i] && g < 0);
        });
        block.each(n * n, [&](int at) {
            if (memory.partial[at / n] != 0 || memory.partial[at % n] != 0) memory.hessian[at] = 0;
        });
        block.each(n, [&](int i) {
            if (memory.partial[i] != 0) memory.gradient[i] = 0;
        });
        bool lowered = false;
        for (; mu < 1e10; mu *= growth, growth *= 2) {
            block.each(n * n, [&](int at) {
                memory.damped[at] = memory.hessian[at];
                if (at / n == at % n) memory.damped[at] += mu * greater(memory.hessian[at], floor);
                if (at < n) memory.step[at] = -memory.gradient[at];
            });
            solve_step(block, memory, n);
            block.each(1, [&](int) {
                double longest = 1;
                for (int i = 0; i < n; ++i)
                    longest = greater(
                        longest, ::fabs(memory.step[i]) / (i < shape.variates ? 0.5 : 0.5 * ::fabs(memory.x[i]) + 2));
                memory.number[2] = 1 / longest;
            });
            const double shrink = block.read(memory.number[2]);
            block.each(n, [&](int i) {
                double of_row = 0;
                for (int k = 0; k < n; ++k) of_row += memory.hessian[i * n + k] * (shrink * memory.step[k]);
                const double step = shrink * memory.step[i], to = memory.x[i] + step;
                memory.partial[i] = -2 * step * memory.gradient[i] - step * of_row;
                memory.next[i] = lesser(greater(to, problem.lower[i]), problem.upper[i]);
            });
            block.each(1, [&](int) {
                double sum = 0;
                for (int i = 0; i < n; ++i) sum += memory.partial[i];
                memory.number[3] = sum;
            });
            const double predicted = block.read(memory.number[3]);
            if (!(predicted > k_decrease_tolerance * least)) break;
            const double at_next = loss_at(memory.next);
            if (!(at_next < least)) continue;
            const double gain = (least - at_next) / predicted, cubed = 2 * gain - 1;
            mu *= greater(1.0 / 3, 1 - cubed * cubed * cubed);
            growth = 2;
            decrease = least - at_next;
            least = at_next;
            lowered = true;
            block.each(n, [&](int i) { memory.x[i] = memory.next[i]; });
            break;
        }
        if (!lowered) break;
        const int left = problem.iterations - iteration;
        if (iteration > 1 && least - left * decrease > problem.target) break;
    }
    // After linearisations the Gram matrix is another one.
    least = loss_at(memory.x);
    block.each(n, [&](int i) { problem.x[i] = memory.x[i]; });
    block.each(J * k_channels, [&](int i) { problem.beta[i] = memory.beta[i]; });
    block.each(J * J, [&](int at) { problem.gram[at] = entry(memory, J + k_channels, at / J, at % J); });
    block.each(1, [&](int) { *problem.loss = least; });
}

/// How much each candidate would lower the loss at x if it were added, at least about; at x it evaluates the loss.
SRBF_DEVICE inline void gains_of_additions(const Block& block, const Problem& problem, float* shared) {
    Memory memory;
    memory.lay_out(problem.shape, shared, problem.doubles);
    const Shape& shape = problem.shape;
    const Observed& of = problem.observed;
    const int J = shape.lobes, W = shape.width(), known = J + k_channels, stride = W + known + 1;
    const double at_x = loss(block, shape, of, problem.log_peak_limit, memory, problem.x);
    block.each(J * k_channels, [&](int i) { problem.beta[i] = memory.beta[i]; });
    block.each(J * J, [&](int at) { problem.gram[at] = entry(memory, known, at / J, at % J); });
    double* const factored = memory.adapting;
    block.each(1, [&](int) {
        *problem.loss = at_x;
        for (int i = 0; i < J; ++i)
            for (int k = 0; k <= i; ++k)
                factored[i * J + k] = entry(memory, known, i, k) * (i == k ? 1 + 1e-7 : 1.0) + (i == k ? 1e-300 : 0.0);
        factor(factored, J, J);
    });
    // A row of the tile: features, lobes, residuals, √w.
    const auto fill_tile = [&](int first, int count) {
        block.each(count, [&](int r) {
            Row row;
            const int i = first + r;
            lobes_of(shape, of, memory, i, row);
            float* const to = memory.tile + r * stride;
            for (int k = 0; k < W; ++k) to[k] = row.s[k];
            for (int j = 0; j < J; ++j) to[W + j] = row.lobe[j];
            for (int c = 0; c < k_channels; ++c) to[W + J + c] = rest_of(shape, of, memory, row, i, c);
            to[W + known] = of.root_weight[i];
        });
    };
    const auto for_tiles = [&](const auto& item) {
        for (int first = 0; first < of.pairs; first += k_tile) {
            const int count = of.pairs - first < k_tile ? of.pairs - first : k_tile;
            fill_tile(first, count);
            block.each(problem.candidate_count, [&](int k) { item(k, count); });
        }
    };
    const auto exponent_of = [&](int k, const float* row) {
        const float* const weight = problem.candidates + k * W;
        float sum = 0;
        for (int i = 0; i < W; ++i) sum = ::fmaf(weight[i], row[i], sum);
        return sum;
    };
    // The largest exponent of each candidate, then its products; both in the place of its gain and of the partial sums.
    const int sums = known + 1;
    block.each(problem.candidate_count, [&](int k) {
        problem.gain[k * (sums + 1)] = -3.402823466e38;
        for (int i = 1; i <= sums; ++i) problem.gain[k * (sums + 1) + i] = 0;
    });
    for_tiles([&](int k, int count) {
        for (int r = 0; r < count; ++r) {
            const float* const row = memory.tile + r * stride;
            if (row[W + known] > 0)
                problem.gain[k * (sums + 1)] = greater(problem.gain[k * (sums + 1)], double(exponent_of(k, row)));
        }
    });
    for_tiles([&](int k, int count) {
        double* const of_candidate = problem.gain + k * (sums + 1);
        const float offset = float(of_candidate[0]);
        float sum[k_most_lobes + k_channels + 1] = {};
        for (int r = 0; r < count; ++r) {
            const float* const row = memory.tile + r * stride;
            const float lobe = row[W + known] * exp(min(exponent_of(k, row) - offset, 0.f));
            for (int i = 0; i < known; ++i) sum[i] += lobe * row[W + i];
            sum[known] += lobe * lobe;
        }
        for (int i = 0; i < sums; ++i) of_candidate[1 + i] += double(sum[i]);
    });
    block.each(problem.candidate_count, [&](int k) {
        double* const of_candidate = problem.gain + k * (sums + 1);
        double product[k_most_lobes];
        const double whole = of_candidate[1 + known];
        double across = whole, gain = 0;
        for (int j = 0; j < J; ++j) product[j] = of_candidate[1 + j];
        solve_lower(factored, J, J, product);
        for (int j = 0; j < J; ++j) across -= product[j] * product[j] / factored[j * J + j];
        across = greater(across, 1e-4 * whole);
        for (int c = 0; c < k_channels; ++c) {
            const double with_rest = greater(of_candidate[1 + J + c], 0.0);
            gain += with_rest * with_rest;
        }
        of_candidate[0] = whole > 1e-60 ? gain / across : -1;
    });
}

}  // namespace srbf::on_device
