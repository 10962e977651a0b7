// Matrices of patches.
#include <algorithm>
#include <map>

#include "brdf/directions.h"
#include "brdf/parts.h"
#include "extras/daylight/klems.h"
#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {

// ---- Patches ----

std::size_t AngleBasis::first_of(std::size_t ring) const {
    std::size_t first = 0;
    for (std::size_t r = 0; r < ring; ++r) first += rings[r].azimuths;
    return first;
}
std::size_t AngleBasis::patches() const { return first_of(rings.size()); }

std::size_t AngleBasis::ring_of(std::size_t patch) const {
    std::size_t ring = 0;
    for (std::size_t first = rings[0].azimuths; patch >= first; first += rings[ring].azimuths) ++ring;
    return ring;
}

std::size_t AngleBasis::patch_of(Vec3f w) const {
    const Angles<float> direction = angles(w);
    std::size_t ring = 0;
    while (ring + 1 < rings.size() && direction.theta >= rings[ring].to) ++ring;
    const std::uint32_t n = rings[ring].azimuths;
    const double position = double(direction.phi) / (2 * k_pi) * n + 0.5;
    const auto k = std::int64_t(std::floor(position)) % std::int64_t(n);
    return first_of(ring) + std::size_t(k < 0 ? k + n : k);
}

double AngleBasis::azimuth_of(std::size_t patch) const {
    const std::size_t ring = ring_of(patch);
    return 2 * k_pi * double(patch - first_of(ring)) / rings[ring].azimuths;
}

Vec3d AngleBasis::middle_of(std::size_t patch) const {
    return spherical(double(rings[ring_of(patch)].theta), azimuth_of(patch));
}

double AngleBasis::projected_solid_angle(std::size_t ring) const {
    const auto squared_sine = [](float theta) { return elementary::square(elementary::sin(double(theta))); };
    const Ring& bounds = rings[ring];
    return k_pi * (squared_sine(bounds.to) - squared_sine(bounds.from)) / bounds.azimuths;
}

Vec3d AngleBasis::point_of(std::size_t patch, double s, double t) const {
    const Ring& ring = rings[ring_of(patch)];
    const double lower = elementary::square(elementary::cos(double(ring.from))),
                 upper = elementary::square(elementary::cos(double(ring.to)));
    const double squared = std::max(lower + s * (upper - lower), 0.0), r = std::sqrt(1 - squared);
    const double phi = azimuth_of(patch) + 2 * k_pi * (t - 0.5) / ring.azimuths;
    return {r * elementary::cos(phi), r * elementary::sin(phi), std::sqrt(squared)};
}

std::size_t KlemsTable::straight_ahead(std::size_t i) const {
    return outgoing.patch_of(to_float(incident.middle_of(i)));
}

Rgb signed_value(const KlemsTable& table, Vec3f wl, Vec3f wv) {
    if (!above_horizon(wl, wv)) return {};
    return table.cell(table.outgoing.patch_of({-wv.x, wv.y, wv.z}), table.incident.patch_of({wl.x, -wl.y, wl.z}));
}

std::vector<PatchClass> patch_classes(const KlemsTable& table, bool isotropic) {
    const AngleBasis &in = table.incident, &out = table.outgoing;
    struct Sums {
        PatchClass pair_class;
        std::array<double, 3> sum{};
    };
    std::vector<Sums> all_sums;
    for (std::size_t ri = 0; ri < in.rings.size(); ++ri)
        for (std::size_t ro = 0; ro < out.rings.size(); ++ro) {
            const std::size_t n_i = in.rings[ri].azimuths, n_o = out.rings[ro].azimuths, period = n_i * n_o;
            const double weight = in.projected_solid_angle(ri) * out.projected_solid_angle(ro);
            std::map<std::size_t, std::size_t> class_index;  // the class for each difference of azimuths
            for (std::size_t i = 0; i < n_i; ++i)
                for (std::size_t o = 0; o < n_o; ++o) {
                    const std::size_t pi = in.first_of(ri) + i, po = out.first_of(ro) + o;
                    const Rgb f = table.cell(po, pi);
                    if (!is_finite(f)) continue;
                    const std::size_t difference = (i * n_o + period - o * n_i) % period,
                                      unsigned_difference = std::min(difference, period - difference);
                    const auto [entry, is_new] =
                        class_index.try_emplace(isotropic ? unsigned_difference : i * n_o + o, all_sums.size());
                    if (is_new) all_sums.push_back({{po, pi, 0, {}, 0, 0}, {}});
                    Sums& sums = all_sums[entry->second];
                    sums.pair_class.weight += weight;
                    for (int c = 0; c < 3; ++c) {
                        sums.sum[std::size_t(c)] += weight * double(f[c]);
                        sums.pair_class.energy += weight * elementary::square(double(f[c]));
                    }
                }
        }
    std::vector<PatchClass> classes;
    for (Sums& sums : all_sums) {
        double mean_energy = 0;
        for (int c = 0; c < 3; ++c) {
            const double mean = sums.sum[std::size_t(c)] / sums.pair_class.weight;
            sums.pair_class.mean[c] = float(mean);
            mean_energy += sums.pair_class.weight * mean * mean;
        }
        sums.pair_class.variance = std::max(sums.pair_class.energy - mean_energy, 0.0);
        classes.push_back(sums.pair_class);
    }
    return classes;
}

