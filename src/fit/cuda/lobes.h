// Lobes as a separable least-squares problem on a block of threads: what LobeProblem (fit/solve/lobe_problem.h)
// computes for pairs and radiances, in the same order of variables. See there for the symbols.
#pragma once
#include <limits>

#include "fit/cuda/block.h"
#include "srbf/terms.h"

namespace srbf::on_device {

constexpr int k_channels = 3;
constexpr int k_most_angles = 24;  ///< derivatives by angles: 8 variates of 3 components
constexpr int k_most_width = k_most_angles + int(k_terms.size());  ///< weights of a lobe
constexpr int k_most_lobes = 16;                                   ///< J
constexpr int k_tile = 32;                                         ///< rows in shared memory at a time
constexpr int k_lanes = 256;                                       ///< partial sums and maxima over rows
constexpr int k_radiance_lanes = 32;
constexpr float k_lowest = std::numeric_limits<float>::lowest();  ///< of exponents
constexpr int k_most_columns = 352;                               ///< of a tile, a multiple of k_square
constexpr int k_square = 4;  ///< a thread sums the products of 4 × 4 columns at a time, in registers
constexpr int k_shared = k_tile * k_most_columns;  ///< floats of the largest tile: 44 KiB

// Copies of the numbers of solve/least_squares.cpp, which needs Eigen.
constexpr double k_ridge = 1e-6;             ///< of products of lobes with optimal coefficients
constexpr double k_ridge_of_present = 1e-7;  ///< of those of the present lobes, as `ridged`
constexpr double k_least_pivot = 1e-300;     ///< smaller ones count as k_infinite_pivot
constexpr double k_infinite_pivot = 1e300;   ///< its reciprocal is 0 beside any other

/// Structure of the lobes, and the places of columns and variables.
struct Shape {
    int variates, components, terms, lobes;
    bool reciprocal;

    SRBF_DEVICE int directional() const { return variates * components; }
    SRBF_DEVICE int width() const { return directional() + terms; }
    SRBF_DEVICE int variables() const { return variates + lobes * width(); }
    /// Columns E_j s_i, then those of the angles: one for each channel or lobe, whichever are fewer; then E_j, then
    /// residuals.
    SRBF_DEVICE int sums() const { return lobes < k_channels ? lobes : k_channels; }
    SRBF_DEVICE int first_angle() const { return lobes * width(); }
    SRBF_DEVICE int first_lobe() const { return first_angle() + sums() * variates; }
    SRBF_DEVICE int derivatives() const { return first_lobe() + lobes; }
    SRBF_DEVICE int columns() const { return derivatives() + k_channels; }
    SRBF_DEVICE int with_data() const { return lobes + k_channels; }  ///< columns of the loss: E_j, data
    /// Numbers of a candidate to add: its gain, and its products with lobes, residuals and itself.
    SRBF_DEVICE int of_candidate() const { return 1 + with_data() + 1; }
    /// Numbers of a row beside candidates: features, lobes, residuals, √w.
    SRBF_DEVICE int beside_candidates() const { return width() + with_data() + 1; }
    SRBF_DEVICE int factors() const { return reciprocal ? 2 : 1; }  ///< Gaussians of a variate
};
/// Whether a problem of that shape fits into the limits above.
SRBF_DEVICE inline bool fits(const Shape& shape) {
    return shape.lobes <= k_most_lobes && shape.width() <= k_most_width && shape.columns() <= k_most_columns;
}

/// The observations: arrays as in Rows (fit/solve/rows.h), on the device.
struct Observed {
    const float *wl[3], *wv[3], *root_weight, *y[k_channels];
    int pairs;                        ///< number of rows of pairs
    int radiances, rows_of_radiance;  ///< rows of radiances follow
    double scale;
};

/// The memory of a problem: numbers of a block that outlive a loop.
struct Memory {
    float* tile;  ///< k_tile rows of columns, shared
    double *gram, *by_column, *hessian, *damped, *gradient, *step, *x, *next;
    double *beta, *limit, *offset, *partial, *across, *factored, *number;
    float *angle, *weight;  ///< what rows need of x: N times cos, then sin of the angles; J × W weights

