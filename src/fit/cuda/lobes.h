// Lobes as a separable least-squares problem on a block of threads: what LobeProblem (fit/solve/lobe_problem.h) computes for pairs
// and radiances, in the same order of variables. See there for the symbols.
#pragma once
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
constexpr int k_most_columns = 352;  ///< of a tile, which is 45 KiB then

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
    double *beta, *limit, *offset, *partial, *adapting, *number;
    float *angle, *weight;  ///< what rows need of x: N times cos, then sin of the angles; J × W weights

    static constexpr int k_numbers = 8;
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
        take(beta, J * k_channels), take(limit, J), take(offset, J), take(adapting, n * J + J * J);
        take(partial, k_lanes * (J > k_channels ? J : k_channels) + 1), take(number, k_numbers);
        double *angles = nullptr, *weights = nullptr;
        take(angles, most.variates), take(weights, (J * most.width() + 1) / 2);
        angle = reinterpret_cast<float*>(angles), weight = reinterpret_cast<float*>(weights);
        return used;
    }
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
SRBF_DEVICE inline float exponent(const Shape& shape, const float* weight, const Row& row) {
    float sum = 0;
    for (int i = 0; i < shape.width(); ++i) sum = ::fmaf(weight[i], row.s[i], sum);
    return sum;
}
SRBF_DEVICE inline const double* weights_of(const Shape& shape, const double* x, int j) {
    return x + shape.variates + j * shape.width();
}
/// Features and lobes of row i: √w exp(exponent − offset).
SRBF_CALLED void lobes_of(const Shape& shape, const Observed& of, const Memory& memory, int i, Row& row) {
    features_of(shape, of, memory, i, row);
    for (int j = 0; j < shape.lobes; ++j) {
        const float above = exponent(shape, memory.weight + j * shape.width(), row) - float(memory.offset[j]);
        row.lobe[j] = of.root_weight[i] * exp(min(above, 0.f));
    }
}
SRBF_DEVICE inline float rest_of(const Shape& shape, const Observed& of, const Memory& memory, const Row& row, int i,
                                 int c) {
    float rest = of.y[c][i];
    for (int j = 0; j < shape.lobes; ++j) rest -= float(memory.beta[j * k_channels + c]) * row.lobe[j];
    return rest;
}

/// The lower triangle of the n × n matrix of products of columns: over pairs their sum, over radiances products of
/// their sums. fill(i, to) writes the columns of row i. A thread keeps the sums of a square of 4 × 4 products over a
/// tile in registers.
template <typename Fill>
SRBF_DEVICE void gram(const Block& block, const Observed& of, int n, const Memory& memory, const Fill& fill) {
    const int stride = (n + 3) / 4 * 4, squares = stride / 4;
    block.each(n * n, [&](int i) { memory.gram[i] = 0; });
    const auto fill_tile = [&](int first, int count) {
        block.each(k_tile, [&](int r) {
            float* const to = memory.tile + r * stride;
            if (r < count) fill(first + r, to);
            for (int i = r < count ? n : 0; i < stride; ++i) to[i] = 0;
        });
    };
    for (int first = 0; first < of.pairs; first += k_tile) {
        fill_tile(first, of.pairs - first < k_tile ? of.pairs - first : k_tile);
        block.each(squares * (squares + 1) / 2, [&](int square) {
            int down = int((::sqrtf(8.f * float(square) + 1) - 1) / 2);
            while (down * (down + 1) / 2 > square) --down;
            while ((down + 1) * (down + 2) / 2 <= square) ++down;
            const int across = square - down * (down + 1) / 2;
            float sum[4][4] = {};
            for (int r = 0; r < k_tile; ++r) {
                const float *a = memory.tile + r * stride + 4 * down, *b = memory.tile + r * stride + 4 * across;
                for (int i = 0; i < 4; ++i)
                    for (int k = 0; k < 4; ++k) sum[i][k] += a[i] * b[k];
            }
            for (int i = 4 * down; i < 4 * down + 4 && i < n; ++i)
                for (int k = 4 * across; k < 4 * across + 4 && k <= i; ++k)
                    memory.gram[i * n + k] += double(sum[i - 4 * down][k - 4 * across]);
        });
    }
    for (int radiance = 0; radiance < of.radiances; ++radiance) {
        const int begin = of.pairs + radiance * of.rows_of_radiance, end = begin + of.rows_of_radiance;
        block.each(n, [&](int i) { memory.partial[i] = 0; });
        for (int first = begin; first < end; first += k_tile) {
            fill_tile(first, end - first < k_tile ? end - first : k_tile);
            block.each(n, [&](int i) {
                float sum = 0;
                for (int r = 0; r < k_tile; ++r) sum += memory.tile[r * stride + i];
                memory.partial[i] += double(sum);
            });
        }
        block.each(n * n, [&](int at) {
            const int i = at / n, k = at % n;
            if (k <= i) memory.gram[at] += memory.partial[i] * memory.partial[k];
        });
    }
}
/// Entry (i, k) of the symmetric matrix.
SRBF_DEVICE inline double entry(const Memory& memory, int n, int i, int k) {
    return i >= k ? memory.gram[i * n + k] : memory.gram[k * n + i];
}

