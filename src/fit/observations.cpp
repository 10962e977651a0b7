#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "evenly.h"
#include "fit/check_grid.h"
#include "fit/objective.h"
#include "srbf/colour.h"
#include "srbf/directions.h"
#include "srbf/fit.h"

namespace srbf {
namespace {

const double k_guard_share = 1.0 / 8;
constexpr std::size_t k_mirror_checks = 32768;
constexpr double k_guard_theta = 89.9 * k_degree;

/// Directions of view: even over the cap, a quarter of them even in log cosθ, so that grazing ones are not
/// rare.
class ViewMixture {
  public:
    explicit ViewMixture(double cos_max) : cos_max_(cos_max) {}
    Vec3d sample(double u0, double u1, double u2) const {
        const double z = u0 < k_even ? 1 - u1 * (1 - cos_max_) : std::pow(cos_max_, u1);
        const double r = std::sqrt(std::max(0.0, 1 - z * z)), phi = 2 * k_pi * u2;
        return {r * std::cos(phi), r * std::sin(phi), z};
    }
    double pdf(Vec3d w) const {  // [1/sr]
        return (k_even / (1 - cos_max_) + (1 - k_even) / (w.z * -std::log(cos_max_))) / (2 * k_pi);
    }

  private:
    static constexpr double k_even = 0.75;
    double cos_max_;
};

/// Albedo at θv [degrees] is observed by so many directions.
constexpr double k_albedo_angles[] = {0, 15, 30, 45, 60, 70, 75, 80, 85};
constexpr int k_albedo_points = 4096;

struct Draw {
    Vec3d wl, wv;
    double weight = 0;  // 1 / density within the caps, 0 for a guard
};

std::vector<AlbedoObservation> observe_albedo(const Evaluate& f, double theta_max) {
    std::vector<AlbedoObservation> all;
    for (const double theta : k_albedo_angles) {
        if (theta * k_degree > theta_max) continue;
        // Of isotropic data any azimuth will do; of others these are spread.
        const Vec3d wv = spherical(theta * k_degree, 2.4 * double(all.size()));
        Quadrature points = MirrorMixture(theta_max).quadrature(wv, k_albedo_points);
        AlbedoObservation albedo{to_float(wv), std::move(points.w), {}, std::move(points.weight), {}};
        albedo.f.resize(albedo.wl.size());
        f(albedo.wl, std::vector<Vec3f>(albedo.wl.size(), albedo.wv), albedo.f);
        for (std::size_t i = 0; i < albedo.f.size(); ++i) {
            const bool valid = is_finite(albedo.f[i]);
            albedo.weight[i] *= valid ? double(albedo.wl[i].z) : 0;
            if (!valid) albedo.f[i] = {};
            clamp_negative(albedo.f[i]);
        }
        all.push_back(std::move(albedo));
    }
    return all;
}

}  // namespace

std::string_view name(Objective objective) {
    switch (objective) {
        case Objective::raw:
            return "raw";
        case Objective::cosine:
            return "cosine";
        case Objective::log:
            return "log";
        case Objective::cube_root:
            return "cube-root";
    }
    return "";
}

std::optional<Objective> objective_named(std::string_view text) {
    for (const Objective objective : {Objective::raw, Objective::cosine, Objective::log, Objective::cube_root})
        if (name(objective) == text) return objective;
    return std::nullopt;
}

double Measures::*measure_of(Objective objective) {
    switch (objective) {
        case Objective::raw:
            return &Measures::squared_error_ratio;
        case Objective::cosine:
            return &Measures::squared_error_ratio_cosine;
        case Objective::log:
            return &Measures::log_rms_cosine;
        case Objective::cube_root:
            return &Measures::cube_root_error_ratio;
    }
    return nullptr;
}

double default_max_theta(Objective objective) {
    return (objective == Objective::raw || objective == Objective::cube_root ? 80 : 89) * k_degree;
}

std::vector<std::pair<Vec3d, Vec3d>> check_grid() {
    std::vector<double> theta{0, 2, 5};
    for (double t = 10; t < 80; t += 5) theta.push_back(t);
    for (const double t : {79.0, 82.0, 85.0, 87.0, 88.0, 89.0, 89.5, 89.9}) theta.push_back(t);
    std::vector<double> phi{0,   1,   3,   6,   10,  15,  20,  30,  40,  50,  60,  75, 90,
                            105, 120, 130, 140, 150, 160, 165, 170, 174, 177, 179, 180};
    std::vector<std::pair<Vec3d, Vec3d>> grid;
    for (const double l : theta)
        for (const double v : theta)
            for (const double p : phi) {
                const double turn = 2.4 * double(grid.size());  // of isotropic data any will do
                grid.emplace_back(spherical(l * k_degree, p * k_degree + turn), spherical(v * k_degree, turn));
            }
    return grid;
}

Observations beginning(const Observations& observations, std::size_t count) {
    count = std::min(count, observations.f.size() - observations.checks);
    const auto first = [&](const auto& of) {
        return std::remove_cvref_t<decltype(of)>(of.begin(), of.begin() + std::ptrdiff_t(count));
    };
    Observations some;
    some.wavelengths = observations.wavelengths;
    const std::size_t C = observations.wavelengths.size();
    some.spectrum.assign(observations.spectrum.begin(), observations.spectrum.begin() + std::ptrdiff_t(count * C));
    some.wl = first(observations.wl), some.wv = first(observations.wv);
    some.f = first(observations.f), some.weight = first(observations.weight);
    return some;
}

Result<Done> check(const Observations& observations, std::size_t parameters) {
    const std::size_t count = observations.f.size();
    if (observations.wl.size() != count || observations.wv.size() != count || observations.weight.size() != count)
        return Error{"fit", {}, "observations", "arrays of one length", "different lengths"};
    const std::size_t C = observations.wavelengths.size();
    bool has_spectra = observations.spectrum.size() == C * count;
    for (const AlbedoObservation& albedo : observations.albedo)
        has_spectra = has_spectra && albedo.spectrum.size() == C * albedo.f.size();
    if (!has_spectra || (C > 0 && !are_wavelengths(observations.wavelengths)))
        return Error{"fit", {}, "observations", "spectra at all of them, at increasing wavelengths", "others"};
    if (!std::ranges::all_of(observations.spectrum, [](float f) { return std::isfinite(f); }))
        return Error{"fit", {}, "observations", "finite spectra", "others"};
    if (observations.checks > count)
        return Error{"fit", {}, "checks", fmt::format("at most {}", count), fmt::format("{}", observations.checks)};
    const std::size_t values = 3 * (count - observations.checks);
    if (values < parameters)
        return Error{
            "fit", {}, "observations", fmt::format("at least {} values", parameters), fmt::format("{}", values)};
    for (std::size_t i = 0; i < count; ++i)
        if (!is_finite(observations.f[i]) || !(observations.weight[i] >= 0) || !std::isfinite(observations.weight[i]))
            return Error{"fit", i, "observation", "finite values and a weight of at least 0", "another"};
    const auto end_of_fitted = observations.weight.begin() + std::ptrdiff_t(count - observations.checks);
    if (std::none_of(observations.weight.begin(), end_of_fitted, [](double w) { return w > 0; }))
        return Error{"fit", {}, "observations", "a weight above 0", "none"};
    return Done{};
}

Result<Observations> observe(const Evaluate& f, const ObserveOptions& options) {
    const double theta_max = options.max_theta == 0 ? default_max_theta(options.objective) : options.max_theta;
    if (!(theta_max >= k_degree && theta_max <= 89.9 * k_degree))
        return Error{"observe", {}, "max_theta", "1 to 89.9 degrees", std::to_string(theta_max / k_degree)};
    if (options.count < 1024 || options.count > std::size_t(1) << 24)
        return Error{"observe", {}, "count", "1024 to 16777216", std::to_string(options.count)};

    std::mt19937_64 random(options.seed);
    const auto random_point = [&] {
        std::array<double, 6> point;
        for (double& x : point) x = uniform(random);
        return point;
    };
    Evenly<6> pairs(random_point()), guard_pairs(random_point());
    const double cos_max = std::cos(theta_max), cos_guard = std::cos(k_guard_theta);
    const ViewMixture views(cos_max);
    const MirrorMixture lights(theta_max), guard_lights(k_guard_theta);

    // A pair within the caps.
    const auto draw_pair = [&]() -> Draw {
        for (;;) {
            const auto u = pairs.next();
            const Vec3d wv = views.sample(u[0], u[1], u[2]), wl = lights.sample(wv, u[3], u[4], u[5]);
            if (lights.contains(wl)) return {wl, wv, 1 / (views.pdf(wv) * lights.pdf(wl, wv))};
        }
    };
    // Half of the guards have at least one direction between θmax and 89.9°, the others are nodes of the grid
    // of checks.
    const auto grid = check_grid();
    const auto draw_guard = [&]() -> Draw {
        for (;;) {
            const auto u = guard_pairs.next();
            if (u[0] < 0.5) {
                const auto& [wl, wv] = grid[std::size_t(2 * u[0] * double(grid.size()))];
                return {wl, wv, 0};
            }
            const double z = cos_guard + u[1] * (cos_max - cos_guard), r = std::sqrt(1 - z * z);
            const Vec3d edge{r * std::cos(2 * k_pi * u[2]), r * std::sin(2 * k_pi * u[2]), z};
            const Vec3d other = guard_lights.sample(edge, u[3], u[4], u[5]);
            if (other.z < cos_guard) continue;
            return u[0] < 0.75 ? Draw{edge, other, 0} : Draw{other, edge, 0};
        }
    };

    std::vector<Draw> draws;
    draws.reserve(options.count);
    for (std::size_t i = 0; i < options.count; ++i) {
        const bool guard = std::fmod(double(i) * k_guard_share, 1.0) + k_guard_share >= 1;
        draws.push_back(guard ? draw_guard() : draw_pair());
    }

    // The checks: the grid, and as many pairs about the mirror direction as may find a lobe between its nodes.
    for (const auto& [wl, wv] : grid) draws.push_back({wl, wv, 0});
    while (draws.size() < options.count + grid.size() + k_mirror_checks) {
        const auto u = guard_pairs.next();
        const Vec3d wv = guard_lights.sample_cap(u[1], u[2]), wl = guard_lights.sample(wv, u[3], u[4], u[5]);
        if (wl.z >= cos_guard) draws.push_back({wl, wv, 0});
    }

    Observations drawn;
    for (const Draw& draw : draws) {
        drawn.wl.push_back(to_float(draw.wl));
        drawn.wv.push_back(to_float(draw.wv));
    }
    drawn.f.resize(draws.size());
    f(drawn.wl, drawn.wv, drawn.f);

    // Drop what was not measured, clamp what is negative.
    Observations kept;
    double mean = 0, solid_angle = 0, peak = 0, guards = 0;
    std::vector<bool> is_guard;
    for (std::size_t i = 0; i < draws.size(); ++i) {
        if (!is_finite(drawn.f[i])) {
            ++kept.masked;
            continue;
        }
        Rgb value = drawn.f[i];
        kept.clamped += std::uint64_t(clamp_negative(value));
        const double cos_l = draws[i].wl.z, cos_v = draws[i].wv.z;
        kept.wl.push_back(drawn.wl[i]);
        kept.wv.push_back(drawn.wv[i]);
        kept.f.push_back(value);
        kept.weight.push_back(draws[i].weight);
        kept.checks += i >= options.count;
        is_guard.push_back(draws[i].weight == 0);
        guards += draws[i].weight == 0 && i < options.count;
        mean += draws[i].weight * mean_of(value);
        solid_angle += draws[i].weight;
        peak = std::max(peak, square_of(value) * cos_l * cos_l * cos_v * cos_v);
    }
    if (kept.f.size() == kept.checks) return Error{"observe", {}, "pairs with a measurement", "some", "none"};
    if (!(mean > 0)) return Error{"observe", {}, "values", "some above 0", "none"};
    mean /= solid_angle;

    double energy = 0;
    for (std::size_t i = 0; i < kept.f.size(); ++i) {
        const Rgb value = kept.f[i];
        const double cos_l = double(kept.wl[i].z), cos_v = double(kept.wv[i].z);
        kept.weight[i] *= objective_weight(options.objective, mean_of(value), mean, cos_l, cos_v);
        energy += kept.weight[i] * square_of(value);
    }
    for (std::size_t i = 0; i < kept.f.size(); ++i) {
        const double area = double(kept.wl[i].z) * double(kept.wv[i].z);
        kept.weight[i] = is_guard[i] ? k_guard_importance * area * area / (guards * peak) : kept.weight[i] / energy;
    }
    if (options.objective == Objective::cube_root) kept.root_mean = mean;
    kept.albedo = observe_albedo(f, theta_max);
    return kept;
}

void observe_spectra(Observations& observations, const Channels& spectra) {
    observations.wavelengths = spectra.wavelengths;
    const std::size_t C = spectra.count();
    observations.spectrum.resize(C * observations.f.size());
    spectra.evaluate(observations.wl, observations.wv, observations.spectrum);
    observations.clamped = std::uint64_t(clamp_negative(observations.spectrum));
    for (AlbedoObservation& albedo : observations.albedo) {
        albedo.spectrum.resize(C * albedo.wl.size());
        spectra.evaluate(albedo.wl, std::vector<Vec3f>(albedo.wl.size(), albedo.wv), albedo.spectrum);
        clamp_negative(albedo.spectrum);
    }
}

}  // namespace srbf