    /// Lays out the parts in `doubles`, or counts them if there are none yet. `most` is the largest shape.
    SRBF_DEVICE std::size_t lay_out(const Shape& most, float* shared, double* doubles) {
        std::size_t used = 0;
        const auto take = [&](double*& to, int count) {
            to = doubles ? doubles + used : nullptr;
            used += std::size_t(count);
        };
        const int n = most.variables(), J = most.lobes, D = most.derivatives(), all = most.columns();
        tile = shared;
        take(gram, all * all), take(by_column, n * D), take(hessian, n * n), take(damped, n * n);
        take(gradient, n), take(step, n), take(x, n), take(next, n);
        take(beta, J * k_channels), take(limit, J), take(offset, J), take(across, n * J), take(factored, J * J);
        take(partial, k_lanes * (J > k_channels ? J : k_channels) + 1), take(number, 1);
        double *angles = nullptr, *weights = nullptr;
        take(angles, most.variates), take(weights, (J * most.width() + 1) / 2);
        angle = reinterpret_cast<float*>(angles), weight = reinterpret_cast<float*>(weights);
        return used;
    }
    /// The number of doubles that a shape needs.
    SRBF_DEVICE static std::size_t doubles(const Shape& shape) { return Memory{}.lay_out(shape, nullptr, nullptr); }
};

/// What the columns of one row are made of.
struct Row {
    float s[k_most_width], by_angle[k_most_angles], lobe[k_most_lobes];
};

/// Adds factor times the features of ψ of angle (a, b), and sign times its derivatives.
SRBF_DEVICE inline void add_variate(const Shape& shape, Vec3<Number> wl, Vec3<Number> wv, float a, float b, float sign,
                                    float* s, float* by_angle) {
    const Vec3<Number> psi = Formula::psi(wl, wv, a, b), derivative = Formula::psi_by_angle(wl, wv, a, b);
    const Number below = Formula::gaussian_exponent(psi, Vec3<Number>(0.f, 0.f, 1.f), 1.f);
    if (shape.components == 3) {
        s[0] += psi.x.value, s[1] += psi.y.value;
        by_angle[0] += sign * derivative.x.value, by_angle[1] += sign * derivative.y.value;
    }
    s[shape.components - 1] += below.value;
    by_angle[shape.components - 1] += sign * derivative.z.value;
}

/// Keeps what rows need of the variables, in floats.
SRBF_DEVICE inline void keep(const Block& block, const Shape& shape, const Memory& memory, const double* x) {
    const int N = shape.variates;
    block.each(N + shape.lobes * shape.width(), [&](int i) {
        if (i < N)
            memory.angle[i] = float(::cos(x[i])), memory.angle[N + i] = float(::sin(x[i]));
        else
            memory.weight[i - N] = float(x[i]);
    });
}
/// The features of row i for the variables that are kept.
SRBF_CALLED void features_of(const Shape& shape, const Observed& of, const Memory& memory, int i, Row& row) {
    const Vec3<Number> wl(of.wl[0][i], of.wl[1][i], of.wl[2][i]), wv(of.wv[0][i], of.wv[1][i], of.wv[2][i]);
    for (int k = 0; k < shape.directional(); ++k) row.s[k] = row.by_angle[k] = 0;
    for (int n = 0; n < shape.variates; ++n) {
        const float a = memory.angle[n], b = memory.angle[shape.variates + n];
        float *s = row.s + n * shape.components, *by_angle = row.by_angle + n * shape.components;
        add_variate(shape, wl, wv, a, b, 1, s, by_angle);
        // The angle of (b, a) is π/2 minus that of (a, b).
        if (shape.reciprocal) add_variate(shape, wl, wv, b, a, -1, s, by_angle);
    }
    const auto further = Formula::pm_further_features(shape.terms, wl, wv);
    for (int k = 0; k < shape.terms; ++k) row.s[shape.directional() + k] = further.x[k].value;
}

/// Σ weight s, with one rounding a term: terms of sharp lobes are large and nearly cancel.
SRBF_DEVICE inline float exponent(const Shape& shape, const float* weight, const float* s) {
    float sum = 0;
    for (int i = 0; i < shape.width(); ++i) sum = ::fmaf(weight[i], s[i], sum);
    return sum;
}
SRBF_DEVICE inline const double* weights_of(const Shape& shape, const double* x, int j) {
    return x + shape.variates + j * shape.width();
}
/// Features and lobes of row i: √w exp(exponent − offset).
SRBF_CALLED void lobes_of(const Shape& shape, const Observed& of, const Memory& memory, int i, Row& row) {
    features_of(shape, of, memory, i, row);
    for (int j = 0; j < shape.lobes; ++j) {
        const float above = exponent(shape, memory.weight + j * shape.width(), row.s) - float(memory.offset[j]);
        row.lobe[j] = of.root_weight[i] * exp(min(above, 0.f));
    }
}
SRBF_DEVICE inline float rest_of(const Shape& shape, const Observed& of, const Memory& memory, const Row& row, int i,
                                 int c) {
    float rest = of.y[c][i];
    for (int j = 0; j < shape.lobes; ++j) rest -= float(memory.beta[j * k_channels + c]) * row.lobe[j];
    return rest;
}

/// Calls visit(first, count) for each tile of the rows begin..end−1.
template <typename Visit> SRBF_DEVICE void for_tiles(int begin, int end, const Visit& visit) {
    for (int first = begin; first < end; first += k_tile) visit(first, end - first < k_tile ? end - first : k_tile);
}
/// Calls visit(begin, end) with the rows of each radiance.
template <typename Visit> SRBF_DEVICE void for_radiances(const Observed& of, const Visit& visit) {
    for (int i = 0, begin = of.pairs; i < of.radiances; ++i, begin += of.rows_of_radiance)
        visit(begin, begin + of.rows_of_radiance);
}

/// Adds the products of columns over a tile to the lower triangle of the n × n matrix, for a square of products.
/// Squares are numbered by rows of their triangle; a row of the tile has `stride` columns.
SRBF_DEVICE inline void add_square(const Memory& memory, int n, int stride, int square) {
    int down = int((::sqrtf(8.f * float(square) + 1) - 1) / 2);
    while (down * (down + 1) / 2 > square) --down;
    while ((down + 1) * (down + 2) / 2 <= square) ++down;
    const int first = k_square * down, first_across = k_square * (square - down * (down + 1) / 2);
    float sum[k_square][k_square] = {};
    for (int r = 0; r < k_tile; ++r) {
        const float *a = memory.tile + r * stride + first, *b = memory.tile + r * stride + first_across;
        for (int i = 0; i < k_square; ++i)
            for (int k = 0; k < k_square; ++k) sum[i][k] += a[i] * b[k];
    }
    for (int i = first; i < first + k_square && i < n; ++i)
        for (int k = first_across; k < first_across + k_square && k <= i; ++k)
            memory.gram[i * n + k] += double(sum[i - first][k - first_across]);
}
/// The lower triangle of the n × n matrix of products of columns: over pairs their sum, over radiances products of
/// their sums. fill(i, to) writes the columns of row i.
template <typename Fill>
SRBF_DEVICE void gram(const Block& block, const Observed& of, int n, const Memory& memory, const Fill& fill) {
    const int squares = (n + k_square - 1) / k_square, stride = squares * k_square;
    block.each(n * n, [&](int i) { memory.gram[i] = 0; });
    const auto fill_tile = [&](int first, int count) {
        block.each(k_tile, [&](int r) {
            float* const to = memory.tile + r * stride;
            if (r < count) fill(first + r, to);
            for (int i = r < count ? n : 0; i < stride; ++i) to[i] = 0;
        });
    };
    for_tiles(0, of.pairs, [&](int first, int count) {
        fill_tile(first, count);
        block.each(squares * (squares + 1) / 2, [&](int square) { add_square(memory, n, stride, square); });
    });
    for_radiances(of, [&](int begin, int end) {
        block.each(n, [&](int i) { memory.partial[i] = 0; });
        for_tiles(begin, end, [&](int first, int count) {
            fill_tile(first, count);
            block.each(n, [&](int i) {
                float sum = 0;
                for (int r = 0; r < k_tile; ++r) sum += memory.tile[r * stride + i];
                memory.partial[i] += double(sum);
            });
        });
        block.each(n * n, [&](int at) {
            const int i = at / n, k = at % n;
            if (k <= i) memory.gram[at] += memory.partial[i] * memory.partial[k];
        });
    });
}
/// Entry (i, k) of the symmetric matrix.
SRBF_DEVICE inline double entry(const Memory& memory, int n, int i, int k) {
    return i >= k ? memory.gram[i * n + k] : memory.gram[k * n + i];
}

/// A pivot that is not positive counts as infinite: its variable becomes 0.
SRBF_DEVICE inline double pivot_of(double d) { return d > k_least_pivot ? d : k_infinite_pivot; }
/// Factors the symmetric n × n matrix A, of which the lower triangle is given, into L D Lᵀ in place: L below the
/// diagonal, D on it.
SRBF_CALLED void factor(double* A, int n, int stride) {
    for (int k = 0; k < n; ++k)
        for (int i = k; i < n; ++i) {
            double sum = A[i * stride + k];
            for (int j = 0; j < k; ++j) sum -= A[i * stride + j] * A[k * stride + j] * A[j * stride + j];
            A[i * stride + k] = i == k ? pivot_of(sum) : sum / A[k * stride + k];
        }
}
/// x ← L⁻¹ x, and x ← (L D Lᵀ)⁻¹ x.
SRBF_CALLED void solve_lower(const double* A, int n, int stride, double* x) {
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < i; ++j) x[i] -= A[i * stride + j] * x[j];
}
SRBF_CALLED void solve(const double* A, int n, int stride, double* x) {
    solve_lower(A, n, stride, x);
    for (int i = 0; i < n; ++i) x[i] /= A[i * stride + i];
    for (int i = n; i-- > 0;)
        for (int j = i + 1; j < n; ++j) x[i] -= A[j * stride + i] * x[j];
}

