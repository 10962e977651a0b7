// Matrices of patches.
#include <algorithm>
#include <cmath>
#include <map>

#include "brdf/directions.h"
#include "extras/daylight/klems.h"
#include "measured/two_sided.h"
#include "srbf/elementary.h"

namespace srbf {

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
    const Angles<float> at = angles(w);
    std::size_t ring = 0;
    while (ring + 1 < rings.size() && at.theta >= rings[ring].to) ++ring;
    const std::uint32_t n = rings[ring].azimuths;
    const double turn = double(at.phi) / (2 * k_pi) * n + 0.5;
    const auto k = std::int64_t(std::floor(turn)) % std::int64_t(n);
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
    const Ring& of = rings[ring];
    return k_pi * (squared_sine(of.to) - squared_sine(of.from)) / of.azimuths;
}

Vec3d AngleBasis::point_of(std::size_t patch, double s, double t) const {
    const Ring& ring = rings[ring_of(patch)];
    const double from = elementary::square(elementary::cos(double(ring.from))),
                 to = elementary::square(elementary::cos(double(ring.to)));
    const double squared = std::max(from + s * (to - from), 0.0), r = std::sqrt(1 - squared);
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
        PatchClass of;
        std::array<double, 3> sum{};
    };
    std::vector<Sums> all;
    for (std::size_t ri = 0; ri < in.rings.size(); ++ri)
        for (std::size_t ro = 0; ro < out.rings.size(); ++ro) {
            const std::size_t n_i = in.rings[ri].azimuths, n_o = out.rings[ro].azimuths, turn = n_i * n_o;
            const double weight = in.projected_solid_angle(ri) * out.projected_solid_angle(ro);
            std::map<std::size_t, std::size_t> known;  // the class of each difference of azimuths
            for (std::size_t i = 0; i < n_i; ++i)
                for (std::size_t o = 0; o < n_o; ++o) {
                    const std::size_t pi = in.first_of(ri) + i, po = out.first_of(ro) + o;
                    const Rgb f = table.cell(po, pi);
                    if (!is_finite(f)) continue;
                    const std::size_t apart = (i * n_o + turn - o * n_i) % turn, either = std::min(apart, turn - apart);
                    const auto [at, is_new] = known.try_emplace(isotropic ? either : i * n_o + o, all.size());
                    if (is_new) all.push_back({{po, pi, 0, {}, 0, 0}, {}});
                    Sums& sums = all[at->second];
                    sums.of.weight += weight;
                    for (int c = 0; c < 3; ++c) {
                        sums.sum[std::size_t(c)] += weight * double(f[c]);
                        sums.of.energy += weight * elementary::square(double(f[c]));
                    }
                }
        }
    std::vector<PatchClass> classes;
    for (Sums& sums : all) {
        double of_mean = 0;
        for (int c = 0; c < 3; ++c) {
            const double mean = sums.sum[std::size_t(c)] / sums.of.weight;
            sums.of.mean[c] = float(mean);
            of_mean += sums.of.weight * mean * mean;
        }
        sums.of.variance = std::max(sums.of.energy - of_mean, 0.0);
        classes.push_back(sums.of);
    }
    return classes;
}

bool is_isotropic(const KlemsTable& table) {
    constexpr double most = 1e-4;
    double energy = 0, variance = 0;
    for (const PatchClass& of : patch_classes(table, true)) energy += of.energy, variance += of.variance;
    return variance <= most * energy;
}

// ---- Beams ----

bool is_peak_of_beam(double value, double about, double typical) {
    constexpr double k_least_rise = 0.5, k_narrow = 10;
    const double rise = value - about;
    return rise > k_least_rise * std::max(about, 0.0) && rise > k_narrow * std::max(about - typical, 0.0);
}

