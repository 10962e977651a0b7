// Fits to averages over patches.
#include <numeric>
#include <random>

#include "base/errors.h"
#include "base/floating_point.h"
#include "base/r_sequence.h"
#include "brdf/directions.h"
#include "brdf/values.h"
#include "extras/daylight/klems.h"
#include "fit/requests.h"
#include "measured/tables.h"
#include "models/pm/search/fit_pm.h"
#include "models/su/fit_su.h"
#include "observe/pair_weights.h"
#include "observe/pairs.h"
#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {
namespace {

/// Points in each pair of patches at which a fit observes f.
constexpr std::size_t k_fitted_points = 8;
/// Points in each outgoing patch for directional-hemispherical sums.
constexpr std::size_t k_hemisphere_points = 4;
/// Rounds of expectation-maximisation. Each later round starts from the lobes and errors of the previous one.
/// Rounds continue while the error falls by this fraction.
constexpr int k_max_rounds = 3;
constexpr double k_min_gain_of_round = 0.02;
/// Starts and perturbations are few, since most matrices are smooth and each fit is repeated.
constexpr int k_starts = 8, k_perturbations = 12;
/// Half of `k_good_fraction`, the required relative accuracy of the sums.
constexpr double k_integral_error = 0.005;
/// The sizes that are tried, and the errors that are good enough (`fit_patches`).
struct Size {
    int lobes, variates;
};
constexpr Size k_sizes[] = {{1, 1}, {1, 2}, {2, 2}, {3, 2}, {4, 3}, {6, 3}, {8, 4}};
constexpr double k_good_error = 1e-3, k_good_fraction = 0.01, k_good_sum = 0.001;
/// If the error is this many times the goal, skip directly to the largest size.
constexpr double k_far_from_goal = 100;
/// The least width of a lobe, as a fraction of the width of the narrowest ring of patches.
constexpr double k_finest = 0.5;

/// The first incident patch of each ring.
std::vector<std::size_t> first_patches(const KlemsTable& table) {
    std::vector<std::size_t> patches;
    for (std::size_t ring = 0; ring < table.incident.rings.size(); ++ring)
        patches.push_back(table.incident.first_of(ring));
    return patches;
}

/// f cosθ summed over the outgoing patches, for light from the middles of incident patches.
std::vector<ObservedIntegral> hemispheres(const KlemsTable& table, std::span<const std::size_t> incident) {
    std::vector<ObservedIntegral> sums;
    const AngleBasis& outgoing = table.outgoing;
    for (const std::size_t i : incident) {
        ObservedIntegral sum;
        sum.in_search = sums.size() % 2 == 0;
        const Vec3f light = light_at(table.incident.middle_of(i));
        RSequence<2> points;
        for (std::size_t o = 0; o < outgoing.patches(); ++o) {
            const Rgb f = table.cell(o, i);
            if (!is_finite(f)) continue;
            for (std::size_t k = 0; k < k_hemisphere_points; ++k) {
                const auto u = points.next();
                sum.wv.push_back(light);  // exchanged with the viewer, as in all observations of a matrix
                sum.wl.push_back(view_at(outgoing.point_of(o, u[0], u[1])));
                sum.f.push_back(non_negative(f));
                sum.weight.push_back(outgoing.projected_solid_angle(outgoing.ring_of(o)) / double(k_hemisphere_points));
            }
        }
        sums.push_back(std::move(sum));
    }
    return sums;
}

/// The directional-hemispherical sums without beams, measured and fitted, for the sums of `hemispheres` at these
/// incident patches.
std::vector<Hemispherical> sums_without_beams(const KlemsTable& table, std::span<const std::size_t> incident,
                                              const std::vector<ObservedIntegral>& sums, const Evaluate& f) {
    std::vector<Hemispherical> results;
    for (std::size_t i = 0; i < sums.size(); ++i) {
        const ObservedIntegral& observed = sums[i];
        const auto light = angles(light_at(table.incident.middle_of(incident[i])));
        Hemispherical sum{double(light.theta), double(light.phi), 0, 0};
        std::vector<Rgb> fitted(observed.f.size());
        f(observed.wv, observed.wl, fitted);
        for (std::size_t k = 0; k < observed.f.size(); ++k) {
            sum.measured += observed.weight[k] * double(observed.f[k].g);
            sum.fitted += observed.weight[k] * double(fitted[k].g);
        }
        results.push_back(sum);
    }
    return results;
}

bool is_good(const Hemispherical& sum) {
    return std::abs(sum.fitted - sum.measured) <= std::max(k_good_fraction * sum.measured, k_good_sum);
}

/// The width of the narrowest ring [rad]. For the cap at the normal, the width is its diameter.
double min_width(const AngleBasis& basis) {
    double smallest = k_pi / 2;
    for (const AngleBasis::Ring& ring : basis.rings)
        smallest = std::min(smallest, double(ring.from > 0 ? ring.to - ring.from : 2 * ring.to));
    return smallest;
}

/// Fits to one matrix, of increasing size.
class PatchFits {
  public:
    PatchFits(const KlemsTable& table, const FitRequest& request) : table_(table), request_(request) {
        for (const Rgb& mean : points_.mean) means_.insert(means_.end(), points_.points, mean);
    }