/// Factors the products of the present lobes in the n × n matrix, in which they start at `first`, with a ridge. Lobes
/// that do not count, by counts(j), have a row of the identity. By one thread, into memory.factored.
template <typename Counts>
SRBF_DEVICE void factor_lobes(const Shape& shape, const Memory& memory, int n, int first, double ridge,
                              const Counts& counts) {
    const int J = shape.lobes;
    for (int i = 0; i < J; ++i)
        for (int k = 0; k <= i; ++k) {
            const double identity = i == k ? 1 : 0, product = entry(memory, n, first + i, first + k);
            memory.factored[i * J + k] = counts(i) && counts(k) ? product * (1 + ridge * identity) : identity;
        }
    factor(memory.factored, J, J);
}
/// product − aᵀ D⁻¹ b with the D of these factors: what is left of a product of columns without their components along
/// the lobes, where a and b are L⁻¹ times their products with the lobes.
SRBF_DEVICE inline double without_lobes(const Memory& memory, int J, double product, const double* a, const double* b) {
    for (int j = 0; j < J; ++j) product -= a[j] * b[j] / memory.factored[j * J + j];
    return product;
}

/// The active set of `bounded_least_squares`, as in solve/least_squares.cpp: the columns have unit length.
struct ActiveSet {
    enum Place : unsigned char { at_zero, free, at_upper };
    static constexpr int k_most = k_most_lobes;
    const Memory& memory;
    int n, of_gram;
    double reciprocal[k_most] = {}, g[k_most] = {}, upper[k_most] = {}, x[k_most] = {};
    Place place[k_most] = {};

