#include <numeric>

#include "base/errors.h"
#include "base/parallel.h"
#include "base/r_sequence.h"
#include "base/reporter.h"
#include "brdf/directions.h"
#include "brdf/values.h"
#include "observe/raw_matrix.h"

namespace SRBF_NAMESPACE {
namespace {

/// All sampled directions have the same points, each shifted by its own offset: remainders by primes, which differ
/// for any two of at most k_max_views directions.
RSequence<3> points_of_row(std::size_t i) {
    return RSequence<3>({double(i % 97) / 97, double(i % 89) / 89, double(i % 83) / 83});
}

/// Samples f at the direction `sampled` and a random direction for each element of `row`.
void sample_between(const Evaluate& f, Discretise discretise, Vec3f sampled, RSequence<3> points,
                    std::span<RawMatrix::DrawnValue> row) {
    const MirrorMixture mixture(k_pi / 2);
    std::vector<Vec3f> others;
    for (RawMatrix::DrawnValue& element : row) {
        const auto u = points.next();
        const Vec3d w = mixture.sample(to_double(sampled), u[0], u[1], u[2]);
        element.direction = to_float(w);
        element.pdf = float(mixture.pdf(w, to_double(sampled)));
        others.push_back(element.direction);
    }
    const std::vector<Vec3f> repeated(row.size(), sampled);
    std::vector<Rgb> values(row.size());
    if (discretise == Discretise::view)
        f(others, repeated, values);
    else
        f(repeated, others, values);
    for (std::size_t k = 0; k < row.size(); ++k) row[k].f = non_negative(values[k]);
}

}  // namespace

Result<RawMatrix> tabulate(const Evaluate& f, const TabulateOptions& options, const ProgressToken& progress) {
    const StandardArithmetic mode;
    const auto valid = require_range("matrix", "number of directions", options.directions, k_min_views, k_max_views);
    if (!valid) return valid.error();
    const auto n = std::size_t(options.directions), m = std::size_t(options.between);
    RawMatrix matrix;
    matrix.discretise = options.discretise;
    matrix.direction = fibonacci_directions(options.directions, k_pi / 2);
    matrix.f.resize(n * n);
    matrix.between.resize(n * m);
    std::vector<std::uint64_t> masked(n), clamped(n);
    Reporter reporter(progress, double(n));
    parallel_for(n, options.threads, [&](std::size_t i) {
        if (!reporter.advance("tabulating", 1)) return;
        const std::vector<Rgb> values = values_towards(f, matrix.direction, matrix.direction[i]);
        for (std::size_t k = 0; k < n; ++k) {
            Rgb& value = matrix.f[i * n + k] = values[k];
            masked[i] += !is_finite(value);
            if (is_finite(value)) clamped[i] += std::uint64_t(clamp_negative(value));
        }
        if (m > 0)
            sample_between(f, options.discretise, matrix.direction[i], points_of_row(i),
                           std::span(matrix.between).subspan(i * m, m));
    });
    if (reporter.cancelled()) return cancelled_error("tabulate");
    matrix.masked = std::reduce(masked.begin(), masked.end());
    matrix.clamped = std::reduce(clamped.begin(), clamped.end());
    return matrix;
}

}  // namespace