    Result<FitOutcome> fit_means(const ProgressToken& progress) const {
        return fit_by_kind(request_, observations_of(means_), is_isotropic(table_), progress);
    }

    /// Fits this size in several rounds and keeps the best fit. A search that does not improve on a smaller size is
    /// repeated with other random numbers.
    Result<Done> fit_size(PmFitOptions options, const Size& size, const ProgressToken& progress) {
        options.lobes = size.lobes;
        options.variates = size.variates;
        std::vector<Rgb> values = means_;
        std::optional<PmModel> initial_lobes;
        for (int round = 0; round < k_max_rounds; ++round) {
            auto fit = fit_pm(observations_of(values), options,
                              progress.subrange(double(round) / k_max_rounds, (round + 1.0) / k_max_rounds),
                              initial_lobes ? &*initial_lobes : nullptr);
            if (!fit) return fit.error();
            if (progress.cancelled()) return cancelled_error("fit");
            PmModel lobes = fit->unrounded;
            auto outcome = outcome_of(std::move(fit));
            if (!outcome) return outcome.error();
            exchange(outcome->model);
            const Evaluate fitted = evaluator(outcome->model);
            const double error = measured_.error_ratio(fitted), previous_error = best_ ? error_ : 2 * error;
            if (error < previous_error) {
                best_ = *outcome;
                error_ = error;
            }
            if (initial_lobes && !(error < (1 - k_min_gain_of_round) * previous_error)) break;
            if (error < previous_error) {
                initial_lobes = std::move(lobes);
                values = expected_values(fitted);
            } else
                ++options.seed;
        }
        return Done{};
    }
    /// True if the best fit so far is good enough.
    bool is_enough() const {
        return error_ <= k_good_error &&
               std::ranges::all_of(sums_without_beams(table_, incident_, integrals_, evaluator(best_->model)), is_good);
    }
    double error() const { return error_; }
    FitOutcome best() { return *std::move(best_); }

  private:
    Observations observations_of(const std::vector<Rgb>& values) const {
        Observations observations;
        observations.objective = Objective::cosine;
        observations.wl = points_.wv;
        observations.wv = points_.wl;
        observations.f = values;  // exchanged, as in `hemispheres`
        for (std::size_t k = 0; k < values.size(); ++k)
            observations.weight.push_back(points_.weight[k / points_.points] / double(points_.points));
        observations.normalise();
        double sum = 0;
        for (const Rgb& f : values) sum += mean_of(f);
        observations.typical = sum / double(values.size());
        std::mt19937_64 random(request_.seed);
        observations.shuffle(random);
        for (const auto& [wl, wv] : horizon_grid()) {
            const Rgb f = value(table_, wv, wl);
            if (!is_finite(f)) continue;
            observations.add(wl, wv, f, 0);
            ++observations.bound_pairs;
        }
        observations.integrals = integrals_;
        observations.integral_error = k_integral_error;
        return observations;
    }

    /// The expected values within the patches, given the measured averages and this fit.
    std::vector<Rgb> expected_values(const Evaluate& fitted) const {
        std::vector<Rgb> values(points_.wl.size());
        fitted(points_.wl, points_.wv, values);
        const std::vector<Rgb> averages = points_.averages(fitted);
        for (std::size_t k = 0; k < values.size(); ++k)
            for (int c = 0; c < 3; ++c) {
                const std::size_t patch_pair = k / points_.points;
                values[k][c] = std::max(values[k][c] + points_.mean[patch_pair][c] - averages[patch_pair][c], 0.f);
            }
        return values;
    }

