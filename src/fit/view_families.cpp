#include "fit/view_families.h"

#include <algorithm>
#include <limits>

#include "fit/lobes.h"
#include "parallel.h"
#include "srbf/kernel.h"

namespace srbf {
namespace {

/// What an edge costs whose mean ΔE_ITP is 1, relative to as large an error of one view's pixels.
constexpr double k_edge = 20;
/// A family begins with this many more fits of its first view.
constexpr int k_first_fits = 4;
/// An edge is faded if it exceeds the mean of the edges of so many views on either side by this factor. What continues
/// across it may have edges up to this factor, and cost up to this factor more than the choice.
constexpr std::size_t k_near = 16, k_most_faded = 64;
constexpr double k_seen_edge = 1.5, k_continued_edge = 2, k_continued_cost = 2;
/// Views after which progress is told.
constexpr std::size_t k_told = 16;

std::vector<ViewLobe> moved(const std::vector<ViewLobe>& lobes, Vec3f from, Vec3f to) {
    return with_mirror_direction(rotated(lobes, from, to), from, to);
}

/// The colours of a view's pixels: for each block a column for each channel.
std::vector<Aligned<float>> colours(const ViewRows& rows, const SeenFit& fit) {
    const std::size_t J = fit.lobes.size();
    const Vec3f across = Kernel<float>::tangent_across(rows.view);
    Eigen::MatrixXd beta(J, 3);
    for (std::size_t j = 0; j < J; ++j)
        for (std::size_t c = 0; c < 3; ++c) beta(Eigen::Index(j), Eigen::Index(c)) = fit.coefficient[j][c] / rows.scale;
    std::vector<Aligned<float>> blocks(rows.seen.directions.blocks);
    Aligned<float> exponent(k_block), values(J * k_block);
    std::vector<const float*> columns;
    for (std::size_t j = 0; j < J; ++j) columns.push_back(&values[j * k_block]);
    for (std::size_t block = 0; block < blocks.size(); ++block) {
        const float* const exposure = &rows.seen.exposure[block * k_block];
        for (std::size_t j = 0; j < J; ++j) {
            const ViewLobe& lobe = fit.lobes[j];
            const MovingLobe still{to_float(lobe.centre), {}, float(lobe.bandwidth), float(lobe.shape), across};
            exponents(rows.seen.directions, block, still, exposure, exponent.data());
            exponentiate(exponent.data(), exposure, 0, &values[j * k_block]);
        }
        combined(beta, columns, blocks[block]);
    }
    return blocks;
}
Pixels::Colours columns_of(const Aligned<float>& block) { return {&block[0], &block[k_block], &block[2 * k_block]}; }

/// What is seen of the edges between the fits of a view and those of its neighbour, whose lobes have been moved to the
/// view: the mean ΔE_ITP of the view's pixels.
Eigen::MatrixXd edges(const ViewRows& rows, std::span<const SeenFit> fits, std::span<const SeenFit> neighbours) {
    const auto all_colours = [&](std::span<const SeenFit> of) {
        std::vector<std::vector<Aligned<float>>> all;
        for (const SeenFit& fit : of) all.push_back(colours(rows, fit));
        return all;
    };
    const std::size_t count = rows.seen.pixels.count();
    const auto here = all_colours(fits), there = all_colours(neighbours);
    Eigen::MatrixXd apart = Eigen::MatrixXd::Zero(Eigen::Index(fits.size()), Eigen::Index(neighbours.size()));
    for (std::size_t a = 0; a < fits.size(); ++a) {
        std::vector<Pixels::Triplet> reference(count);
        for (std::size_t p = 0; p < count; ++p)
            for (std::size_t c = 0; c < 3; ++c)
                reference[p][c] = double(columns_of(here[a][p / k_block])[c][p % k_block]);
        const Pixels pixels(reference);
        for (std::size_t b = 0; b < neighbours.size(); ++b)
            for (std::size_t block = 0; block < pixels.blocks(); ++block)
                apart(Eigen::Index(a), Eigen::Index(b)) +=
                    pixels.delta_e(block, columns_of(there[b][block])) / double(count);
    }
    return apart;
}

}  // namespace

std::vector<std::size_t> least_path(std::span<const Eigen::VectorXd> cost, std::span<const Eigen::MatrixXd> between) {
    std::vector<Eigen::VectorXd> sum(cost.begin(), cost.end());  // of the best path to each a_i
    for (std::size_t i = 1; i < sum.size(); ++i)
        sum[i] += (between[i - 1].colwise() + sum[i - 1]).colwise().minCoeff().transpose();
    std::vector<std::size_t> path(sum.size());
    for (std::size_t i = sum.size(); i-- > 0;) {
        Eigen::VectorXd to_next = sum[i];
        if (i + 1 < sum.size()) to_next += between[i].col(Eigen::Index(path[i + 1]));
        Eigen::Index least = 0;
        to_next.minCoeff(&least);
        path[i] = std::size_t(least);
    }
    return path;
}

std::vector<std::size_t> faded(const std::vector<std::size_t>& path, std::span<const Eigen::VectorXd> cost,
                               std::span<const Eigen::MatrixXd> between) {
    const std::size_t n = path.size();
    std::vector<std::size_t> result = path;
    std::size_t end = 0;  // of the last fade
    for (std::size_t i = 1; i < n; ++i) {
        if (i <= end) continue;
        const auto edge = [&](std::size_t k) { return between[k](Eigen::Index(path[k]), Eigen::Index(path[k + 1])); };
        const std::size_t first = i - std::min(i, k_near), last = std::min(n - 1, i + k_near);
        double near = 0;
        for (std::size_t k = first; k < last; ++k) near += edge(k) / double(last - first);
        if (!(edge(i - 1) > k_seen_edge * near)) continue;
        // The families that look most like what this view shows, in the next views upwards or downwards.
        const auto continued = [&](std::size_t view, bool upwards, std::size_t most) {
            std::vector<std::size_t> families;
            for (auto family = Eigen::Index(path[view]); families.size() < most;
                 families.push_back(std::size_t(family))) {
                Eigen::VectorXd edges;
                if (upwards) edges = between[view].row(family);
                if (!upwards) edges = between[view - 1].col(family);
                view = upwards ? view + 1 : view - 1;
                const double dear = k_continued_cost * cost[view][Eigen::Index(path[view])];
                for (Eigen::Index a = 0; a < edges.size(); ++a)
                    if (cost[view][a] > dear) edges[a] = std::numeric_limits<double>::infinity();
                if (edges.minCoeff(&family) > k_continued_edge * near) break;
            }
            return families;
        };
        const std::vector<std::size_t> below = continued(i, false, std::min(k_most_faded, i - end)),
                                       above = continued(i - 1, true, std::min(k_most_faded, n - i));
        const std::size_t reach = std::min(below.size(), above.size());
        double share = 0;  // of views above the edge, that are due
        for (std::size_t k = 0; k < 2 * reach; ++k) {
            const double t = (double(k) + 0.5) / double(2 * reach);
            share += t * t * (3 - 2 * t);
            const std::size_t view = i - reach + k;
            const bool is_above = share >= 0.5;
            if (is_above) share -= 1;
            if (is_above && view < i) result[view] = below[i - 1 - view];
            if (!is_above && view >= i) result[view] = above[view - i];
        }
        end = i + reach;
    }
    return result;
}

std::vector<SeenFit> fit_families(const SampledViews& views, std::span<const ViewFit> fits,
                                  std::span<const double> share, int lobes, bool shaped,
                                  const std::function<bool(double)>& done) {
    std::vector<SeenFit> result(views.count());
    std::vector<std::size_t> with_data;
    for (std::size_t i = 0; i < fits.size(); ++i)
        if (!fits[i].is_empty()) with_data.push_back(i);
    const std::size_t n = with_data.size(), families = std::min(k_families, n);
    const auto rows = [&](std::size_t i) -> const ViewRows& { return views.rows(with_data[i]); };
    const auto next = [&](ViewProblem& problem, std::size_t i, std::size_t from, const std::vector<ViewLobe>& its) {
        return fit_seen(problem, rows(i), moved(its, rows(from).view, rows(i).view), share[with_data[i]]);
    };

    // By view and family. The two ways from where a family begins are followed side by side.
    std::vector<std::vector<SeenFit>> followed(n, std::vector<SeenFit>(families));
    parallel_for(2 * families, [&](std::size_t way) {
        ViewProblem problem(lobes, shaped);
        const std::size_t family = way / 2, begin = (2 * family + 1) * n / (2 * families);
        SeenFit last = next(problem, begin, begin, fits[with_data[begin]].lobes);
        for (int more = 0; more < k_first_fits; ++more) last = next(problem, begin, begin, last.lobes);
        if (way % 2 == 0) followed[begin][family] = last;
        for (std::size_t i = begin; way % 2 == 0 ? i-- > 0 : ++i < n;) {
            const std::size_t from = way % 2 == 0 ? i + 1 : i - 1;
            last = followed[i][family] = next(problem, i, from, last.lobes);
            if (i % k_told == 0 && !done(double(k_told) / double(families))) return;
        }
    });
    if (!done(0)) return result;

    std::vector<Eigen::VectorXd> cost(n);
    std::vector<Eigen::MatrixXd> between(n > 0 ? n - 1 : 0);
    parallel_for(n, [&](std::size_t i) {
        // A view is seen by its projected area.
        const double seen_area = double(rows(i).view.z),
                     pixels = share[with_data[i]] * double(rows(i).seen.pixels.count());
        cost[i].resize(Eigen::Index(families));
        for (std::size_t a = 0; a < families; ++a)
            cost[i][Eigen::Index(a)] = seen_area * followed[i][a].loss / (pixels > 0 ? pixels : 1);
        if (i + 1 == n) return;
        std::vector<SeenFit> neighbours = followed[i + 1];
        for (SeenFit& fit : neighbours) fit.lobes = moved(fit.lobes, rows(i + 1).view, rows(i).view);
        between[i] = Eigen::MatrixXd::Zero(Eigen::Index(families), Eigen::Index(families));
        if (pixels > 0) between[i] = k_edge * seen_area * edges(rows(i), followed[i], neighbours);
    });
    const std::vector<std::size_t> path = faded(least_path(cost, between), cost, between);
    for (std::size_t i = 0; i < n; ++i) result[with_data[i]] = std::move(followed[i][path[i]]);
    return result;
}

}  // namespace srbf
