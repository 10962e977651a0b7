#include "models/su/view_tracks.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include "base/parallel.h"
#include "models/pm/solve/columns.h"
#include "models/pm/solve/pixel_term.h"
#include "srbf/elementary.h"
#include "srbf/kernel.h"

namespace srbf {
namespace {

/// What an edge costs whose mean ΔE_ITP is 1, relative to as large an error of one view's pixels: as much as if that
/// many views were off by it.
constexpr double k_edge = 20;
/// An edge is faded if it exceeds the mean of the edges of so many nearby by this factor. What continues across it may
/// have edges up to a factor times that mean, or up to a share of the faded one, and cost up to a factor more than the
/// choice.
constexpr std::size_t k_near = 16;
constexpr double k_visible_edge = 1.5, k_continued_edge = 2, k_continued_share = 0.5, k_continued_cost = 2;
/// The cosines of the views on either side that a fade is over differ by at most this, so that it is as wide however many
/// views there are: 64 of the default 1536.
constexpr double k_fade_range = 1.0 / 24;
/// A track begins with this many more fits of its first view, each of a few steps with pixels.
constexpr int k_first_fits = 4;
/// A view's lobes are means over views whose cosines differ by less, unless their loss is larger by a factor.
constexpr double k_mean_range = 1.0 / 192, k_cost_of_mean = 1.1;
/// Views after which progress is told, and the share of the work that means are.
constexpr std::size_t k_told = 16;
constexpr double k_work_of_means = 0.2;

/// The colours of a view's pixels: for each block a column for each channel.
std::vector<Aligned<float>> colours(const ViewRows& rows, const ViewFit& fit) {
    const std::size_t J = fit.lobes.size();
    const Vec3f across = Kernel<float>::tangent_across(rows.view);
    Eigen::MatrixXd beta(J, 3);
    for (std::size_t j = 0; j < J; ++j)
        for (std::size_t c = 0; c < 3; ++c) beta(Eigen::Index(j), Eigen::Index(c)) = fit.coefficient[j][c] / rows.scale;
    std::vector<Aligned<float>> blocks(rows.pixels.directions.blocks);
    Aligned<float> exponent(k_block), values(J * k_block);
    std::vector<const float*> columns;
    for (std::size_t j = 0; j < J; ++j) columns.push_back(&values[j * k_block]);
    for (std::size_t block = 0; block < blocks.size(); ++block) {
        const float* const exposure = &rows.pixels.exposure[block * k_block];
        for (std::size_t j = 0; j < J; ++j) {
            const ViewLobe& lobe = fit.lobes[j];
            const MovingLobe still{to_float(lobe.centre), {}, float(lobe.bandwidth), float(lobe.shape), across};
            exponents(rows.pixels.directions, block, still, exposure, exponent.data());
            exponentiate(exponent.data(), exposure, 0, &values[j * k_block]);
        }
        combined(beta, columns, blocks[block]);
    }
    return blocks;
}
Pixels::Colours columns_of(const Aligned<float>& block) { return {&block[0], &block[k_block], &block[2 * k_block]}; }

/// The visible errors that edges are, between the fits of a view and those of its neighbour, whose lobes have been moved
/// to the view: Σ ΔE_ITP of the view's pixels.
Eigen::MatrixXd edges(const ViewRows& rows, std::span<const ViewFit> fits, std::span<const ViewFit> neighbours) {
    const auto all_colours = [&](std::span<const ViewFit> of) {
        std::vector<std::vector<Aligned<float>>> all;
        for (const ViewFit& fit : of) all.push_back(colours(rows, fit));
        return all;
    };
    const std::size_t count = rows.pixels.reference.count();
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
                apart(Eigen::Index(a), Eigen::Index(b)) += pixels.delta_e(block, columns_of(there[b][block]));
    }
    return apart;
}

/// An edge of a path between the views i − 1 and i.
struct VisibleEdge {
    std::size_t i;
    double height, near;  ///< near: mean of the edges nearby
};

/// The edges of a path that stand out, the largest first.
std::vector<VisibleEdge> visible_edges(const std::vector<std::size_t>& path, std::span<const Eigen::MatrixXd> between) {
    const std::size_t n = path.size();
    const auto edge = [&](std::size_t k) { return between[k](Eigen::Index(path[k]), Eigen::Index(path[k + 1])); };
    std::vector<VisibleEdge> visible;
    for (std::size_t i = 1; i < n; ++i) {
        const std::size_t first = i - std::min(i, k_near), last = std::min(n - 1, i + k_near);
        double near = 0;
        for (std::size_t k = first; k < last; ++k) near += edge(k) / double(last - first);
        if (edge(i - 1) > k_visible_edge * near) visible.push_back({i, edge(i - 1), near});
    }
    std::ranges::stable_sort(visible, std::greater(), [](const VisibleEdge& e) { return e.height - e.near; });
    return visible;
}

}  // namespace