    /// Entry (i, k) of the matrix G.
    SRBF_DEVICE double scaled(int i, int k) const {
        return reciprocal[i] * entry(memory, of_gram, i, k) * reciprocal[k] + (i == k ? k_ridge : 0.0);
    }
    /// Component i of g − G at.
    SRBF_DEVICE double descent(int i, const double* at) const {
        double sum = g[i];
        for (int k = 0; k < n; ++k) sum -= scaled(i, k) * at[k];
        return sum;
    }
    /// Frees the variable whose release decreases the sum fastest, if any does by more than the tolerance.
    SRBF_DEVICE bool release(double tolerance) {
        int best = -1;
        double best_rate = tolerance;
        for (int i = 0; i < n; ++i) {
            const double by = descent(i, x), rate = place[i] == at_zero ? by : place[i] == at_upper ? -by : 0;
            if (rate > best_rate && reciprocal[i] > 0 && upper[i] > 0) best = i, best_rate = rate;
        }
        if (best >= 0) place[best] = free;
        return best >= 0;
    }
    /// Moves the free variables towards their optimum, to the first bound that one of them crosses; false: none does.
    SRBF_DEVICE bool step() {
        int passive[k_most], count = 0, crossed = -1;
        double held[k_most], target[k_most], A[k_most * k_most], fraction = 1;
        for (int i = 0; i < n; ++i) {
            held[i] = place[i] == free ? 0 : x[i];
            if (place[i] == free) passive[count++] = i;
        }
        for (int r = 0; r < count; ++r) {
            target[r] = descent(passive[r], held);
            for (int k = 0; k <= r; ++k) A[r * k_most + k] = scaled(passive[r], passive[k]);
        }
        factor(A, count, k_most);
        solve(A, count, k_most, target);
        for (int r = 0; r < count; ++r) {
            const int i = passive[r];
            const double to = target[r], bounded = to < 0 ? 0.0 : upper[i];
            if (to >= 0 && to <= upper[i]) continue;
            const double t = to == x[i] ? 0 : (bounded - x[i]) / (to - x[i]);
            if (t < fraction) fraction = greater(t, 0.0), crossed = r;
        }
        for (int r = 0; r < count; ++r) x[passive[r]] += fraction * (target[r] - x[passive[r]]);
        if (crossed < 0) return false;
        const int i = passive[crossed];
        place[i] = target[crossed] < 0 ? at_zero : at_upper;
        x[i] = place[i] == at_zero ? 0 : upper[i];
        return true;
    }
};