bool is_isotropic(const KlemsTable& table) {
    constexpr double max_ratio = 1e-4;
    double energy = 0, variance = 0;
    for (const PatchClass& pair_class : patch_classes(table, true)) {
        energy += pair_class.energy;
        variance += pair_class.variance;
    }
    return variance <= max_ratio * energy;
}

// ---- Beams ----

bool is_peak_of_beam(double value, double around, double typical) {
    constexpr double k_min_rise = 0.5, k_narrow = 10;
    const double rise = value - around;
    return rise > k_min_rise * std::max(around, 0.0) && rise > k_narrow * std::max(around - typical, 0.0);
}

namespace {

/// The neighbours of a patch: patches in its ring, and patches at its azimuth in adjacent rings. A ring of fewer than
/// three patches counts the patches of the next ring as its own.
struct Neighbours {
    std::vector<std::size_t> in_ring, all;
};
Neighbours neighbours(const AngleBasis& basis, std::size_t patch) {
    const std::size_t ring = basis.ring_of(patch), first = basis.first_of(ring), n = basis.rings[ring].azimuths;
    Neighbours adjacent;
    const std::size_t next = ring + 1 < basis.rings.size() ? ring + 1 : ring > 0 ? ring - 1 : ring;
    if (n >= 3)
        adjacent.in_ring = {first + (patch - first + 1) % n, first + (patch - first + n - 1) % n};
    else
        for (std::size_t k = 0; k < basis.rings[next].azimuths; ++k)
            adjacent.in_ring.push_back(basis.first_of(next) + k);
    adjacent.all = adjacent.in_ring;
    for (const std::size_t other : {ring + 1, ring - 1})
        if (other < basis.rings.size())
            adjacent.all.push_back(
                basis.patch_of(to_float(spherical(double(basis.rings[other].theta), basis.azimuth_of(patch)))));
    return adjacent;
}

/// The values of a matrix around the mirror direction of an incident patch: the patch in that direction, its value,
/// the largest value of its neighbours, the median of all patches, and the mean of its neighbours in the ring.
/// `is_beam` also applies to sums of several peaks.
struct Peak {
    std::size_t patch = 0;
    double value = 0, largest_around = 0, typical = 0;
    float around = 0;
    bool is_beam() const { return is_peak_of_beam(value, largest_around, typical); }
};
Peak peak_of(const KlemsTable& table, std::size_t i) {
    const AngleBasis& outgoing = table.outgoing;
    Peak peak;
    peak.patch = table.straight_ahead(i);
    peak.value = double(table.cell(peak.patch, i).g);
    const auto near = neighbours(outgoing, peak.patch);
    for (const std::size_t n : near.all)
        peak.largest_around = std::max(peak.largest_around, double(table.cell(n, i).g));
    float sum = 0;
    for (const std::size_t n : near.in_ring) sum += table.cell(n, i).g;
    peak.around = sum / float(near.in_ring.size());
    std::vector<float> column;
    for (std::size_t k = 0; k < outgoing.patches(); ++k) column.push_back(table.cell(k, i).g);
    std::ranges::nth_element(column, column.begin() + std::ptrdiff_t(column.size() / 2));
    peak.typical = double(column[column.size() / 2]);
    return peak;
}

/// Returns, for each incident patch, whether it has a beam. All patches of a ring have one if the sums over the ring
/// show a beam; otherwise each patch is judged by itself.
std::vector<bool> beam_patches(const KlemsTable& table) {
    const AngleBasis& in = table.incident;
    std::vector<bool> is_beam;
    for (std::size_t ring = 0; ring < in.rings.size(); ++ring) {
        std::vector<Peak> peaks;
        Peak ring_sum;
        for (std::size_t i = in.first_of(ring); i < in.first_of(ring + 1); ++i) {
            peaks.push_back(peak_of(table, i));
            ring_sum.value += peaks.back().value;
            ring_sum.largest_around += peaks.back().largest_around;
            ring_sum.typical += peaks.back().typical;
        }
        for (const Peak& peak : peaks) is_beam.push_back(ring_sum.is_beam() || peak.is_beam());
    }
    return is_beam;
}

/// Marks a beam in both directions of light if either direction has one.
void unite(const AngleBasis& basis, std::vector<bool>& front, std::vector<bool>& back) {
    for (std::size_t i = 0; i < front.size(); ++i) {
        const std::size_t opposite = basis.patch_of(to_float(mirror(basis.middle_of(i))));
        front[i] = back[opposite] = front[i] || back[opposite];
    }
}

/// Moves the beams of the marked incident patches from the cells to `beam`.
void separate_beam(KlemsTable& table, const std::vector<bool>& patches) {
    if (std::ranges::find(patches, true) == patches.end()) return;
    table.beam.assign(patches.size(), Rgb{});
    for (std::size_t i = 0; i < patches.size(); ++i) {
        if (!patches[i]) continue;
        const Peak peak = peak_of(table, i);
        Rgb& cell = table.cells[peak.patch * patches.size() + i];
        const float solid_angle = float(table.outgoing.projected_solid_angle(table.outgoing.ring_of(peak.patch)));
        for (int c = 0; c < 3; ++c) {
            table.beam[i][c] = std::clamp((cell[c] - peak.around) * solid_angle, 0.f, 1.f);
            cell[c] -= table.beam[i][c] / solid_angle;
        }
    }
}

/// The beams of a matrix, with a node for each incident patch, or one node for a ring whose nodes are nearly equal.
Beam beam_of(const KlemsTable& table) {
    Beam beam;
    if (table.beam.empty()) return beam;
    for (std::size_t ring = 0; ring < table.incident.rings.size(); ++ring) {
        const auto n = std::size_t(table.incident.rings[ring].azimuths);
        std::vector<Rgb> nodes(n);
        // In the frame of a part, a patch at the azimuth φ of the basis has its light at −φ.
        for (std::size_t k = 0; k < n; ++k) nodes[(n - k) % n] = table.beam[table.incident.first_of(ring) + k];
        const Rgb mean = mean_fraction(nodes);
        if (n > k_max_beam_nodes ||
            std::ranges::all_of(nodes, [&](const Rgb& node) { return are_same_fraction(node, mean); }))
            nodes = {mean};
        beam.theta.push_back(table.incident.rings[ring].theta);
        beam.azimuths.push_back(int(nodes.size()));
        beam.fraction.insert(beam.fraction.end(), nodes.begin(), nodes.end());
    }
    if (std::ranges::all_of(beam.azimuths, [](int n) { return n == 1; })) beam.azimuths.clear();
    return beam;
}

}  // namespace

Beams separate_beams(const std::array<KlemsTable*, k_parts>& matrices) {
    std::array<std::vector<bool>, k_parts> patches;
    for (std::size_t p = 0; p < k_parts; ++p)
        if (matrices[p]) patches[p] = beam_patches(*matrices[p]);
    constexpr auto front = std::size_t(Part::transmission_front), back = std::size_t(Part::transmission_back);
    if (matrices[front] && matrices[back] && matrices[front]->incident.rings == matrices[back]->incident.rings)
        unite(matrices[front]->incident, patches[front], patches[back]);
    Beams beams;
    for (std::size_t p = 0; p < k_parts; ++p) {
        if (!matrices[p]) continue;
        separate_beam(*matrices[p], patches[p]);
        beams[p] = beam_of(*matrices[p]);
    }
    unite_transmissions(beams);
    return beams;
}

}  // namespace