std::vector<std::size_t> viterbi_path(std::span<const Eigen::VectorXd> cost, std::span<const Eigen::MatrixXd> between) {
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
                               std::span<const Eigen::MatrixXd> between, std::size_t most) {
    const std::size_t n = path.size();
    std::vector<std::size_t> result = path;
    std::vector<bool> is_faded(n, false);
    // The largest first, since fades do not overlap.
    for (const auto& [i, height, near] : visible_edges(path, between)) {
        std::size_t free_below = 0, free_above = 0;
        while (free_below < std::min(i, most) && !is_faded[i - 1 - free_below]) ++free_below;
        while (free_above < std::min(n - i, most) && !is_faded[i + free_above]) ++free_above;
        const double most_edge = std::max(k_continued_edge * near, k_continued_share * height);
        // The tracks that look most like what this view shows, in the next views upwards or downwards.
        const auto continued = [&](std::size_t view, bool upwards, std::size_t free) {
            std::vector<std::size_t> tracks;
            for (auto track = Eigen::Index(path[view]); tracks.size() < free; tracks.push_back(std::size_t(track))) {
                Eigen::VectorXd edges;
                if (upwards) edges = between[view].row(track);
                if (!upwards) edges = between[view - 1].col(track);
                view = upwards ? view + 1 : view - 1;
                const double dear = k_continued_cost * cost[view][Eigen::Index(path[view])];
                for (Eigen::Index a = 0; a < edges.size(); ++a)
                    if (cost[view][a] > dear) edges[a] = std::numeric_limits<double>::infinity();
                if (edges.minCoeff(&track) > most_edge) break;
            }
            return tracks;
        };
        const std::vector<std::size_t> below = continued(i, false, free_below),
                                       above = continued(i - 1, true, free_above);
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
        std::fill_n(is_faded.begin() + std::ptrdiff_t(i - reach), 2 * reach, true);
    }
    return result;
}

namespace {

/// The fits of each view with data, of all tracks.
using Followed = std::vector<std::vector<ViewFit>>;

/// The stages of `fit_tracks`, in the order in which they follow.
struct Tracks {
    const SampledViews& views;
    int lobes;
    bool shaped;
    std::vector<std::size_t> with_data = {};
    std::vector<ViewFit> begun = {};  ///< of each track: the fit by pairs of the view where it begins
    double share = 0;                 ///< what a pixel costs

    std::size_t count() const { return std::min(k_tracks, with_data.size()); }
    const ViewRows& rows(std::size_t i) const { return views.rows(with_data[i]); }
    double share_of(std::size_t i) const { return rows(i).pixels.reference.count() > 0 ? share : 0; }
    /// The view where a track begins: they are evenly spread.
    std::size_t beginning(std::size_t track) const { return (2 * track + 1) * with_data.size() / (2 * count()); }
    ViewFit next(ViewProblem& problem, std::size_t i, std::size_t from, const std::vector<ViewLobe>& its) const {
        return fit_with_pixels(problem, rows(i), moved(its, rows(from).view, rows(i).view), share_of(i));
    }

    /// Finds views with data, fits those where tracks begin, and sets the share to the geometric mean of what suits
    /// these: one for all views, so that nothing but the measurement changes from view to view.
    void begin(std::uint64_t seed) {
        for (std::size_t i = 0; i < views.count(); ++i)
            if (views.rows(i).scale > 0) with_data.push_back(i);
        begun.resize(count());
        std::vector<double> of_track(count());
        parallel_for(count(), [&](std::size_t track) {
            std::seed_seq seeds{std::uint32_t(seed), std::uint32_t(seed >> 32), std::uint32_t(track)};
            std::mt19937_64 random(seeds);
            ViewProblem problem(lobes, shaped);
            const ViewRows& first = rows(beginning(track));
            begun[track] = fit_view_from_scratch(problem, first, std::size_t(lobes), random);
            of_track[track] = pixel_share(problem, first, begun[track]);
        });
        std::erase(of_track, 0.0);
        double sum = 0;
        for (const double of : of_track) sum += elementary::log(of) / double(of_track.size());
        if (!of_track.empty()) share = elementary::exp(sum);
    }