/// The coefficients of channel c, by one thread: `bounded_least_squares` of least_squares.h for the products of lobes
/// and data.
SRBF_CALLED void fit_coefficients(const Shape& shape, const Memory& memory, int c) {
    constexpr double k_least_length = 1e-150, k_tolerance = 1e-12;
    ActiveSet set{memory, shape.lobes, shape.with_data()};
    const int J = shape.lobes;
    double steepest = 0;
    for (int i = 0; i < J; ++i) {
        const double length = ::sqrt(greater(entry(memory, set.of_gram, i, i), 0.0));
        set.reciprocal[i] = length > k_least_length ? 1 / length : 0.0;
        set.g[i] = set.reciprocal[i] * entry(memory, set.of_gram, J + c, i);
        set.upper[i] = memory.limit[i] * length;
        steepest = greater(steepest, ::fabs(set.g[i]));
    }
    for (int round = 0; round < 6 * J + 6 && set.release(k_tolerance * steepest); ++round)
        for (int inner = 0; inner <= J && set.step(); ++inner) {
        }
    // Bounds are met exactly.
    for (int i = 0; i < J; ++i) {
        const double most = memory.limit[i], inside = lesser(greater(set.reciprocal[i] * set.x[i], 0.0), most);
        memory.beta[i * k_channels + c] = set.place[i] == ActiveSet::at_zero    ? 0
                                          : set.place[i] == ActiveSet::at_upper ? most
                                                                                : inside;
    }
}

/// |p| of a variate.
SRBF_DEVICE inline double bandwidth_of(const Shape& shape, const double* p) {
    return shape.components == 1 ? ::fabs(p[0]) : ::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
}
/// Log of the factor from β_j to the coefficient of a lobe with peak 1, as log_peak_factor of fit/model/lobes.h.
SRBF_DEVICE inline double log_peak_factor(const Shape& shape, const double* weight, double offset) {
    double sum = -offset;
    for (int n = 0; n < shape.variates; ++n) {
        const double* p = weight + n * shape.components;
        sum += shape.factors() * (bandwidth_of(shape, p) - p[shape.components - 1]);
    }
    return sum;
}

/// The largest exponent of each lobe, and the limit of its coefficients.
SRBF_DEVICE inline void bound_coefficients(const Block& block, const Shape& shape, const Observed& of,
                                           double log_peak_limit, const Memory& memory, const double* x) {
    constexpr double k_most_exponent = 700;  // of exp, as LobeProblem::bound_coefficients
    const int J = shape.lobes, rows = of.pairs + of.radiances * of.rows_of_radiance;
    block.each(k_lanes, [&](int lane) {
        Row row;
        float most[k_most_lobes];
        for (int j = 0; j < J; ++j) most[j] = k_lowest;
        for (int i = lane; i < rows; i += k_lanes) {
            if (!(of.root_weight[i] > 0)) continue;
            features_of(shape, of, memory, i, row);
            for (int j = 0; j < J; ++j)
                most[j] = max(most[j], exponent(shape, memory.weight + j * shape.width(), row.s));
        }
        for (int j = 0; j < J; ++j) memory.partial[lane * J + j] = double(most[j]);
    });
    block.each(J, [&](int j) {
        memory.offset[j] = largest_of(memory.partial + j, k_lanes, J, double(k_lowest));
        const double factor = log_peak_factor(shape, weights_of(shape, x, j), memory.offset[j]);
        memory.limit[j] = ::exp(lesser(log_peak_limit - ::log(of.scale) - factor, k_most_exponent));
    });
}

