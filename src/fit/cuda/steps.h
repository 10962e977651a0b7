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
    double* gain;  ///< out: of each candidate, the first of Shape::of_candidate() numbers
};

SRBF_DEVICE inline Memory memory_of(const Problem& problem, float* shared) {
    Memory memory;
    memory.lay_out(problem.shape, shared, problem.doubles);
    return memory;
}
/// The loss of the problem at x.
SRBF_DEVICE inline double loss_at(const Block& block, const Problem& problem, const Memory& memory, const double* x) {
    return loss(block, problem.shape, problem.observed, problem.log_peak_limit, memory, x);
}
/// Gives out the loss of the last call of `loss_at`, with its β and Gram matrix.
SRBF_DEVICE inline void give_loss(const Block& block, const Problem& problem, const Memory& memory, double loss) {
    const int J = problem.shape.lobes;
    block.each(J * k_channels, [&](int i) { problem.beta[i] = memory.beta[i]; });
    block.each(J * J, [&](int at) { problem.gram[at] = entry(memory, problem.shape.with_data(), at / J, at % J); });
    block.each(1, [&](int) { *problem.loss = loss; });
}

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
            const double pivot = pivot_of(memory.partial[0]);
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

/// Fixes variables at a bound if the gradient pushes them outwards, as in least_squares.h.
SRBF_DEVICE inline void fix_at_bounds(const Block& block, const Problem& problem, const Memory& memory) {
    const int n = problem.shape.variables();
    block.each(n, [&](int i) {
        const double x = memory.x[i], g = memory.gradient[i];
        memory.partial[i] = (x <= problem.lower[i] && g > 0) || (x >= problem.upper[i] && g < 0);
    });
    block.each(n * n, [&](int at) {
        if (memory.partial[at / n] != 0 || memory.partial[at % n] != 0) memory.hessian[at] = 0;
        if (at < n && memory.partial[at] != 0) memory.gradient[at] = 0;
    });
}

/// Bound on the step of variable i, as LobeProblem::longest_step.
SRBF_DEVICE inline double longest_step(const Shape& shape, const double* x, int i) {
    return i < shape.variates ? 0.5 : 0.5 * ::fabs(x[i]) + 2;
}
/// Makes memory.next of the step with damping μ, shortened and within the bounds. `floor` is the least scale of a
/// variable. Returns the decrease of the loss that the Hessian predicts.
SRBF_DEVICE inline double damped_step(const Block& block, const Problem& problem, const Memory& memory, double mu,
                                      double floor) {
    const int n = problem.shape.variables();
    block.each(n * n, [&](int at) {
        memory.damped[at] = memory.hessian[at];
        if (at / n == at % n) memory.damped[at] += mu * greater(memory.hessian[at], floor);
        if (at < n) memory.step[at] = -memory.gradient[at];
    });
    solve_step(block, memory, n);
    block.each(n,
               [&](int i) { memory.partial[i] = ::fabs(memory.step[i]) / longest_step(problem.shape, memory.x, i); });
    const double shrink = block.once(*memory.number, [&] { return 1 / largest_of(memory.partial, n, 1, 1); });
    block.each(n, [&](int i) {
        double of_row = 0;
        for (int k = 0; k < n; ++k) of_row += memory.hessian[i * n + k] * (shrink * memory.step[k]);
        const double step = shrink * memory.step[i], to = memory.x[i] + step;
        memory.partial[i] = -2 * step * memory.gradient[i] - step * of_row;
        memory.next[i] = lesser(greater(to, problem.lower[i]), problem.upper[i]);
    });
    return block.once(*memory.number, [&] { return sum_of(memory.partial, n, 1); });
}

/// Minimises the loss of the problem from its x. Returns the loss; its x, β and Gram matrix are those of that loss.
SRBF_DEVICE inline void levenberg_marquardt(const Block& block, const Problem& problem, float* shared) {
    // As in least_squares.h.
    constexpr double k_decrease_tolerance = 1e-7, k_damping = 1e-3, k_most_damping = 1e10;
    constexpr double k_least_scale = 1e-12, k_least_diagonal = 1e-300;
    const Memory memory = memory_of(problem, shared);
    const int n = problem.shape.variables();
    block.each(n, [&](int i) { memory.x[i] = problem.x[i]; });
    double mu = k_damping, growth = 2, least = loss_at(block, problem, memory, memory.x), decrease = 0;
    for (int iteration = 1; iteration <= problem.iterations; ++iteration) {
        linearise(block, problem.shape, problem.observed, memory, memory.x);
        const double floor = block.once(
            *memory.number, [&] { return k_least_scale * largest_of(memory.hessian, n, n + 1, k_least_diagonal); });
        fix_at_bounds(block, problem, memory);
        bool lowered = false;
        while (mu < k_most_damping && !lowered) {
            const double predicted = damped_step(block, problem, memory, mu, floor);
            if (!(predicted > k_decrease_tolerance * least)) break;
            const double at_next = loss_at(block, problem, memory, memory.next);
            lowered = at_next < least;
            if (!lowered) {
                mu *= growth, growth *= 2;
                continue;
            }
            const double gain = 2 * ((least - at_next) / predicted) - 1;
            mu *= greater(1.0 / 3, 1 - gain * gain * gain);
            growth = 2;
            decrease = least - at_next;
            least = at_next;
            block.each(n, [&](int i) { memory.x[i] = memory.next[i]; });
        }
        if (!lowered) break;
        if (iteration > 1 && least - (problem.iterations - iteration) * decrease > problem.target) break;
    }
    // After linearisations the Gram matrix is another one.
    give_loss(block, problem, memory, loss_at(block, problem, memory, memory.x));
    block.each(n, [&](int i) { problem.x[i] = memory.x[i]; });
}

