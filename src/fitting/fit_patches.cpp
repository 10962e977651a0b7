// Fits to averages over patches.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>

#include "fit/data/check_grid.h"
#include "fit/fits.h"
#include "fit/objective/objective.h"
#include "fitting/requests.h"
#include "floating_point.h"
#include "measured/klems.h"
#include "r_sequence.h"
#include "srbf/directions.h"
#include "srbf/elementary.h"
#include "srbf/fit_bsdf.h"

namespace srbf {
namespace {

/// Points of a pair of patches that a fit sees.
constexpr std::size_t k_fitted_points = 8;
/// Points of an outgoing patch in directional-hemispherical sums.
constexpr std::size_t k_hemisphere_points = 4;
/// Each but the first begins from the previous one's errors.
constexpr int k_most_rounds = 3;
constexpr double k_least_gain_of_round = 0.02;
/// Most matrices are smooth, and a fit is repeated.
constexpr int k_starts = 8, k_perturbations = 12;
constexpr double k_radiance_error = 0.005;
/// The sizes that are tried, and what is good enough.
struct Size {
    int lobes, variates;
};
constexpr Size k_sizes[] = {{1, 1}, {1, 2}, {2, 2}, {3, 2}, {4, 3}, {6, 3}, {8, 4}};
constexpr double k_good_error = 1e-3, k_good_share = 0.01, k_good_sum = 0.001;

/// The directions of a pair of points (bsdf.h, `KlemsTable`).
Vec3f light_at(Vec3d p) { return to_float({p.x, -p.y, p.z}); }
Vec3f view_at(Vec3d p) { return to_float({-p.x, p.y, p.z}); }

/// f cosθ summed over the outgoing patches, for light from the middle of each incident ring.
std::vector<RadianceObservation> hemispheres(const KlemsTable& table) {
    std::vector<RadianceObservation> all;
    const AngleBasis &in = table.incident, &out = table.outgoing;
    for (std::size_t ring = 0; ring < in.rings.size(); ++ring) {
        const std::size_t i = in.first_of(ring);
        // Light and viewer are exchanged: a radiance has one view direction.
        RadianceObservation seen{light_at(spherical(double(in.rings[ring].theta), in.azimuth_of(i))), {}, {}, {}, {}};
        RSequence<2> points;
        for (std::size_t o = 0; o < out.patches(); ++o) {
            const Rgb f = table.cell(o, i);
            if (!is_finite(f)) continue;
            for (std::size_t k = 0; k < k_hemisphere_points; ++k) {
                const auto u = points.next();
                seen.wl.push_back(view_at(out.point_of(o, u[0], u[1])));
                seen.f.push_back({std::max(f.r, 0.f), std::max(f.g, 0.f), std::max(f.b, 0.f)});
                seen.weight.push_back(out.projected_solid_angle(out.ring_of(o)) / double(k_hemisphere_points));
            }
        }
        all.push_back(std::move(seen));
    }
    return all;
}

Observations observations_of(const KlemsTable& table, const PatchSums& sums, const std::vector<Rgb>& targets,
                             const std::vector<RadianceObservation>& radiances, std::uint64_t seed) {
    Observations all;
    all.objective = Objective::cosine;
    all.wl = sums.wv, all.wv = sums.wl, all.f = targets;  // exchanged, as in `hemispheres`
    for (std::size_t k = 0; k < targets.size(); ++k)
        all.weight.push_back(sums.weight[k / sums.points] / double(sums.points));
    all.normalise();
    double sum = 0;
    for (const Rgb& f : targets) sum += mean_of(f);
    all.typical = sum / double(targets.size());
    std::mt19937_64 random(seed);
    all.shuffle(random);
    for (const auto& [wl, wv] : check_grid()) {
        Rgb f = value(table, to_float(wv), to_float(wl));
        if (!is_finite(f)) continue;
        all.add(to_float(wl), to_float(wv), f, 0);
        ++all.checks;
    }
    all.radiances = radiances;
    all.radiance_error = k_radiance_error;
    return all;
}

/// The sums without beams.
std::vector<Hemispherical> scattered(const KlemsTable& table, const std::vector<RadianceObservation>& seen,
                                     const Evaluate& f) {
    std::vector<Hemispherical> all;
    for (std::size_t ring = 0; ring < seen.size(); ++ring) {
        const RadianceObservation& of = seen[ring];
        Hemispherical sum{double(table.incident.rings[ring].theta), 0, 0};
        std::vector<Rgb> fitted(of.f.size());
        f(std::vector<Vec3f>(of.f.size(), of.wv), of.wl, fitted);
        for (std::size_t k = 0; k < of.f.size(); ++k) {
            sum.measured += of.weight[k] * double(of.f[k].g);
            sum.fitted += of.weight[k] * double(fitted[k].g);
        }
        all.push_back(sum);
    }
    return all;
}

bool is_good(const Hemispherical& sum) {
    return std::abs(sum.fitted - sum.measured) <= std::max(k_good_share * sum.measured, k_good_sum);
}

}  // namespace

PatchSums sums_of(const KlemsTable& table, std::size_t points) {
    PatchSums sums;
    sums.points = points;
    RSequence<4> sequence;
    for (const PatchClass& of : patch_classes(table, is_isotropic(table))) {
        sums.mean.push_back({std::max(of.mean.r, 0.f), std::max(of.mean.g, 0.f), std::max(of.mean.b, 0.f)});
        sums.weight.push_back(of.weight);
        for (std::size_t k = 0; k < points; ++k) {
            const auto u = sequence.next();
            sums.wl.push_back(light_at(table.incident.point_of(of.incident, u[0], u[1])));
            sums.wv.push_back(view_at(table.outgoing.point_of(of.outgoing, u[2], u[3])));
        }
    }
    return sums;
}

std::vector<Rgb> PatchSums::averages(const Evaluate& f) const {
    std::vector<Rgb> values(wl.size()), all(mean.size());
    f(wl, wv, values);
    for (std::size_t k = 0; k < values.size(); ++k)
        for (int c = 0; c < 3; ++c) all[k / points][c] += values[k][c] / float(points);
    return all;
}

double PatchSums::error_ratio(const Evaluate& f) const {
    const std::vector<Rgb> fitted = averages(f);
    double error = 0, energy = 0;
    for (std::size_t k = 0; k < fitted.size(); ++k) {
        error += weight[k] * squared_distance(mean[k], fitted[k]);
        energy += weight[k] * square_of(mean[k]);
    }
    return energy > 0 ? error / energy : 0;
}

std::vector<Hemispherical> hemispherical(const KlemsTable& table, const Evaluate& f, const Beam& beam) {
    std::vector<Hemispherical> all = scattered(table, hemispheres(table), f);
    for (std::size_t ring = 0; ring < all.size(); ++ring) {
        if (!table.beam.empty()) all[ring].measured += double(table.beam[table.incident.first_of(ring)].g);
        all[ring].fitted += double(share_at(beam, elementary::cos(table.incident.rings[ring].theta)).g);
    }
    return all;
}

Result<FitOutcome> fit_patches(const KlemsTable& table, const FitRequest& request, const ProgressToken& progress) {
    const FlushSubnormals mode;
    const auto start = std::chrono::steady_clock::now();
    const auto* pm = std::get_if<PmRequest>(&request.model);
    const Evaluate look_up = [&](auto wl, auto wv, auto f) {
        for (std::size_t i = 0; i < f.size(); ++i) f[i] = signed_value(table, wl[i], wv[i]);
    };
    if (std::holds_alternative<SuRequest>(request.model)) return fit_su(look_up, request, progress);
    const PatchSums fitted = sums_of(table, k_fitted_points), measured = sums_of(table, k_measured_points);
    const auto radiances = hemispheres(table);
    std::vector<Rgb> targets;
    for (const Rgb& mean : fitted.mean) targets.insert(targets.end(), fitted.points, mean);
    const auto observed = [&](const std::vector<Rgb>& values) {
        return observations_of(table, fitted, values, radiances, request.seed);
    };
    if (!pm) {
        auto outcome = fit_ggx(observed(targets), request, progress);
        if (outcome) outcome->max_theta = k_pi / 2;
        return outcome;  // reciprocal
    }

    std::vector<Size> sizes(std::begin(k_sizes), std::end(k_sizes));
    if (const auto lobes = lobes_of(*pm)) sizes = {{*lobes, pm->variates}};
    FitOptions options = pm_options(request, pm->axial.value_or(is_isotropic(table)));
    options = in_short(options, k_starts, k_perturbations);
    std::optional<FitOutcome> best;
    double least = 0;
    for (std::size_t size = 0; size < sizes.size(); ++size) {
        options.lobes = sizes[size].lobes, options.variates = sizes[size].variates;
        if (options.reciprocal) options.variates += options.variates % 2;
        std::vector<Rgb> values = targets;
        std::optional<FitOutcome> of_size;
        double error_of_size = 0;
        for (int round = 0; round < k_most_rounds; ++round) {
            const double done = double(size) + double(round) / k_most_rounds;
            auto fit =
                fit_pm(observed(values), options,
                       progress.part(done / double(sizes.size()), (done + 1.0 / k_most_rounds) / double(sizes.size())));
            if (!fit) return fit.error();
            FitOutcome outcome;
            outcome.stop = fit->stop;
            take(outcome, *std::move(fit));
            exchange(outcome.model), exchange(outcome.unrounded);
            const double error = measured.error_ratio(evaluator(outcome.model));
            const double error_before = error_of_size;
            const bool is_better = !of_size || error < error_of_size;
            // The expected values within the patches, for their averages and this fit.
            std::vector<Rgb> now(fitted.wl.size());
            evaluator(outcome.model)(fitted.wl, fitted.wv, now);
            const std::vector<Rgb> averages = fitted.averages(evaluator(outcome.model));
            for (std::size_t k = 0; k < now.size(); ++k)
                for (int c = 0; c < 3; ++c)
                    values[k][c] =
                        std::max(now[k][c] + fitted.mean[k / fitted.points][c] - averages[k / fitted.points][c], 0.f);
            if (is_better) of_size = std::move(outcome), error_of_size = error;
            const bool pays = round == 0 || error < (1 - k_least_gain_of_round) * error_before;
            if (!pays || progress.cancelled()) break;
        }
        if (progress.cancelled()) return cancelled_error("fit");
        if (!best || error_of_size < least) best = std::move(of_size), least = error_of_size;
        bool good = least <= k_good_error;
        good = good && std::ranges::all_of(scattered(table, radiances, evaluator(best->model)), is_good);
        if (good) break;
    }
    best->fit_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    best->max_theta = k_pi / 2;
    best->raw_bytes = table.cells.size() * sizeof(float);
    return *std::move(best);
}

}  // namespace srbf
