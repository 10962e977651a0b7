#include "observe/directional_lights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "observe/costs.h"
#include "observe/observations.h"
#include "observe/pair_weights.h"
#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {
namespace {

/// Phases are equal intervals of the phase angle over [0, π].
constexpr std::size_t k_phases = 16;
using PerPhase = std::array<double, k_phases>;
/// Area of a pixel of a picture 64 pixels wide [squared radii of the sphere].
constexpr double k_pixel_area = 1.0 / (32 * 32);
constexpr int k_energy_steps = 20;
/// The terms cost less if their mean error, relative to their energy, exceeds this value. Otherwise errors that no
/// lobes can avoid would dominate.
constexpr double k_most_relative_rms = 0.25;
/// The error of a phase counts as at least this fraction of the largest one.
constexpr double k_least_rms = 0.1;

double start_of(std::size_t phase) { return double(phase) * k_pi / double(k_phases); }
std::size_t phase_of(Vec3f wl, Vec3f wv) {
    const double angle = elementary::acos(std::clamp(double(dot(wl, wv)), -1.0, 1.0));
    return std::min(std::size_t(angle / k_pi * double(k_phases)), k_phases - 1);
}

/// The fraction of its phase's pictures that a pair covers.
double area_of(std::size_t phase, Vec3f wv, double solid_angle) {
    const double ring = 2 * k_pi * (elementary::cos(start_of(phase)) - elementary::cos(start_of(phase + 1)));
    return solid_angle * double(wv.z) / ring;
}
double square_of_radiance(const Rgb& f, Vec3f wl) { return square_of(f) * elementary::square(double(wl.z)); }

}  // namespace

// A picture with pixels of area a has the energy Σ a g², g = f cosθl. A highlight smaller than a pixel appears in
// few of the pictures, and dominates the energy of those. So a pair is compared with T + a g², where T is the
// energy of all others.
std::vector<double> directional_light_weights(std::span<const Vec3f> wl, std::span<const Vec3f> wv,
                                              std::span<const Rgb> f, std::span<const double> solid_angle) {
    std::vector<std::size_t> phase(f.size());
    std::vector<double> area(f.size()), square(f.size()), weight(f.size());
    PerPhase others{};  // T of each phase
    for (std::size_t i = 0; i < f.size(); ++i) {
        phase[i] = phase_of(wl[i], wv[i]);
        area[i] = area_of(phase[i], wv[i], solid_angle[i]);
        square[i] = square_of_radiance(f[i], wl[i]);
        others[phase[i]] += area[i] * square[i];
    }
    // Scales T until Σ g² / (T + a g²) over the sphere is 1.
    for (int step = 0; step < k_energy_steps; ++step) {
        PerPhase next{};
        for (std::size_t i = 0; i < f.size(); ++i)
            if (square[i] > 0)
                next[phase[i]] += area[i] * square[i] / (1 + k_pixel_area * square[i] / others[phase[i]]);
        others = next;
    }
    for (std::size_t i = 0; i < f.size(); ++i) {
        const double energy = others[phase[i]] + k_pixel_area * square[i];
        weight[i] = energy > 0 ? area[i] * elementary::square(double(wl[i].z)) / energy : 0;
    }
    return weight;
}

void add_directional_lights(Observations& observations, const Evaluate& fitted, double most_loss) {
    const std::vector<double> added = std::exchange(observations.directional_light_weight, {});
    const std::size_t count = added.size();
    std::vector<Rgb> f(count);
    fitted(std::span(observations.wl).first(count), std::span(observations.wv).first(count), f);
    double loss = 0;
    PerPhase rms{}, energy{}, factor{};
    std::vector<std::size_t> phase(count);
    for (std::size_t i = 0; i < count; ++i) {
        const double squares = squared_distance(observations.f[i], f[i]);
        phase[i] = phase_of(observations.wl[i], observations.wv[i]);
        loss += observations.weight[i] * squares;
        rms[phase[i]] += added[i] * squares;
        energy[phase[i]] += added[i] * square_of(observations.f[i]);
    }
    for (double& x : rms) x = std::sqrt(x);
    const double least = k_least_rms * *std::ranges::max_element(rms);
    if (!(least > 0)) return;
    // cos(φ/2) is the square root of the lit fraction of the sphere's disc.
    double sum = 0, lit = 0, relative = 0;
    for (std::size_t k = 0; k < k_phases; ++k) {
        if (!(energy[k] > 0)) continue;
        const double root_of_lit = elementary::cos((start_of(k) + start_of(k + 1)) / 4);
        factor[k] = root_of_lit / std::max(rms[k], least);
        sum += factor[k] * rms[k] * rms[k];
        lit += root_of_lit, relative += root_of_lit * rms[k] / std::sqrt(energy[k]);
    }
    const double share = k_directional_lights * std::min(1.0, elementary::square(k_most_relative_rms * lit / relative));
    for (std::size_t i = 0; i < count; ++i)
        observations.weight[i] += share * std::min(loss, most_loss) / sum * factor[phase[i]] * added[i];
}

}  // namespace srbf
