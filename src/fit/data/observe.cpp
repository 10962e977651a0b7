#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "fit/data/check_grid.h"
#include "fit/data/observations.h"
#include "fit/data/observe_pictures.h"
#include "fit/objective/objective.h"
#include "fit/objective/point_lights.h"
#include "parallel.h"
#include "r_sequence.h"
#include "reporter.h"
#include "srbf/colour.h"
#include "srbf/directions.h"
#include "srbf/elementary.h"

namespace srbf {
namespace {

constexpr std::size_t k_pairs_a_guard = 7;
constexpr std::size_t k_mirror_checks = 32768;
/// The pool of pairs is this many times as large as the observations, at most k_most_pairs.
constexpr std::size_t k_pool = 8, k_most_pairs = std::size_t(1) << 20;
/// This share is chosen with probability proportional to Σ w |f|², the rest uniformly.
constexpr double k_by_energy = 0.5;

/// Distribution of view directions: uniform over the cap, but a quarter uniform in log cosθ, so that directions close
/// to the horizon are not rare.
class ViewMixture {
  public:
    explicit ViewMixture(double cos_max) : cos_max_(cos_max) {}
    Vec3d sample(double u0, double u1, double u2) const {
        const double z = u0 < k_uniform ? 1 - u1 * (1 - cos_max_) : elementary::pow(cos_max_, u1);
        const double r = std::sqrt(std::max(0.0, 1 - z * z)), phi = 2 * k_pi * u2;
        return {r * elementary::cos(phi), r * elementary::sin(phi), z};
    }
    double pdf(Vec3d w) const {  // [1/sr]
        return (k_uniform / (1 - cos_max_) + (1 - k_uniform) / (w.z * -elementary::log(cos_max_))) / (2 * k_pi);
    }

