#include "fit/views/vmf_clusters.h"

#include <algorithm>
#include <cmath>

#include "srbf/elementary.h"
#include "srbf/half.h"
#include "srbf/kernel.h"

namespace srbf {
namespace {

/// Exponents below this count as −∞: the exponential is 4e-44, and slow to compute from there on.
constexpr double k_least_exponent = -100;
/// A direction that no lobe reaches belongs to none: its densities are divided by this instead of their sum, 0.
constexpr double k_least_density = 1e-300;
/// A cluster with less than this share of all weight is empty.
constexpr double k_least_share = 1e-9;
/// Mean resultant length of a cluster, at most: a bandwidth of 1e6, beyond the bound of a 16-bit float.
constexpr double k_most_resultant = 1 - 1e-6;

}  // namespace

std::vector<ViewLobe> vmf_clusters(std::span<const Vec3f> directions, std::span<const double> weight,
                                   std::vector<ViewLobe> lobes, int rounds) {
    std::vector<double> share(lobes.size(), 1.0 / double(lobes.size())), part(lobes.size());
    for (int round = 0; round < rounds; ++round) {
        std::vector<Vec3d> moment(lobes.size());
        std::vector<double> mass(lobes.size(), 0.0);
        std::vector<double> normaliser;
        for (const ViewLobe& lobe : lobes) normaliser.push_back(1 / Kernel<double>::gaussian_integral(lobe.bandwidth));
        double whole = 0;
        for (std::size_t i = 0; i < directions.size(); ++i) {
            if (!(weight[i] > 0)) continue;
            const Vec3d w{double(directions[i].x), double(directions[i].y), double(directions[i].z)};
            double sum = k_least_density;
            for (std::size_t j = 0; j < lobes.size(); ++j) {
                const double exponent = Kernel<double>::gaussian_exponent(w, lobes[j].centre, lobes[j].bandwidth);
                part[j] = exponent > k_least_exponent ? share[j] * normaliser[j] * elementary::exp(exponent) : 0;
                sum += part[j];
            }
            whole += weight[i];
            for (std::size_t j = 0; j < lobes.size(); ++j) {
                const double of_lobe = weight[i] * part[j] / sum;
                mass[j] += of_lobe;
                moment[j] = moment[j] + of_lobe * w;
            }
        }
        for (std::size_t j = 0; j < lobes.size(); ++j) {
            const double length = std::sqrt(dot(moment[j], moment[j]));
            if (!(length > k_least_share * whole)) continue;  // the cluster is empty and remains unchanged
            const double r = std::min(length / mass[j], k_most_resultant);
            share[j] = mass[j] / whole;
            lobes[j] = {(1 / length) * moment[j],
                        std::clamp(r * (3 - r * r) / (1 - r * r), k_least_bandwidth, double(k_half_max))};
        }
    }
    return lobes;
}

}  // namespace srbf
