// Fits to averages over patches.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "base/floating_point.h"
#include "base/r_sequence.h"
#include "brdf/directions.h"
#include "extras/daylight/klems.h"
#include "fit/requests.h"
#include "measured/isotropy.h"
#include "models/ggx/fit_ggx.h"
#include "models/pm/search/fit_pm.h"
#include "models/su/fit_su.h"
#include "observe/pair_weights.h"
#include "observe/pairs.h"
#include "srbf/elementary.h"

namespace srbf {
namespace {

/// Points of a pair of patches at which a fit observes it.
constexpr std::size_t k_fitted_points = 8;
/// Points of an outgoing patch in directional-hemispherical sums.
constexpr std::size_t k_hemisphere_points = 4;
/// Rounds of expectation and maximisation: each but the first begins from the previous one's errors and lobes, and
/// another one follows if the error has fallen by that share.
constexpr int k_most_rounds = 3;
constexpr double k_least_gain_of_round = 0.02;
/// Most matrices are smooth, and a fit is repeated.
constexpr int k_starts = 8, k_perturbations = 12;
/// Half of the share to which the sums have to be right, `k_good_share`.
constexpr double k_integral_error = 0.005;
/// The sizes that are tried, and what is good enough (fit_bsdf.h, `fit_patches`).
struct Size {
    int lobes, variates;
};
constexpr Size k_sizes[] = {{1, 1}, {1, 2}, {2, 2}, {3, 2}, {4, 3}, {6, 3}, {8, 4}};
constexpr double k_good_error = 1e-3, k_good_share = 0.01, k_good_sum = 0.001;
/// From an error so many times as large no size between leads to a good one.
constexpr double k_far = 100;
/// The least width of a lobe in those of the narrowest ring of patches.
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
    std::vector<ObservedIntegral> all;
    const AngleBasis& out = table.outgoing;
    for (const std::size_t i : incident) {
        ObservedIntegral sum;
        sum.in_search = all.size() % 2 == 0;
        const Vec3f light = light_at(table.incident.middle_of(i));
        RSequence<2> points;
        for (std::size_t o = 0; o < out.patches(); ++o) {
            const Rgb f = table.cell(o, i);
            if (!is_finite(f)) continue;
            for (std::size_t k = 0; k < k_hemisphere_points; ++k) {
                const auto u = points.next();
                sum.wv.push_back(light);  // exchanged with the viewer, as in all that a matrix observes
                sum.wl.push_back(view_at(out.point_of(o, u[0], u[1])));
                sum.f.push_back(non_negative(f));
                sum.weight.push_back(out.projected_solid_angle(out.ring_of(o)) / double(k_hemisphere_points));
            }
        }
        all.push_back(std::move(sum));
    }
    return all;
}

/// The sums without beams, of `hemispheres` for these incident patches.
std::vector<Hemispherical> scattered(const KlemsTable& table, std::span<const std::size_t> incident,
                                     const std::vector<ObservedIntegral>& sums, const Evaluate& f) {
    std::vector<Hemispherical> all;
    for (std::size_t i = 0; i < sums.size(); ++i) {
        const ObservedIntegral& of = sums[i];
        const auto light = angles(light_at(table.incident.middle_of(incident[i])));
        Hemispherical sum{double(light.theta), double(light.phi), 0, 0};
        std::vector<Rgb> fitted(of.f.size());
        f(of.wv, of.wl, fitted);
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

/// The width of the narrowest ring; that of the cap at the normal is its diameter.
double least_width(const AngleBasis& basis) {
    double least = k_pi / 2;
    for (const AngleBasis::Ring& ring : basis.rings)
        least = std::min(least, double(ring.from > 0 ? ring.to - ring.from : 2 * ring.to));
    return least;
}

/// Fits to one matrix.
class PatchFits {
  public:
    PatchFits(const KlemsTable& table, const FitRequest& request) : table_(table), request_(request) {
        for (const Rgb& mean : points_.mean) means_.insert(means_.end(), points_.points, mean);
    }

    Result<FitOutcome> fit_ggx(const ProgressToken& progress) const {
        return srbf::fit_ggx(observed(means_), request_, progress);  // reciprocal
    }

    /// A fit of this size in several rounds, the best of them. A search that is no better than a smaller size is repeated
    /// with other random numbers.
    Result<Done> fit_size(FitOptions options, const Size& size, const ProgressToken& progress) {
        options.lobes = size.lobes, options.variates = size.variates;
        if (options.reciprocal) options.variates += options.variates % 2;
        std::vector<Rgb> values = means_;
        std::optional<PmModel> begin;
        for (int round = 0; round < k_most_rounds; ++round) {
            auto fit = fit_pm(observed(values), options,
                              progress.part(double(round) / k_most_rounds, (round + 1.0) / k_most_rounds),
                              begin ? &*begin : nullptr);
            if (!fit) return fit.error();
            if (progress.cancelled()) return cancelled_error("fit");
            PmModel lobes = fit->unrounded;
            FitOutcome outcome = outcome_of(*std::move(fit));
            exchange(outcome.model), exchange(outcome.unrounded);
            const Evaluate fitted = evaluator(outcome.model);
            const double error = measured_.error_ratio(fitted), before = best_ ? error_ : 2 * error;
            if (error < before) best_ = outcome, error_ = error;
            if (begin && !(error < (1 - k_least_gain_of_round) * before)) break;
            if (error < before)
                begin = std::move(lobes), values = expected_values(fitted);
            else
                ++options.seed;
        }
        return Done{};
    }
    /// True if the best fit so far is good enough.
    bool is_enough() const {
        return error_ <= k_good_error &&
               std::ranges::all_of(scattered(table_, incident_, integrals_, evaluator(best_->model)), is_good);
    }
    double error() const { return error_; }
    FitOutcome best() { return *std::move(best_); }

  private:
    Observations observed(const std::vector<Rgb>& values) const {
        Observations all;
        all.objective = Objective::cosine;
        all.wl = points_.wv, all.wv = points_.wl, all.f = values;  // exchanged, as in `hemispheres`
        for (std::size_t k = 0; k < values.size(); ++k)
            all.weight.push_back(points_.weight[k / points_.points] / double(points_.points));
        all.normalise();
        double sum = 0;
        for (const Rgb& f : values) sum += mean_of(f);
        all.typical = sum / double(values.size());
        std::mt19937_64 random(request_.seed);
        all.shuffle(random);
        for (const auto& [wl, wv] : horizon_grid()) {
            const Rgb f = value(table_, wv, wl);
            if (!is_finite(f)) continue;
            all.add(wl, wv, f, 0);
            ++all.bound_pairs;
        }
        all.integrals = integrals_;
        all.integral_error = k_integral_error;
        return all;
    }

    /// The expected values within the patches, for their averages and this fit.
    std::vector<Rgb> expected_values(const Evaluate& fitted) const {
        std::vector<Rgb> values(points_.wl.size());
        fitted(points_.wl, points_.wv, values);
        const std::vector<Rgb> averages = points_.averages(fitted);
        for (std::size_t k = 0; k < values.size(); ++k)
            for (int c = 0; c < 3; ++c) {
                const std::size_t patches = k / points_.points;
                values[k][c] = std::max(values[k][c] + points_.mean[patches][c] - averages[patches][c], 0.f);
            }
        return values;
    }

    const KlemsTable& table_;
    const FitRequest& request_;
    const PatchSums points_ = sums_of(table_, k_fitted_points), measured_ = sums_of(table_, k_measured_points);
    const std::vector<std::size_t> incident_ = first_patches(table_);
    const std::vector<ObservedIntegral> integrals_ = hemispheres(table_, incident_);
    std::vector<Rgb> means_;  // of the patches, at each of the points
    std::optional<FitOutcome> best_;
    double error_ = 0;
};

}  // namespace

PatchSums sums_of(const KlemsTable& table, std::size_t points) {
    PatchSums sums;
    sums.points = points;
    RSequence<4> sequence;
    for (const PatchClass& of : patch_classes(table, is_isotropic(table))) {
        sums.mean.push_back(non_negative(of.mean));
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

std::vector<Hemispherical> hemispherical(const KlemsTable& table, const Evaluate& f, const Beams& beams, Part part) {
    std::vector<std::size_t> incident = first_patches(table);
    if (!is_isotropic(table)) {
        incident.resize(table.incident.patches());
        std::iota(incident.begin(), incident.end(), std::size_t(0));
    }
    const auto sums = hemispheres(table, incident);
    std::vector<Hemispherical> all = scattered(table, incident, sums, f);
    for (std::size_t k = 0; k < all.size(); ++k) {
        if (!table.beam.empty()) all[k].measured += double(table.beam[incident[k]].g);
        all[k].fitted += double(share_at(beams, part, light_at(table.incident.middle_of(incident[k]))).g);
    }
    return all;
}

Result<FitOutcome> fit_patches(const KlemsTable& table, const FitRequest& request, const ProgressToken& progress) {
    const StandardArithmetic mode;
    const auto start = std::chrono::steady_clock::now();
    const Evaluate look_up = [&](auto wl, auto wv, auto f) {
        for (std::size_t i = 0; i < f.size(); ++i) f[i] = signed_value(table, wl[i], wv[i]);
    };
    if (std::holds_alternative<SuRequest>(request.model)) return fit_su(look_up, request, progress);
    PatchFits fits(table, request);
    const auto* pm = std::get_if<PmRequest>(&request.model);
    if (!pm) {
        auto outcome = fits.fit_ggx(progress);
        if (outcome) outcome->max_theta = k_pi / 2;
        return outcome;
    }
    std::vector<Size> sizes(std::begin(k_sizes), std::end(k_sizes));
    if (const auto lobes = lobes_of(*pm)) sizes = {{*lobes, pm->variates}};
    FitOptions options =
        in_short(pm_options(request, pm->axial.value_or(is_isotropic(table))), k_starts, k_perturbations);
    // The mean of a patch does not tell lobes narrower than the patch from each other.
    options.finest = k_finest * least_width(table.outgoing);
    const double all = double(sizes.size());
    for (std::size_t i = 0; i < sizes.size(); ++i) {
        const auto done = fits.fit_size(options, sizes[i], progress.part(double(i) / all, double(i + 1) / all));
        if (!done) return done.error();
        if (fits.is_enough()) break;
        if (fits.error() > k_far * k_good_error && i + 2 < sizes.size()) i = sizes.size() - 2;  // the largest is next
    }
    FitOutcome outcome = fits.best();
    outcome.fit_seconds = seconds_since(start);
    outcome.max_theta = k_pi / 2;
    outcome.raw_bytes = table.cells.size() * sizeof(float);
    return outcome;
}

}  // namespace srbf