/// Sums over the rows begin..end−1 into memory.partial, one for each lane and channel. add(sum, c, residual) adds the
/// residual of channel c of a row to the sums of a lane.
template <typename Add>
SRBF_DEVICE void add_residuals(const Block& block, const Shape& shape, const Observed& of, const Memory& memory,
                               int begin, int end, int lanes, const Add& add) {
    block.each(lanes, [&](int lane) {
        Row row;
        double sum[k_channels] = {};
        for (int i = begin + lane; i < end; i += lanes) {
            lobes_of(shape, of, memory, i, row);
            for (int c = 0; c < k_channels; ++c) add(sum, c, double(rest_of(shape, of, memory, row, i, c)));
        }
        for (int c = 0; c < k_channels; ++c) memory.partial[lane * k_channels + c] = sum[c];
    });
}
/// The sum of squares of the residuals of pairs and of radiances.
SRBF_DEVICE inline double loss_of_residuals(const Block& block, const Shape& shape, const Observed& of,
                                            const Memory& memory) {
    // The squares of all channels are one sum.
    add_residuals(block, shape, of, memory, 0, of.pairs, k_lanes,
                  [](double* sum, int, double rest) { sum[0] += rest * rest; });
    double loss = block.once(*memory.number, [&] { return sum_of(memory.partial, k_lanes, k_channels); });
    for_radiances(of, [&](int begin, int end) {
        add_residuals(block, shape, of, memory, begin, end, k_radiance_lanes,
                      [](double* sum, int c, double rest) { sum[c] += rest; });
        loss = block.once(*memory.number, [&] {
            double with_radiance = loss;
            for (int c = 0; c < k_channels; ++c) {
                const double rest = sum_of(memory.partial + c, k_radiance_lanes, k_channels);
                with_radiance += rest * rest;
            }
            return with_radiance;
        });
    });
    return loss;
}

/// The loss at x, with the optimal coefficients, which are kept in the memory with the offsets and the Gram matrix of
/// lobes and data.
SRBF_CALLED double loss(const Block& block, const Shape& shape, const Observed& of, double log_peak_limit,
                        const Memory& memory, const double* x) {
    const int J = shape.lobes;
    keep(block, shape, memory, x);
    bound_coefficients(block, shape, of, log_peak_limit, memory, x);
    gram(block, of, shape.with_data(), memory, [&](int i, float* to) {
        Row row;
        lobes_of(shape, of, memory, i, row);
        for (int j = 0; j < J; ++j) to[j] = row.lobe[j];
        for (int c = 0; c < k_channels; ++c) to[J + c] = of.y[c][i];
    });
    block.each(k_channels, [&](int c) { fit_coefficients(shape, memory, c); });
    return loss_of_residuals(block, shape, of, memory);
}

/// Calls visit(column, factor) for the columns that the derivative of channel c by variable v is made of.
template <typename Visit>
SRBF_DEVICE void for_columns(const Shape& shape, const Memory& memory, const double* x, int c, int v,
                             const Visit& visit) {
    const int N = shape.variates, W = shape.width(), C = shape.components, J = shape.lobes;
    if (v < N) {
        if (k_channels < J) return visit(shape.first_angle() + c * N + v, 1.0);
        for (int j = 0; j < J; ++j) visit(shape.first_angle() + j * N + v, memory.beta[j * k_channels + c]);
        return;
    }
    const int j = (v - N) / W, i = (v - N) % W;
    const double beta = memory.beta[j * k_channels + c];
    if (!(beta > 0)) return;
    visit(j * W + i, beta);
    if (beta < memory.limit[j] || i >= shape.directional()) return;
    // The coefficient follows its bound: by the derivative of p_z − |p|.
    const double* p = weights_of(shape, x, j) + i / C * C;
    const double bandwidth = bandwidth_of(shape, p);
    if (bandwidth == 0) return;
    const double by = (i % C == C - 1 ? 1.0 : 0.0) - p[i % C] / bandwidth;
    visit(shape.first_lobe() + j, beta * shape.factors() * by);
}
/// from + Σ factor number(column) over these columns.
template <typename Number>
SRBF_DEVICE double add_columns(const Shape& shape, const Memory& memory, const double* x, int c, int v, double from,
                               const Number& number) {
    for_columns(shape, memory, x, c, v, [&](int column, double factor) { from += factor * number(column); });
    return from;
}

