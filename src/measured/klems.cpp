// Matrices of patches.
#include <algorithm>
#include <cmath>
#include <map>

#include "measured/klems.h"
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

Rgb signed_value(const KlemsTable& table, Vec3f wl, Vec3f wv) {
    if (!(wl.z > 0 && wv.z > 0)) return {};
    return table.cell(table.outgoing.patch_of({-wv.x, wv.y, wv.z}), table.incident.patch_of({wl.x, -wl.y, wl.z}));
}

Rgb value(const KlemsTable& table, Vec3f wl, Vec3f wv) {
    Rgb f = signed_value(table, wl, wv);
    for (int c = 0; c < 3; ++c) f[c] = f[c] < 0 ? 0 : f[c];  // a NaN is kept
    return f;
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

namespace {

/// A peak is one of a beam if it rises above the patches about it by at least this share of what these see, and by so
/// many times what these rise above the rest: a lobe as wide as a patch would reach them.
constexpr float k_least_rise = 0.5f, k_narrow = 10;

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

}  // namespace

void separate_beam(KlemsTable& table) {
    const AngleBasis &in = table.incident, &out = table.outgoing;
    const std::size_t I = in.patches();
    std::vector<Rgb> beam(I);
    bool any = false;
    for (std::size_t ring = 0; ring < in.rings.size(); ++ring) {
        struct Peak {
            std::size_t patch;
            float around;
        };
        std::vector<Peak> peaks;
        double peak = 0, around = 0, typical = 0;
        for (std::size_t i = in.first_of(ring); i < in.first_of(ring + 1); ++i) {
            const auto [theta, phi] = std::pair(double(in.rings[ring].theta), in.azimuth_of(i));
            const std::size_t o = out.patch_of(to_float(spherical(theta, phi)));
            float most = 0, sum = 0;
            const auto near = neighbours(out, o);
            for (const std::size_t n : near.all) most = std::max(most, table.cell(n, i).g);
            for (const std::size_t n : near.of_ring) sum += table.cell(n, i).g;
            std::vector<float> column;
            for (std::size_t k = 0; k < out.patches(); ++k) column.push_back(table.cell(k, i).g);
            std::ranges::nth_element(column, column.begin() + std::ptrdiff_t(column.size() / 2));
            peak += double(table.cell(o, i).g), around += double(most), typical += double(column[column.size() / 2]);
            peaks.push_back({o, sum / float(near.of_ring.size())});
        }
        const double rise = peak - around;
        if (!(rise > double(k_least_rise) * std::max(around, 0.0)) ||
            !(rise > double(k_narrow) * std::max(around - typical, 0.0)))
            continue;
        any = true;
        for (std::size_t k = 0; k < peaks.size(); ++k) {
            const std::size_t i = in.first_of(ring) + k, o = peaks[k].patch;
            Rgb& cell = table.cells[o * I + i];
            const float of_patch = float(out.projected_solid_angle(out.ring_of(o)));
            for (int c = 0; c < 3; ++c) {
                beam[i][c] = std::clamp((cell[c] - peaks[k].around) * of_patch, 0.f, 1.f);
                cell[c] -= beam[i][c] / of_patch;
            }
        }
    }
    if (any) table.beam = std::move(beam);
}

Beam beam_of(std::span<const KlemsTable* const> tables) {
    Beam beam;
    for (const KlemsTable* table : tables) {
        if (table->beam.empty()) continue;
        const AngleBasis& basis = table->incident;
        for (std::size_t ring = 0; ring < basis.rings.size(); ++ring) {
            std::array<double, 3> sum{};
            for (std::size_t i = basis.first_of(ring); i < basis.first_of(ring + 1); ++i)
                for (int c = 0; c < 3; ++c) sum[std::size_t(c)] += double(table->beam[i][c]);
            const double n = basis.rings[ring].azimuths;
            Rgb mean{float(sum[0] / n), float(sum[1] / n), float(sum[2] / n)};
            const float theta = basis.rings[ring].theta;
            const auto at = std::ranges::lower_bound(beam.theta, theta);
            const auto k = at - beam.theta.begin();
            if (at != beam.theta.end() && *at == theta) {
                for (int c = 0; c < 3; ++c)
                    beam.share[std::size_t(k)][c] = 0.5f * (beam.share[std::size_t(k)][c] + mean[c]);
            } else {
                beam.theta.insert(at, theta);
                beam.share.insert(beam.share.begin() + k, mean);
            }
        }
    }
    return beam;
}

}  // namespace srbf