  private:
    static constexpr double k_uniform = 0.75;
    double cos_max_;
};

/// θv of the observed radiances [degrees], and the number of directions of each.
constexpr double k_albedo_angles[] = {0, 15, 30, 45, 60, 70, 75, 80, 85};
constexpr int k_radiance_points = 4096;
/// `radiance_error` of an objective of pictures.
constexpr double k_picture_error = 0.02;

struct Draw {
    Vec3d wl, wv;
    double weight = 0;  // 1 / density within the caps, 0 for a guard
};

/// Pairs and their measured values.
struct Drawn {
    std::vector<Vec3f> wl, wv;
    std::vector<Rgb> f;          // ≥ 0
    std::vector<double> weight;  // of a sample
    std::uint64_t masked = 0, clamped = 0;
    std::size_t size() const { return f.size(); }
};

/// Evaluates f at `draw(i)`, i < count. Keeps the pairs that exist and have a value, in order.
template <typename DrawAt>
Drawn measured(const Evaluate& f, std::size_t count, int threads, const DrawAt& draw, Reporter& reporter) {
    constexpr std::size_t k_part = 4096;
    std::vector<Drawn> parts(part_count(count, k_part));
    parallel_for_parts(count, k_part, threads, [&](std::size_t begin, std::size_t end) {
        if (!reporter.advance("observing", double(k_part))) return;
        Drawn part;
        for (std::size_t i = begin; i < end; ++i) {
            const std::optional<Draw> one = draw(i);
            if (!one) continue;
            part.wl.push_back(to_float(one->wl)), part.wv.push_back(to_float(one->wv));
            part.weight.push_back(one->weight);
        }
        part.f.resize(part.wl.size());
        f(part.wl, part.wv, part.f);
        Drawn& kept = parts[begin / k_part];
        for (std::size_t i = 0; i < part.size(); ++i) {
            if (!is_finite(part.f[i])) {
                ++kept.masked;
                continue;
            }
            kept.clamped += std::uint64_t(clamp_negative(part.f[i]));
            kept.wl.push_back(part.wl[i]), kept.wv.push_back(part.wv[i]);
            kept.f.push_back(part.f[i]), kept.weight.push_back(part.weight[i]);
        }
    });
    Drawn all;
    const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
    for (const Drawn& part : parts) {
        append(all.wl, part.wl), append(all.wv, part.wv), append(all.f, part.f), append(all.weight, part.weight);
        all.masked += part.masked, all.clamped += part.clamped;
    }
    return all;
}

struct ChosenPair {
    std::size_t index;
    double times;  ///< that it was chosen, over the expected number
};

/// Chooses about `count` of the pairs, in order: half by their share of Σ w |f|², half uniformly. Sums over
/// the chosen pairs, their weights times `times`, are unbiased; pairs that are chosen several times are merged.
std::vector<ChosenPair> choose(const Drawn& pool, std::span<const double> weight, std::size_t count) {
    const double energy = energy_of(pool.f, weight);
    std::vector<ChosenPair> chosen;
    double sum = 0.5;
    for (std::size_t i = 0; i < pool.size(); ++i) {
        const double by_energy = weight[i] * square_of(pool.f[i]) / energy, alike = 1 / double(pool.size());
        const double expected = double(count) * (k_by_energy * by_energy + (1 - k_by_energy) * alike);
        const double times = std::floor(sum + expected) - std::floor(sum);
        sum += expected;
        if (times > 0) chosen.push_back({i, times / expected});
    }
    return chosen;
}

std::vector<RadianceObservation> observe_albedos(const Evaluate& f, double theta_max, int threads) {
    std::vector<double> angles;
    for (const double theta : k_albedo_angles)
        if (!(theta * k_degree > theta_max)) angles.push_back(theta * k_degree);
    std::vector<RadianceObservation> all(angles.size());
    parallel_for(all.size(), threads, [&](std::size_t k) {
        // Any azimuth is sufficient for isotropic data; the azimuths are spread for other data.
        const Vec3d wv = spherical(angles[k], 2.4 * double(k));
        Quadrature points = MirrorMixture(theta_max).quadrature(wv, k_radiance_points);
        RadianceObservation seen{to_float(wv), std::move(points.w), {}, std::move(points.weight), {}};
        seen.f.resize(seen.wl.size());
        f(seen.wl, std::vector<Vec3f>(seen.wl.size(), seen.wv), seen.f);
        for (std::size_t i = 0; i < seen.f.size(); ++i) {
            const bool valid = is_finite(seen.f[i]);
            seen.weight[i] *= valid ? double(seen.wl[i].z) : 0;
            if (!valid) seen.f[i] = {};
            clamp_negative(seen.f[i]);
        }
        all[k] = std::move(seen);
    });
    return all;
}

}  // namespace

std::vector<std::pair<Vec3d, Vec3d>> check_grid() {
    std::vector<double> theta{0, 2, 5};
    for (double t = 10; t < 80; t += 5) theta.push_back(t);
    for (const double t : {79.0, 82.0, 85.0, 87.0, 88.0, 89.0, 89.5, 89.9}) theta.push_back(t);
    // Light and view are never exactly equal: there ψ of (1, −1) has no direction, and its direction is discontinuous.
    std::vector<double> phi{0.5, 1,   3,   6,   10,  15,  20,  30,  40,  50,  60,  75, 90,
                            105, 120, 130, 140, 150, 160, 165, 170, 174, 177, 179, 180};
    std::vector<std::pair<Vec3d, Vec3d>> grid;
    for (const double l : theta)
        for (const double v : theta)
            for (const double p : phi) {
                const double turn = 2.4 * double(grid.size());  // any azimuth is sufficient for isotropic data
                const double of_view = l == 0 && v == 0 ? 0.25 : v;
                grid.emplace_back(spherical(l * k_degree, p * k_degree + turn), spherical(of_view * k_degree, turn));
            }
    return grid;
}

Result<Observations> observe(const Evaluate& f, const ObserveOptions& options, const ProgressToken& progress) {
    const FlushSubnormals mode;
    const double theta_max = options.max_theta == 0 ? default_max_theta(options.objective) : options.max_theta;
    if (!(theta_max >= k_degree && theta_max <= k_guard_theta))
        return Error{"observe",          {}, "max_theta", "1 to 89.9 degrees", std::to_string(theta_max / k_degree),
                     ErrorCode::argument};
    if (options.count < 1024 || options.count > std::size_t(1) << 24)
        return Error{"observe", {}, "count", "1024 to 16777216", std::to_string(options.count), ErrorCode::argument};

    std::mt19937_64 random(options.seed);
    const auto random_point = [&] {
        std::array<double, 6> point;
        for (double& x : point) x = uniform(random);
        return point;
    };
    const RSequence<6> pair_points(random_point()), guard_points(random_point()), check_points(random_point());
    const double cos_max = elementary::cos(theta_max), cos_guard = elementary::cos(k_guard_theta);
    const ViewMixture views(cos_max);
    const MirrorMixture lights(theta_max), guard_lights(k_guard_theta);

    // A pair within the caps.
    const auto draw_pair = [&](std::size_t i) -> std::optional<Draw> {
        const auto u = pair_points.at(i);
        const Vec3d wv = views.sample(u[0], u[1], u[2]), wl = lights.sample(wv, u[3], u[4], u[5]);
        if (!lights.contains(wl)) return std::nullopt;
        return Draw{wl, wv, 1 / (views.pdf(wv) * lights.pdf(wl, wv))};
    };
    // Half of the guards have at least one direction between θmax and 89.9°; the others are nodes of the check grid.
    const auto grid = check_grid();
    const auto draw_guard = [&](std::size_t i) -> std::optional<Draw> {
        const auto u = guard_points.at(i);
        if (u[0] < 0.5) {
            const auto& [wl, wv] = grid[std::size_t(2 * u[0] * double(grid.size()))];
            return Draw{wl, wv};
        }
        const double z = cos_guard + u[1] * (cos_max - cos_guard), r = std::sqrt(1 - z * z);
        const Vec3d edge{r * elementary::cos(2 * k_pi * u[2]), r * elementary::sin(2 * k_pi * u[2]), z};
        const Vec3d other = guard_lights.sample(edge, u[3], u[4], u[5]);
        if (other.z < cos_guard) return std::nullopt;
        return u[0] < 0.75 ? Draw{edge, other} : Draw{other, edge};
    };
    // The checks: the grid, and as many pairs about the mirror direction as are needed to find a lobe between its
    // nodes.
    const auto draw_check = [&](std::size_t i) -> std::optional<Draw> {
        if (i < grid.size()) return Draw{grid[i].first, grid[i].second};
        const auto u = check_points.at(i - grid.size());
        const Vec3d wv = guard_lights.sample_cap(u[1], u[2]), wl = guard_lights.sample(wv, u[3], u[4], u[5]);
        if (wl.z < cos_guard) return std::nullopt;
        return Draw{wl, wv};
    };

    const std::size_t guard_count = options.count / (k_pairs_a_guard + 1), pair_count = options.count - guard_count;
    const std::size_t pool_count = std::max(pair_count, std::min(k_pool * pair_count, k_most_pairs)),
                      check_count = grid.size() + k_mirror_checks;
    Reporter reporter(progress, double(pool_count + 2 * guard_count + check_count));
    const auto drawn = [&](std::size_t count, const auto& draw) {
        return measured(f, count, options.threads, draw, reporter);
    };
    const Drawn pool = drawn(pool_count, draw_pair), guards = drawn(2 * guard_count, draw_guard),
                checks = drawn(check_count, draw_check);
    if (reporter.cancelled()) return cancelled_error("observe");

    Observations observations;
    observations.masked = pool.masked + guards.masked + checks.masked;
    observations.clamped = pool.clamped + guards.clamped + checks.clamped;
    if (pool.size() + guards.size() == 0)
        return Error{"observe", {}, "pairs with a measurement", "some", "none", ErrorCode::no_data};
    observations.objective = options.objective;
    observations.typical = typical_value(options.objective, pool.wl, pool.wv, pool.f, pool.weight);
    if (!(observations.typical > 0)) return Error{"observe", {}, "values", "some above 0", "none", ErrorCode::no_data};

    std::vector<double> weight = pool.weight;
    weigh(options.objective, observations.typical, pool.wl, pool.wv, pool.f, weight, options.threads);
    double peak = 0;
    for (const Drawn* some : {&pool, &guards, &checks})
        for (std::size_t i = 0; i < some->size(); ++i)
            peak = std::max(peak,
                            square_of(some->f[i]) * elementary::square(double(some->wl[i].z) * double(some->wv[i].z)));

    const std::vector<ChosenPair> chosen = choose(pool, weight, pair_count);
    const auto weight_of = [&](const ChosenPair& pair) { return weight[pair.index] * pair.times; };
    double chosen_energy = 0;
    for (const ChosenPair& pair : chosen) chosen_energy += weight_of(pair) * square_of(pool.f[pair.index]);
    // A guard follows every seventh of them.
    const std::size_t guarded = std::min(guards.size(), chosen.size() / k_pairs_a_guard);
    std::vector<double> measure;  // of solid angles, 0 for guards
    const auto add = [&](const Drawn& from, std::size_t i, double weight_there) {
        observations.add(from.wl[i], from.wv[i], from.f[i], weight_there);
    };
    for (std::size_t k = 0; k < chosen.size(); ++k) {
        add(pool, chosen[k].index, weight_of(chosen[k]) / chosen_energy);
        measure.push_back(pool.weight[chosen[k].index] * chosen[k].times / double(pool.size()));
        const std::size_t g = k / k_pairs_a_guard;
        if (k % k_pairs_a_guard + 1 < k_pairs_a_guard || g >= guarded) continue;
        const double area = double(guards.wl[g].z) * double(guards.wv[g].z);
        add(guards, g, k_guard_importance * area * area / (double(guarded) * peak));
        measure.push_back(0);
    }
    if (traits(options.objective).of_pictures)
        observations.point_light_weight =
            point_light_weights(observations.wl, observations.wv, observations.f, measure);
    for (std::size_t i = 0; i < checks.size(); ++i) add(checks, i, 0);
    observations.checks = checks.size();
    observations.radiances = observe_albedos(f, theta_max, options.threads);
    if (traits(options.objective).of_pictures) {
        observations.views = observe_views(f, theta_max, options.threads);
        observations.radiance_error = k_picture_error;
    }
    return observations;
}

void observe_spectra(Observations& observations, const Channels& spectra) {
    const FlushSubnormals mode;
    observations.wavelengths = spectra.wavelengths;
    const std::size_t C = spectra.count();
    observations.spectrum.resize(C * observations.f.size());
    spectra.evaluate(observations.wl, observations.wv, observations.spectrum);
    observations.clamped = std::uint64_t(clamp_negative(observations.spectrum));
    for (RadianceObservation& seen : observations.radiances) {
        seen.spectrum.resize(C * seen.wl.size());
        spectra.evaluate(seen.wl, std::vector<Vec3f>(seen.wl.size(), seen.wv), seen.spectrum);
        clamp_negative(seen.spectrum);
    }
}

}  // namespace srbf
