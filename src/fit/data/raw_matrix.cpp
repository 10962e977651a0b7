#include <fmt/format.h>

#include <algorithm>

#include "fit/data/raw_matrix.h"
#include "parallel.h"
#include "r_sequence.h"
#include "reporter.h"

namespace srbf {

Result<RawMatrix> tabulate(const Evaluate& f, const TabulateOptions& options, const ProgressToken& progress) {
    const FlushSubnormals mode;
    const auto n = std::size_t(std::max(options.directions, 0)), m = std::size_t(std::max(options.between, 0));
    if (n < k_least_views || n > k_most_views)
        return Error{"matrix",
                     {},
                     "number of directions",
                     fmt::format("{} to {}", k_least_views, k_most_views),
                     fmt::format("{}", options.directions),
                     ErrorCode::argument};
    if (options.between < 0 || m > k_most_between)
        return Error{"matrix",
                     {},
                     "number of directions between",
                     fmt::format("0 to {}", k_most_between),
                     fmt::format("{}", options.between),
                     ErrorCode::argument};
    RawMatrix matrix;
    matrix.discretise = options.discretise;
    matrix.direction = fibonacci_directions(int(n), k_pi / 2);
    matrix.f.resize(n * n);
    matrix.between.resize(n * m);
    const MirrorMixture mixture(k_pi / 2);
    struct Counts {
        std::uint64_t masked = 0, clamped = 0;
    };
    std::vector<Counts> counts(n);
    Reporter reporter(progress, double(n));
    parallel_for(n, options.threads, [&](std::size_t i) {
        if (!reporter.advance("tabulating", 1)) return;
        const Vec3f sampled = matrix.direction[i];
        const std::vector<Vec3f> fixed(std::max(n, m), sampled);
        const auto clamp = [&](Rgb& value) {
            std::uint64_t clamped = 0;
            for (int c = 0; c < 3; ++c)
                if (value[c] < 0) value[c] = 0, ++clamped;
            return clamped;
        };
        const std::span<Rgb> row(&matrix.f[i * n], n);
        f(matrix.direction, std::span(fixed).first(n), row);
        for (Rgb& value : row) {
            counts[i].masked += !is_finite(value);
            if (is_finite(value)) counts[i].clamped += clamp(value);
        }
        if (m == 0) return;
        // Each view has the same points, shifted by its own offset.
        RSequence<3> points({double(i % 97) / 97, double(i % 89) / 89, double(i % 83) / 83});
        std::vector<Vec3f> others;
        const std::span<RawMatrix::Between> between(&matrix.between[i * m], m);
        const Vec3d about = to_double(sampled);
        for (RawMatrix::Between& one : between) {
            const auto u = points.next();
            const Vec3d w = mixture.sample(about, u[0], u[1], u[2]);
            one.direction = to_float(w);
            one.pdf = float(mixture.pdf(w, about));
            others.push_back(one.direction);
        }
        std::vector<Rgb> values(m);
        if (options.discretise == Discretise::view)
            f(others, std::span(fixed).first(m), values);
        else
            f(std::span(fixed).first(m), others, values);
        for (std::size_t k = 0; k < m; ++k) {
            between[k].f = values[k];
            clamp(between[k].f);
        }
    });
    if (reporter.cancelled()) return cancelled_error("tabulate");
    for (const Counts& of_row : counts) matrix.masked += of_row.masked, matrix.clamped += of_row.clamped;
    return matrix;
}

}  // namespace srbf