    /// The two ways from where a track begins are followed side by side. Nothing if stopped.
    Followed follow(const std::function<bool(double)>& done) const {
        const std::size_t n = with_data.size();
        Followed followed(n, std::vector<ViewFit>(count()));
        parallel_for(2 * count(), [&](std::size_t way) {
            ViewProblem problem(lobes, shaped);
            const std::size_t track = way / 2, first = beginning(track);
            ViewFit last = next(problem, first, first, begun[track].lobes);
            for (int more = 0; more < k_first_fits; ++more) last = next(problem, first, first, last.lobes);
            if (way % 2 == 0) followed[first][track] = last;
            for (std::size_t i = first; way % 2 == 0 ? i-- > 0 : ++i < n;) {
                const std::size_t from = way % 2 == 0 ? i + 1 : i - 1;
                last = followed[i][track] = next(problem, i, from, last.lobes);
                if (i % k_told == 0 && !done((1 - k_work_of_means) * double(k_told) / double(count()))) return;
            }
        });
        if (!done(0)) followed.clear();
        return followed;
    }

    /// So many views have cosines that differ by this: they are 1/n apart.
    std::size_t views_in(double range) const { return std::size_t(std::lround(range * double(views.count()))); }
    /// Less than so many views on either side are part of a mean.
    std::size_t reach() const { return views_in(k_mean_range); }
    /// The mean of a track's lobes in the views about i.
    std::vector<ViewLobe> mean(const Followed& followed, std::size_t i, std::size_t track) const {
        std::vector<ViewLobe> sum(std::size_t(lobes), ViewLobe{});  // of the logarithms of bandwidths
        double weights = 0;
        for (std::size_t k = i - std::min(i, reach() - 1); k < std::min(followed.size(), i + reach()); ++k) {
            const double weight = double(reach()) - std::abs(double(k) - double(i));
            const std::vector<ViewLobe> its = moved(followed[k][track].lobes, rows(k).view, rows(i).view);
            for (std::size_t j = 0; j < sum.size(); ++j) {
                sum[j].centre = sum[j].centre + weight * its[j].centre;
                sum[j].bandwidth += weight * elementary::log(its[j].bandwidth);
                sum[j].shape += weight * its[j].shape;
            }
            weights += weight;
        }
        for (ViewLobe& lobe : sum)
            lobe = {normalize(lobe.centre), elementary::exp(lobe.bandwidth / weights), lobe.shape / weights};
        return sum;
    }
    /// With means for lobes: the fits of single views scatter about these, each by its own rows and pixels. Nothing if
    /// stopped.
    Followed smoothed(Followed followed, const std::function<bool(double)>& done) const {
        if (reach() < 2) return followed;
        Followed result(followed.size());
        parallel_for_parts(followed.size(), k_told, [&](std::size_t begin, std::size_t end) {
            if (!done(0)) return;
            ViewProblem problem(lobes, shaped);
            for (std::size_t i = begin; i < end; ++i)
                for (std::size_t track = 0; track < count(); ++track) {
                    const ViewFit& own = followed[i][track];
                    ViewFit fit = fit_coefficients(problem, rows(i), mean(followed, i, track), share_of(i));
                    result[i].push_back(fit.loss <= k_cost_of_mean * own.loss ? std::move(fit) : own);
                }
            done(k_work_of_means * double(end - begin));
        });
        if (!done(0)) result.clear();
        return result;
    }

    /// The track of each view. Errors of a view count by its projected area.
    std::vector<std::size_t> choice(const Followed& followed) const {
        const std::size_t n = followed.size();
        std::vector<Eigen::VectorXd> cost(n);
        std::vector<Eigen::MatrixXd> between(n > 0 ? n - 1 : 0);
        parallel_for(n, [&](std::size_t i) {
            const double area = double(rows(i).view.z);
            cost[i].resize(Eigen::Index(count()));
            for (std::size_t a = 0; a < count(); ++a) cost[i][Eigen::Index(a)] = area * followed[i][a].loss;
            if (i + 1 == n) return;
            std::vector<ViewFit> neighbours = followed[i + 1];
            for (ViewFit& fit : neighbours) fit.lobes = moved(fit.lobes, rows(i + 1).view, rows(i).view);
            between[i] = k_edge * area * share * edges(rows(i), followed[i], neighbours);
        });
        return faded(viterbi_path(cost, between), cost, between, views_in(k_fade_range));
    }
};

}  // namespace

TrackFits fit_tracks(const SampledViews& views, int lobes, bool shaped, std::uint64_t seed,
                     const std::function<bool(double)>& done) {
    Tracks tracks{views, lobes, shaped};
    tracks.begin(seed);
    Followed followed = tracks.smoothed(tracks.follow(done), done);
    const std::vector<std::size_t> path = tracks.choice(followed);
    TrackFits fits{std::vector<ViewFit>(views.count()), tracks.share};
    for (std::size_t i = 0; i < path.size(); ++i) fits.view[tracks.with_data[i]] = std::move(followed[i][path[i]]);
    return fits;
}

}  // namespace srbf