/// Calls item(numbers, weight, count) for each candidate and each tile of `count` rows of pairs. A row of the tile has
/// the features, what candidates are multiplied by (lobes, residuals), and √w.
template <typename Item>
SRBF_DEVICE void for_candidates(const Block& block, const Problem& problem, const Memory& memory, const Item& item) {
    const Shape& shape = problem.shape;
    const Observed& of = problem.observed;
    const int W = shape.width();
    for_tiles(0, of.pairs, [&](int first, int count) {
        block.each(count, [&](int r) {
            Row row;
            const int i = first + r;
            lobes_of(shape, of, memory, i, row);
            float* to = memory.tile + r * shape.beside_candidates();
            for (int k = 0; k < W; ++k) *to++ = row.s[k];
            for (int j = 0; j < shape.lobes; ++j) *to++ = row.lobe[j];
            for (int c = 0; c < k_channels; ++c) *to++ = rest_of(shape, of, memory, row, i, c);
            *to = of.root_weight[i];
        });
        block.each(problem.candidate_count,
                   [&](int k) { item(problem.gain + k * shape.of_candidate(), problem.candidates + k * W, count); });
    });
}
/// The numbers of each candidate but for its gain, in whose place is its largest exponent.
SRBF_DEVICE inline void products_with_candidates(const Block& block, const Problem& problem, const Memory& memory) {
    const Shape& shape = problem.shape;
    const int W = shape.width(), known = shape.with_data(), numbers = shape.of_candidate(),
              stride = shape.beside_candidates();
    block.each(problem.candidate_count * numbers,
               [&](int i) { problem.gain[i] = i % numbers == 0 ? double(k_lowest) : 0.0; });
    for_candidates(block, problem, memory, [&](double* of_candidate, const float* weight, int count) {
        for (int r = 0; r < count; ++r) {
            const float* const row = memory.tile + r * stride;
            if (row[W + known] > 0) of_candidate[0] = greater(of_candidate[0], double(exponent(shape, weight, row)));
        }
    });
    for_candidates(block, problem, memory, [&](double* of_candidate, const float* weight, int count) {
        const float offset = float(of_candidate[0]);
        float sum[k_most_lobes + k_channels + 1] = {};
        for (int r = 0; r < count; ++r) {
            const float* const row = memory.tile + r * stride;
            const float lobe = row[W + known] * exp(min(exponent(shape, weight, row) - offset, 0.f));
            for (int i = 0; i < known; ++i) sum[i] += lobe * row[W + i];
            sum[known] += lobe * lobe;
        }
        for (int i = 0; i <= known; ++i) of_candidate[1 + i] += double(sum[i]);
    });
}

/// How much each candidate would lower the loss at x if it were added, at least about; at x it evaluates the loss.
SRBF_DEVICE inline void gains_of_additions(const Block& block, const Problem& problem, float* shared) {
    constexpr double k_nothing = 1e-60, k_least_across = 1e-4;  // as in LobeProblem::best_addition
    const Memory memory = memory_of(problem, shared);
    const Shape& shape = problem.shape;
    const int J = shape.lobes;
    give_loss(block, problem, memory, loss_at(block, problem, memory, problem.x));
    block.each(1, [&](int) {
        factor_lobes(shape, memory, shape.with_data(), 0, k_ridge_of_present, [](int) { return true; });
    });
    products_with_candidates(block, problem, memory);
    block.each(problem.candidate_count, [&](int k) {
        double* const of_candidate = problem.gain + k * shape.of_candidate();
        double with_lobes[k_most_lobes], gain = 0;
        for (int j = 0; j < J; ++j) with_lobes[j] = of_candidate[1 + j];
        solve_lower(memory.factored, J, J, with_lobes);
        const double whole = of_candidate[1 + shape.with_data()];
        const double across = without_lobes(memory, J, whole, with_lobes, with_lobes);
        for (int c = 0; c < k_channels; ++c) {
            const double with_rest = greater(of_candidate[1 + J + c], 0.0);
            gain += with_rest * with_rest;
        }
        of_candidate[0] = whole > k_nothing ? gain / greater(across, k_least_across * whole) : -1;
    });
}

}  // namespace srbf::on_device