/// The columns of row i of which derivatives are made, and its residuals.
SRBF_DEVICE inline void columns_of(const Shape& shape, const Observed& of, const Memory& memory, const double* x, int i,
                                   float* to) {
    const int J = shape.lobes, N = shape.variates, W = shape.width(), C = shape.components;
    Row row;
    lobes_of(shape, of, memory, i, row);
    for (int j = 0; j < J; ++j)
        for (int k = 0; k < W; ++k) to[j * W + k] = row.lobe[j] * row.s[k];
    for (int s = 0; s < shape.sums(); ++s)
        for (int v = 0; v < N; ++v) {
            float column = 0;
            for (int k = v * C; k < (v + 1) * C; ++k) {
                float sum = 0;
                for (int j = 0; j < J; ++j) {
                    const double of_lobe = k_channels < J ? memory.beta[j * k_channels + s] : j == s ? 1.0 : 0.0;
                    sum += float(of_lobe * weights_of(shape, x, j)[k]) * row.lobe[j];
                }
                column += sum * row.by_angle[k];
            }
            to[shape.first_angle() + s * N + v] = column;
        }
    for (int j = 0; j < J; ++j) to[shape.first_lobe() + j] = row.lobe[j];
    for (int c = 0; c < k_channels; ++c) to[shape.derivatives() + c] = rest_of(shape, of, memory, row, i, c);
}

/// Adds the products of the derivatives of channel c to the lower triangle of the Hessian, less their components along
/// the lobes whose coefficients adapt.
SRBF_DEVICE inline void add_channel(const Block& block, const Shape& shape, const Memory& memory, const double* x,
                                    int c) {
    const int J = shape.lobes, n = shape.variables(), D = shape.derivatives(), all = shape.columns();
    block.each(n * D, [&](int at) {
        const int v = at / D, column = at % D;
        memory.by_column[at] =
            add_columns(shape, memory, x, c, v, 0, [&](int k) { return entry(memory, all, k, column); });
    });
    const auto adapts = [&](int j) {
        const double beta = memory.beta[j * k_channels + c];
        return beta > 0 && beta < memory.limit[j];
    };
    block.each(1, [&](int) { factor_lobes(shape, memory, all, shape.first_lobe(), k_ridge, adapts); });
    block.each(n, [&](int v) {
        double* const row = memory.across + v * J;
        for (int j = 0; j < J; ++j) row[j] = adapts(j) ? memory.by_column[v * D + shape.first_lobe() + j] : 0;
        solve_lower(memory.factored, J, J, row);
    });
    block.each(n * n, [&](int at) {
        const int u = at / n, v = at % n;
        if (v > u) return;
        const double product =
            add_columns(shape, memory, x, c, v, 0, [&](int column) { return memory.by_column[u * D + column]; });
        memory.hessian[at] += without_lobes(memory, J, product, memory.across + u * J, memory.across + v * J);
    });
}

/// JᵀJ and Jᵀr at the x of the last call of `loss`, by Kaufman's approximation, into memory.hessian and
/// memory.gradient. It overwrites the Gram matrix.
SRBF_CALLED void linearise(const Block& block, const Shape& shape, const Observed& of, const Memory& memory,
                           const double* x) {
    const int n = shape.variables(), D = shape.derivatives(), all = shape.columns();
    gram(block, of, all, memory, [&](int i, float* to) { columns_of(shape, of, memory, x, i, to); });
    block.each(n * n, [&](int i) { memory.hessian[i] = 0; });
    block.each(n, [&](int v) {
        double sum = 0;
        for (int c = 0; c < k_channels; ++c)
            sum = add_columns(shape, memory, x, c, v, sum, [&](int k) { return -entry(memory, all, D + c, k); });
        memory.gradient[v] = sum;
    });
    for (int c = 0; c < k_channels; ++c) add_channel(block, shape, memory, x, c);
    block.each(n * n, [&](int at) {
        const int u = at / n, v = at % n;
        if (v > u) memory.hessian[at] = memory.hessian[v * n + u];
    });
}

}  // namespace srbf::on_device