namespace {

/// The patches that touch a patch: those of its ring, of a ring of one those of the next; and those of other rings at
/// its azimuth.
struct Neighbours {
    std::vector<std::size_t> of_ring, all;
};
Neighbours neighbours(const AngleBasis& basis, std::size_t patch) {
    const std::size_t ring = basis.ring_of(patch), first = basis.first_of(ring), n = basis.rings[ring].azimuths;
    Neighbours found;
    const std::size_t next = ring + 1 < basis.rings.size() ? ring + 1 : ring > 0 ? ring - 1 : ring;
    if (n >= 3)
        found.of_ring = {first + (patch - first + 1) % n, first + (patch - first + n - 1) % n};
    else
        for (std::size_t k = 0; k < basis.rings[next].azimuths; ++k) found.of_ring.push_back(basis.first_of(next) + k);
    found.all = found.of_ring;
    for (const std::size_t other : {ring + 1, ring - 1})
        if (other < basis.rings.size())
            found.all.push_back(
                basis.patch_of(to_float(spherical(double(basis.rings[other].theta), basis.azimuth_of(patch)))));
    return found;
}

/// The peak that an incident patch has straight ahead: the patch there, its value, the largest of those about it, the
/// median of all, and the mean of those about it in its ring. Sums of several are judged alike.
struct Peak {
    std::size_t patch = 0;
    double value = 0, most = 0, typical = 0;
    float around = 0;
    bool is_beam() const { return is_peak_of_beam(value, most, typical); }
};
Peak peak_of(const KlemsTable& table, std::size_t i) {
    const AngleBasis& out = table.outgoing;
    Peak peak;
    peak.patch = table.straight_ahead(i);
    peak.value = double(table.cell(peak.patch, i).g);
    const auto near = neighbours(out, peak.patch);
    for (const std::size_t n : near.all) peak.most = std::max(peak.most, double(table.cell(n, i).g));
    float sum = 0;
    for (const std::size_t n : near.of_ring) sum += table.cell(n, i).g;
    peak.around = sum / float(near.of_ring.size());
    std::vector<float> column;
    for (std::size_t k = 0; k < out.patches(); ++k) column.push_back(table.cell(k, i).g);
    std::ranges::nth_element(column, column.begin() + std::ptrdiff_t(column.size() / 2));
    peak.typical = double(column[column.size() / 2]);
    return peak;
}

/// Which incident patches have a beam: a ring is judged as a whole, and each of its patches alone.
std::vector<bool> beam_patches(const KlemsTable& table) {
    const AngleBasis& in = table.incident;
    std::vector<bool> is_beam;
    for (std::size_t ring = 0; ring < in.rings.size(); ++ring) {
        std::vector<Peak> peaks;
        Peak whole;
        for (std::size_t i = in.first_of(ring); i < in.first_of(ring + 1); ++i) {
            peaks.push_back(peak_of(table, i));
            whole.value += peaks.back().value, whole.most += peaks.back().most, whole.typical += peaks.back().typical;
        }
        for (const Peak& peak : peaks) is_beam.push_back(whole.is_beam() || peak.is_beam());
    }
    return is_beam;
}

/// Counts as a beam in both directions of light whatever is one in either.
void unite(const AngleBasis& basis, std::vector<bool>& front, std::vector<bool>& back) {
    for (std::size_t i = 0; i < front.size(); ++i) {
        const std::size_t turned = basis.patch_of(to_float(mirror(basis.middle_of(i))));
        front[i] = back[turned] = front[i] || back[turned];
    }
}

/// Moves the beams of these incident patches from the cells to `beam`.
void separate_beam(KlemsTable& table, const std::vector<bool>& patches) {
    if (std::ranges::find(patches, true) == patches.end()) return;
    table.beam.assign(patches.size(), Rgb{});
    for (std::size_t i = 0; i < patches.size(); ++i) {
        if (!patches[i]) continue;
        const Peak peak = peak_of(table, i);
        Rgb& cell = table.cells[peak.patch * patches.size() + i];
        const float of_patch = float(table.outgoing.projected_solid_angle(table.outgoing.ring_of(peak.patch)));
        for (int c = 0; c < 3; ++c) {
            table.beam[i][c] = std::clamp((cell[c] - peak.around) * of_patch, 0.f, 1.f);
            cell[c] -= table.beam[i][c] / of_patch;
        }
    }
}

/// A node for each incident patch, or one for a ring whose nodes hardly differ.
Beam beam_of(const KlemsTable& table) {
    Beam beam;
    if (table.beam.empty()) return beam;
    for (std::size_t ring = 0; ring < table.incident.rings.size(); ++ring) {
        const auto n = std::size_t(table.incident.rings[ring].azimuths);
        std::vector<Rgb> nodes(n);
        // A patch at the azimuth φ of the basis has its light at −φ in the frame of a part.
        for (std::size_t k = 0; k < n; ++k) nodes[(n - k) % n] = table.beam[table.incident.first_of(ring) + k];
        const Rgb mean = mean_share(nodes);
        if (n > k_most_beam_nodes ||
            std::ranges::all_of(nodes, [&](const Rgb& node) { return are_same_share(node, mean); }))
            nodes = {mean};
        beam.theta.push_back(table.incident.rings[ring].theta);
        beam.azimuths.push_back(int(nodes.size()));
        beam.share.insert(beam.share.end(), nodes.begin(), nodes.end());
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

}  // namespace srbf