    const KlemsTable& table_;
    const FitRequest& request_;
    const PatchSums points_ = sums_of(table_, k_fitted_points), measured_ = sums_of(table_, k_measured_points);
    const std::vector<std::size_t> incident_ = first_patches(table_);
    const std::vector<ObservedIntegral> integrals_ = hemispheres(table_, incident_);
    std::vector<Rgb> means_;  // the mean of its patches for each point
    std::optional<FitOutcome> best_;
    double error_ = 0;
};

}  // namespace

PatchSums sums_of(const KlemsTable& table, std::size_t points) {
    PatchSums sums;
    sums.points = points;
    RSequence<4> sequence;
    for (const PatchClass& pair_class : patch_classes(table, is_isotropic(table))) {
        sums.mean.push_back(non_negative(pair_class.mean));
        sums.weight.push_back(pair_class.weight);
        for (std::size_t k = 0; k < points; ++k) {
            const auto u = sequence.next();
            sums.wl.push_back(light_at(table.incident.point_of(pair_class.incident, u[0], u[1])));
            sums.wv.push_back(view_at(table.outgoing.point_of(pair_class.outgoing, u[2], u[3])));
        }
    }
    return sums;
}

std::vector<Rgb> PatchSums::averages(const Evaluate& f) const {
    std::vector<Rgb> values(wl.size()), means(mean.size());
    f(wl, wv, values);
    for (std::size_t k = 0; k < values.size(); ++k)
        for (int c = 0; c < 3; ++c) means[k / points][c] += values[k][c] / float(points);
    return means;
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

std::vector<Hemispherical> hemispherical(const KlemsTable& table, const Evaluate& f, const Beams& beams, Part part) {
    std::vector<std::size_t> incident = first_patches(table);
    if (!is_isotropic(table)) {
        incident.resize(table.incident.patches());
        std::iota(incident.begin(), incident.end(), std::size_t(0));
    }
    const auto sums = hemispheres(table, incident);
    std::vector<Hemispherical> hemispherical_sums = sums_without_beams(table, incident, sums, f);
    for (std::size_t k = 0; k < hemispherical_sums.size(); ++k) {
        if (!table.beam.empty()) hemispherical_sums[k].measured += double(table.beam[incident[k]].g);
        hemispherical_sums[k].fitted +=
            double(fraction_at(beams, part, light_at(table.incident.middle_of(incident[k]))).g);
    }
    return hemispherical_sums;
}

Result<FitOutcome> fit_patches(const KlemsTable& table, const FitRequest& request, const ProgressToken& progress) {
    const StandardArithmetic mode;
    const auto start = std::chrono::steady_clock::now();
    const Evaluate look_up = [&](auto wl, auto wv, auto f) {
        for (std::size_t i = 0; i < f.size(); ++i) f[i] = signed_value(table, wl[i], wv[i]);
    };
    if (std::holds_alternative<SuRequest>(request.model)) return fit_view_by_view(look_up, request, progress);
    PatchFits fits(table, request);
    const auto* pm = std::get_if<PmRequest>(&request.model);
    if (!pm) {
        auto outcome = fits.fit_means(progress);
        if (outcome) outcome->max_theta = k_pi / 2;
        return outcome;
    }
    PmFitOptions options = quick_options(pm_options(request, pm->axial.value_or(is_isotropic(table)), PmForm::extended),
                                         k_starts, k_perturbations);
    std::vector<Size> sizes(std::begin(k_sizes), std::end(k_sizes));
    if (lobes_of(*pm)) sizes = {{options.lobes, options.variates}};
    // The mean over a patch cannot resolve lobes that are narrower than the patch.
    options.finest = k_finest * min_width(table.outgoing);
    const double size_count = double(sizes.size());
    for (std::size_t i = 0; i < sizes.size(); ++i) {
        const auto done =
            fits.fit_size(options, sizes[i], progress.subrange(double(i) / size_count, double(i + 1) / size_count));
        if (!done) return done.error();
        if (fits.is_enough()) break;
        if (fits.error() > k_far_from_goal * k_good_error && i + 2 < sizes.size())
            i = sizes.size() - 2;  // continue with the largest
    }
    FitOutcome outcome = fits.best();
    outcome.fit_seconds = seconds_since(start);
    outcome.max_theta = k_pi / 2;
    outcome.raw_bytes = table.cells.size() * sizeof(float);
    return outcome;
}

}  // namespace