/// Factors the symmetric n × n matrix A, of which the lower triangle is given, into L D Lᵀ in place: L below the
/// diagonal, D on it. A pivot that is not positive counts as infinite: its variable becomes 0.
SRBF_CALLED void factor(double* A, int n, int stride) {
    for (int k = 0; k < n; ++k) {
        for (int j = 0; j < k; ++j) A[k * stride + k] -= A[k * stride + j] * A[k * stride + j] * A[j * stride + j];
        double& pivot = A[k * stride + k];
        if (!(pivot > 1e-300)) pivot = 1e300;
        for (int i = k + 1; i < n; ++i) {
            double sum = A[i * stride + k];
            for (int j = 0; j < k; ++j) sum -= A[i * stride + j] * A[k * stride + j] * A[j * stride + j];
            A[i * stride + k] = sum / pivot;
        }
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

/// `bounded_least_squares` of least_squares.h, by one thread: the x within 0 ≤ x ≤ upper that minimises ½ xᵀGx − gᵀx,
/// for the first n rows and columns of the Gram matrix and its column `data`.
SRBF_CALLED void bounded_least_squares(const Memory& memory, int of_gram, int n, int data, const double* upper_in,
                                       double* out, int out_stride) {
    constexpr double k_ridge = 1e-6;
    constexpr int most = k_most_lobes;
    enum Place : unsigned char { at_zero, free, at_upper };
    double length[most], reciprocal[most], g[most], upper[most], x[most], held[most], target[most], A[most * most];
    int passive[most];
    Place place[most];
    double largest = 0;
    for (int i = 0; i < n; ++i) {
        length[i] = ::sqrt(greater(entry(memory, of_gram, i, i), 0.0));
        reciprocal[i] = length[i] > 1e-150 ? 1 / length[i] : 0.0;
        g[i] = reciprocal[i] * entry(memory, of_gram, data, i);
        upper[i] = upper_in[i] * length[i];
        x[i] = 0, place[i] = at_zero;
        largest = greater(largest, ::fabs(g[i]));
    }
    const auto scaled = [&](int i, int k) {
        return reciprocal[i] * entry(memory, of_gram, i, k) * reciprocal[k] + (i == k ? k_ridge : 0.0);
    };
    const double tolerance = 1e-12 * largest;
    for (int round = 0; round < 6 * n + 6; ++round) {
        int best = -1;
        double best_rate = tolerance;
        for (int i = 0; i < n; ++i) {
            double descent = g[i];
            for (int k = 0; k < n; ++k) descent -= scaled(i, k) * x[k];
            const double rate = place[i] == at_zero ? descent : place[i] == at_upper ? -descent : 0;
            if (rate > best_rate && reciprocal[i] > 0 && upper[i] > 0) best = i, best_rate = rate;
        }
        if (best < 0) break;
        place[best] = free;
        for (int inner = 0; inner <= n; ++inner) {
            int count = 0;
            for (int i = 0; i < n; ++i) {
                held[i] = place[i] == free ? 0 : x[i];
                if (place[i] == free) passive[count++] = i;
            }
            for (int r = 0; r < count; ++r) {
                double sum = g[passive[r]];
                for (int k = 0; k < n; ++k) sum -= scaled(passive[r], k) * held[k];
                target[r] = sum;
                for (int k = 0; k <= r; ++k) A[r * most + k] = scaled(passive[r], passive[k]);
            }
            factor(A, count, most);
            solve(A, count, most, target);
            double fraction = 1;
            int crossed = -1;
            Place bound = at_zero;
            for (int r = 0; r < count; ++r) {
                const int i = passive[r];
                const double to = target[r], bounded = to < 0 ? 0.0 : upper[i];
                if (to >= 0 && to <= upper[i]) continue;
                const double t = to == x[i] ? 0 : (bounded - x[i]) / (to - x[i]);
                if (t < fraction) fraction = greater(t, 0.0), crossed = i, bound = to < 0 ? at_zero : at_upper;
            }
            for (int r = 0; r < count; ++r) x[passive[r]] += fraction * (target[r] - x[passive[r]]);
            if (crossed < 0) break;
            place[crossed] = bound;
            x[crossed] = bound == at_zero ? 0 : upper[crossed];
        }
    }
    for (int i = 0; i < n; ++i)
        out[i * out_stride] = place[i] == at_zero    ? 0
                              : place[i] == at_upper ? upper_in[i]
                                                     : lesser(greater(reciprocal[i] * x[i], 0.0), upper_in[i]);
}

/// Log of the factor from β_j to the coefficient of a lobe with peak 1, as log_peak_factor of fit/model/lobes.h.
SRBF_DEVICE inline double log_peak_factor(const Shape& shape, const double* weight, double offset) {
    double sum = -offset;
    for (int n = 0; n < shape.variates; ++n) {
        const double* p = weight + n * shape.components;
        const double z = p[shape.components - 1];
        const double bandwidth = shape.components == 1 ? ::fabs(z) : ::sqrt(p[0] * p[0] + p[1] * p[1] + z * z);
        sum += (shape.reciprocal ? 2 : 1) * (bandwidth - z);
    }
    return sum;
}

/// The loss at x, with the optimal coefficients, which are kept in the memory with the offsets and the Gram matrix of
/// lobes and data.
SRBF_CALLED double loss(const Block& block, const Shape& shape, const Observed& of, double log_peak_limit,
                        const Memory& memory, const double* x) {
    const int J = shape.lobes, rows = of.pairs + of.radiances * of.rows_of_radiance;
    keep(block, shape, memory, x);
    block.each(k_lanes, [&](int lane) {
        Row row;
        float most[k_most_lobes];
        for (int j = 0; j < J; ++j) most[j] = -3.402823466e38f;
        for (int i = lane; i < rows; i += k_lanes) {
            if (!(of.root_weight[i] > 0)) continue;
            features_of(shape, of, memory, i, row);
            for (int j = 0; j < J; ++j) most[j] = max(most[j], exponent(shape, memory.weight + j * shape.width(), row));
        }
        for (int j = 0; j < J; ++j) memory.partial[lane * J + j] = double(most[j]);
    });
    block.each(J, [&](int j) {
        double most = memory.partial[j];
        for (int lane = 1; lane < k_lanes; ++lane) most = greater(most, memory.partial[lane * J + j]);
        memory.offset[j] = most;
        const double factor = log_peak_factor(shape, weights_of(shape, x, j), most);
        memory.limit[j] = ::exp(lesser(log_peak_limit - ::log(of.scale) - factor, 700.0));
    });
    const int n = J + k_channels;
    gram(block, of, n, memory, [&](int i, float* to) {
        Row row;
        lobes_of(shape, of, memory, i, row);
        for (int j = 0; j < J; ++j) to[j] = row.lobe[j];
        for (int c = 0; c < k_channels; ++c) to[J + c] = of.y[c][i];
    });
    block.each(k_channels,
               [&](int c) { bounded_least_squares(memory, n, J, J + c, memory.limit, memory.beta + c, k_channels); });
    block.each(k_lanes, [&](int lane) {
        Row row;
        double sum = 0;
        for (int i = lane; i < of.pairs; i += k_lanes) {
            lobes_of(shape, of, memory, i, row);
            for (int c = 0; c < k_channels; ++c) {
                const double rest = double(rest_of(shape, of, memory, row, i, c));
                sum += rest * rest;
            }
        }
        memory.partial[lane] = sum;
    });
    block.each(1, [&](int) {
        double sum = 0;
        for (int lane = 0; lane < k_lanes; ++lane) sum += memory.partial[lane];
        memory.number[0] = sum;
    });
    for (int radiance = 0; radiance < of.radiances; ++radiance) {
        const int begin = of.pairs + radiance * of.rows_of_radiance, end = begin + of.rows_of_radiance;
        block.each(k_radiance_lanes, [&](int lane) {
            Row row;
            double sum[k_channels] = {};
            for (int i = begin + lane; i < end; i += k_radiance_lanes) {
                lobes_of(shape, of, memory, i, row);
                for (int c = 0; c < k_channels; ++c) sum[c] += double(rest_of(shape, of, memory, row, i, c));
            }
            for (int c = 0; c < k_channels; ++c) memory.partial[lane * k_channels + c] = sum[c];
        });
        block.each(1, [&](int) {
            for (int c = 0; c < k_channels; ++c) {
                double sum = 0;
                for (int lane = 0; lane < k_radiance_lanes; ++lane) sum += memory.partial[lane * k_channels + c];
                memory.number[0] += sum * sum;
            }
        });
    }
    return block.read(memory.number[0]);
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
    const double z = p[C - 1], bandwidth = C == 1 ? ::fabs(z) : ::sqrt(p[0] * p[0] + p[1] * p[1] + z * z);
    if (bandwidth == 0) return;
    const double by = (i % C == C - 1 ? 1.0 : 0.0) - p[i % C] / bandwidth;
    visit(shape.first_lobe() + j, beta * (shape.reciprocal ? 2 : 1) * by);
}

/// JᵀJ and Jᵀr at the x of the last call of `loss`, by Kaufman's approximation, into memory.hessian and
/// memory.gradient. It overwrites the Gram matrix.
SRBF_CALLED void linearise(const Block& block, const Shape& shape, const Observed& of, const Memory& memory,
                           const double* x) {
    const int J = shape.lobes, N = shape.variates, W = shape.width(), C = shape.components, n = shape.variables(),
              D = shape.derivatives(), all = shape.columns();
    gram(block, of, all, memory, [&](int i, float* to) {
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
        for (int c = 0; c < k_channels; ++c) to[D + c] = rest_of(shape, of, memory, row, i, c);
    });
    block.each(n * n, [&](int i) { memory.hessian[i] = 0; });
    block.each(n, [&](int v) {
        double sum = 0;
        for (int c = 0; c < k_channels; ++c)
            for_columns(shape, memory, x, c, v,
                        [&](int column, double factor) { sum -= factor * entry(memory, all, D + c, column); });
        memory.gradient[v] = sum;
    });
    double *const across = memory.adapting, *const factored = memory.adapting + n * J;
    for (int c = 0; c < k_channels; ++c) {
        block.each(n * D, [&](int at) {
            const int v = at / D, column = at % D;
            double sum = 0;
            for_columns(shape, memory, x, c, v,
                        [&](int k, double factor) { sum += factor * entry(memory, all, k, column); });
            memory.by_column[at] = sum;
        });
        // Of the coefficients that adapt; the others have an empty row.
        const auto adapts = [&](int j) {
            const double beta = memory.beta[j * k_channels + c];
            return beta > 0 && beta < memory.limit[j];
        };
        block.each(1, [&](int) {
            for (int i = 0; i < J; ++i)
                for (int k = 0; k <= i; ++k) {
                    const bool both = adapts(i) && adapts(k);
                    const double product =
                        both ? entry(memory, all, shape.first_lobe() + i, shape.first_lobe() + k) : 0;
                    factored[i * J + k] = i == k ? (both ? product * (1 + 1e-6) : 1.0) : product;
                }
            factor(factored, J, J);
        });
        block.each(n, [&](int v) {
            double* const row = across + v * J;
            for (int j = 0; j < J; ++j) row[j] = adapts(j) ? memory.by_column[v * D + shape.first_lobe() + j] : 0;
            solve_lower(factored, J, J, row);
        });
        block.each(n * n, [&](int at) {
            const int u = at / n, v = at % n;
            if (v > u) return;
            double sum = 0;
            for_columns(shape, memory, x, c, v,
                        [&](int column, double factor) { sum += factor * memory.by_column[u * D + column]; });
            for (int j = 0; j < J; ++j) sum -= across[u * J + j] * across[v * J + j] / factored[j * J + j];
            memory.hessian[at] += sum;
        });
    }
    block.each(n * n, [&](int at) {
        const int u = at / n, v = at % n;
        if (v > u) memory.hessian[at] = memory.hessian[v * n + u];
    });
}

}  // namespace srbf::on_device
