// Sampling by a table of cells around the mirror direction.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include "base/parallel.h"
#include "brdf/directions.h"
#include "sampling/choice.h"
#include "sampling/elevation_nodes.h"
#include "srbf/elementary.h"
#include "srbf/sampling.h"

namespace SRBF_NAMESPACE {
namespace {

// The cells are sectors and rings around the mirror direction m, with coordinates `turn` and ρ². `turn` is the
// azimuth of p − m, which is that of the half vector. It is measured along the square |x| + |y| = 1, from 0 to 4,
// beginning in the direction away from the normal. ρ is the distance |p − m| relative to that of the horizon in
// the same direction. There are two rings per octave of ρ², down to 2⁻²⁴.
//
// Nodes are uniform in t = (1 + ∜cosθv − √(1 − cosθv)) / 2, and densities are linear between them.
constexpr int k_table_nodes = TableProposal::k_nodes, k_sectors = TableProposal::k_sectors,
              k_rings = TableProposal::k_rings, k_cells = k_sectors * k_rings;

// There are two rings per octave: the exponent of a float and the first bit of its fraction number the rings.
constexpr int k_shift = 22;
// where ring 0 begins; it also contains the centre
constexpr auto k_inner = std::bit_cast<std::uint32_t>(0x1p-24f) >> k_shift;
float inner_edge(int ring) { return ring == 0 ? 0 : std::bit_cast<float>((k_inner + std::uint32_t(ring)) << k_shift); }
float width_of(int ring) { return inner_edge(ring + 1) - inner_edge(ring); }
int ring_of(float squared) {
    const int ring = int(std::bit_cast<std::uint32_t>(squared) >> k_shift) - int(k_inner);
    return std::clamp(ring, 0, k_rings - 1);
}
static_assert(k_rings == 2 * 24);  // to ρ = 1

/// The unit vector along the projection of the mirror direction onto the disk.
Vec2f away(const Vec3f& wv) {
    const float squared = wv.x * wv.x + wv.y * wv.y;
    if (!(squared > 1e-12f)) return {-1, 0};
    const float scale = -1 / std::sqrt(squared);
    return {scale * wv.x, scale * wv.y};
}

/// The distance from the mirror direction m to the horizon on the disk, in a direction e whose component along
/// `away` is given: the root R of |m + R e|² = 1.
float distance_to_horizon(const Vec3f& wv, float component) {
    const float b = std::sqrt(std::max(1 - wv.z * wv.z, 0.f)) * component, square = wv.z * wv.z,
                root = std::sqrt(b * b + square);
    return b > 0 ? square / (b + root) : root - b;
}

/// The cell of a direction, and the factor that converts a density of (turn, ρ²) to that of the direction. It
/// follows from dωl cosθl = dp = ½ R² dρ² dφ and dφ = (|x| + |y|)² d(turn), where (x, y) is the unit vector at
/// azimuth φ.
struct CellPoint {
    int cell;
    float factor;
};
CellPoint cell_of(const Vec3f& wl, const Vec3f& wv) {
    const Vec2f a = away(wv);
    const float offset_x = wl.x + wv.x, offset_y = wl.y + wv.y;
    const float x = offset_x * a.x + offset_y * a.y, y = offset_y * a.x - offset_x * a.y;
    const float squared = std::max(x * x + y * y, 1e-24f), sum = std::max(std::abs(x) + std::abs(y), 1e-12f);
    const float reach = distance_to_horizon(wv, x / std::sqrt(squared)), reach2 = std::max(reach * reach, 1e-24f);
    const float half = 1 - x / sum, turn = y < 0 ? 4 - half : half;
    const int sector = std::clamp(int(turn * (k_sectors / 4.f)), 0, k_sectors - 1);
    return {sector * k_rings + ring_of(squared / reach2), 2 * wl.z * squared / (reach2 * sum * sum)};
}

Vec3f direction_at(const Vec3f& wv, float turn, float squared) {
    const float half = turn > 2 ? 4 - turn : turn;
    float x = 1 - half, y = 1 - std::abs(x);
    const float scale = 1 / std::sqrt(x * x + y * y);
    x *= scale, y *= turn > 2 ? -scale : scale;
    const Vec2f a = away(wv);
    const float r = distance_to_horizon(wv, x) * std::sqrt(squared);
    const float lx = r * (x * a.x - y * a.y) - wv.x, ly = r * (x * a.y + y * a.x) - wv.y;
    return {lx, ly, std::sqrt(std::max(1 - lx * lx - ly * ly, 0.f))};
}

NodePosition node_position(const Vec3f& wv) {
    const float position = float(k_table_nodes - 1) * elevation_coordinate(std::clamp(wv.z, 0.f, 1.f));
    const int below = std::clamp(int(position), 0, k_table_nodes - 2);
    return {std::size_t(below), position - float(below)};
}

/// Chooses an index by running sums, with u uniform in [0,1).
template <std::size_t n> Choice choose(const float* running, float u) {
    int i = 0;
    for (std::size_t k = 0; k + 1 < n; ++k) i += running[k] <= u;  // branch-free: branches would be unpredictable
    const float begin = i == 0 ? 0 : running[i - 1], width = running[i] - begin;
    return {i, width > 0 ? std::clamp((u - begin) / width, 0.f, k_below_one) : 0};
}

/// The views around a node, up to a third of the way to its neighbours. Each cell has one point for each of them.
constexpr int k_views = 8;
std::array<Vec3f, k_views> views_of(std::size_t node) {
    constexpr double lowest = .001;
    std::array<Vec3f, k_views> views;
    for (int i = 0; i < k_views; ++i) {
        const double t = std::clamp((double(node) + (2 * i / (k_views - 1.) - 1) / 3) / (k_table_nodes - 1), 0., 1.);
        views[std::size_t(i)] = to_float(spherical(elementary::acos(std::max(elevation_cosine(t), lowest)), 0.));
    }
    return views;
}

/// For each cell the root mean square, over its points, of f times the area of the disk per d(turn) dρ². This is
/// the density of least variance, up to a common factor.
std::vector<double> best_densities(const Evaluate& brdf, std::size_t node) {
    std::vector<double> sum(k_cells);
    for (const Vec3f wv : views_of(node)) {
        std::vector<Vec3f> wl(k_cells);
        for (int cell = 0; cell < k_cells; ++cell) {
            const int ring = cell % k_rings, sector = cell / k_rings, n = cell + int(1000 * wv.z);
            const double u1 = n * 0.7548776662, u2 = n * 0.5698402910;  // of a two-dimensional lattice
            wl[std::size_t(cell)] = direction_at(wv, float((sector + u1 - std::floor(u1)) * 4 / k_sectors),
                                                 inner_edge(ring) + float(u2 - std::floor(u2)) * width_of(ring));
        }
        std::vector<Rgb> f(wl.size());
        brdf(wl, std::vector<Vec3f>(wl.size(), wv), f);
        for (std::size_t i = 0; i < wl.size(); ++i) {
            const double factor = double(cell_of(wl[i], wv).factor);
            if (!is_finite(f[i]) || !(factor > 0)) continue;
            const double reflected = std::max(luminance(f[i]), 0.) * double(wl[i].z) / factor;
            sum[i] += reflected * reflected;
        }
    }
    for (double& cell_sum : sum) cell_sum = std::sqrt(cell_sum / k_views);
    return sum;
}

/// Blends each cell with the mean of its ring, for features that its points missed.
void blend_with_rings(std::vector<double>& density) {
    constexpr double mean_fraction = 0.05;
    for (int ring = 0; ring < k_rings; ++ring) {
        double mean = 0;
        for (int cell = ring; cell < k_cells; cell += k_rings) mean += density[std::size_t(cell)] / k_sectors;
        for (int cell = ring; cell < k_cells; cell += k_rings)
            density[std::size_t(cell)] += mean_fraction * (mean - density[std::size_t(cell)]);
    }
}

/// Computes a node of the table. Without reflected light the density is uniform.
void make_table_node(const Evaluate& brdf, std::size_t node, TableProposal& table) {
    std::vector<double> density = best_densities(brdf, node);
    blend_with_rings(density);
    const auto probability = [&](std::size_t cell) {
        return density[cell] * double(width_of(int(cell) % k_rings)) * 4 / k_sectors;
    };
    double total = 0;
    for (std::size_t cell = 0; cell < k_cells; ++cell) total += probability(cell);
    if (!(total > 0)) {
        std::fill(density.begin(), density.end(), 1);
        total = 4;
    }
    double sum = 0;
    for (std::size_t sector = 0; sector < k_sectors; ++sector) {
        double sector_total = 0, running = 0;
        for (std::size_t ring = 0; ring < k_rings; ++ring) sector_total += probability(sector * k_rings + ring);
        for (std::size_t ring = 0; ring < k_rings; ++ring) {
            const std::size_t cell = sector * k_rings + ring, index = node * k_cells + cell;
            table.density[index] = float(density[cell] / total);
            table.ring_sums[index] = sector_total > 0 ? float((running += probability(cell)) / sector_total) : 1;
        }
        table.sector_sums[node * k_sectors + sector] = float((sum += sector_total) / total);
    }
}

/// The largest relative variance of f cosθl / pdf at views every 5°.
template <typename P> double largest_variance(const Evaluate& brdf, const P& proposal, int threads) {
    constexpr int points_of_view = 1024;
    constexpr double first = 2.5, step = 5, last = 85;  // degrees
    // [rad]; at the azimuth of an axis, a point would lie in the plane of incidence, where a table may have an edge
    constexpr double azimuth = 0.3;
    constexpr auto views = std::size_t((last - first) / step) + 1;
    const MirrorMixture mirror(k_pi / 2);
    std::array<double, views> variance{};
    parallel_for(views, threads, [&](std::size_t i) {
        const Vec3d wv = spherical((first + step * double(i)) * k_degree, azimuth);
        const Quadrature points = mirror.quadrature(wv, points_of_view);
        std::vector<Rgb> f(points.w.size());
        brdf(points.w, std::vector<Vec3f>(f.size(), to_float(wv)), f);
        double total = 0, squared = 0;
        for (std::size_t k = 0; k < f.size(); ++k) {
            const double reflected = is_finite(f[k]) ? luminance(f[k]) * double(points.w[k].z) : 0;
            if (!(reflected > 0)) continue;
            total += points.weight[k] * reflected;
            squared += points.weight[k] * reflected * reflected / double(pdf(proposal, points.w[k], to_float(wv)));
        }
        if (total > 0) variance[i] = squared / (total * total) - 1;
    });
    return *std::max_element(variance.begin(), variance.end());
}

}  // namespace

Proposal refine(const Evaluate& brdf, const MixtureProposal& mixture, const ProposeOptions& options) {
    const StandardArithmetic mode;
    if (mixture.facets || options.azimuths > 1 || std::isinf(options.most_variance)) return mixture;
    const double variance = largest_variance(brdf, mixture, options.threads);
    if (!(variance > options.most_variance)) return mixture;
    TableProposal table;
    table.grazing = mixture;
    table.density.resize(k_table_nodes * k_cells);
    table.ring_sums.resize(k_table_nodes * k_cells);
    table.sector_sums.resize(k_table_nodes * k_sectors);
    parallel_for(k_table_nodes, options.threads, [&](std::size_t node) { make_table_node(brdf, node, table); });
    if (largest_variance(brdf, table, options.threads) < variance) return table;
    return mixture;
}

Vec3f sample(const TableProposal& proposal, Vec3f wv, Vec2f u, float selector) {
    if (wv.z < TableProposal::k_lowest_view) return sample(proposal.grazing, wv, u, selector);
    constexpr float cosine_fraction = 1 - TableProposal::k_share;
    if (selector < cosine_fraction) return sample(CosineProposal{}, wv, u, 0);
    const NodePosition position = node_position(wv);
    const std::size_t node =
        position.below + ((selector - cosine_fraction) / TableProposal::k_share < position.fraction);
    const Choice sector = choose<k_sectors>(&proposal.sector_sums[node * k_sectors], u.x);
    const Choice ring =
        choose<k_rings>(&proposal.ring_sums[(node * k_sectors + std::size_t(sector.index)) * k_rings], u.y);
    return direction_at(wv, (float(sector.index) + sector.u) * 4 / k_sectors,
                        inner_edge(ring.index) + ring.u * width_of(ring.index));
}

float pdf(const TableProposal& proposal, Vec3f wl, Vec3f wv) {
    if (wv.z < TableProposal::k_lowest_view) return pdf(proposal.grazing, wl, wv);
    if (!above_horizon(wl, wv)) return 0;
    const NodePosition position = node_position(wv);
    const CellPoint point = cell_of(wl, wv);
    const float* const density = &proposal.density[position.below * k_cells + std::size_t(point.cell)];
    const float table_pdf = point.factor * (density[0] + position.fraction * (density[k_cells] - density[0]));
    return (1 - TableProposal::k_share) * pdf(CosineProposal{}, wl, wv) + TableProposal::k_share * table_pdf;
}

}  // namespace srbf
