#include "models/pm/search/search.h"

#include <algorithm>

#include "brdf/directions.h"
#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {
namespace {

/// This fraction of random lobes are copies of an existing lobe, whose parameters are multiplied by up to e and shifted
/// by up to 2.
constexpr double k_copies = 0.25, k_log_stretch = 1, k_shift = 2;

/// Distribution of a parameter: 0 with probability `zero`, otherwise log-uniform between `min` and `factor` times
/// that, negative with probability `negative`.
struct ParameterDistribution {
    double zero, min, factor, negative;
};
/// Bandwidths, and exponent parameters that may form peaks. A bandwidth of 0.3 hardly changes over the sphere; the
/// largest one fits 16-bit floats. A factor that rises away from its pole needs no more than `k_steepest`.
constexpr ParameterDistribution k_sharp{0.35, 0.3, 2e5, 0.3};
constexpr double k_steepest = 100;
/// Other exponent parameters, over the range in which they have an effect.
constexpr ParameterDistribution k_broad{0.5, 0.1, 100, 0.5};
/// Fraction of general centres that are poles; the others are uniform on the sphere.
constexpr double k_poles = 0.5;

/// Draws three random numbers in a fixed order, whatever the compiler.
double sample_parameter(const ParameterDistribution& distribution, double steepest, std::mt19937_64& random) {
    const double chance = uniform(random),
                 size = distribution.min * elementary::pow(distribution.factor, uniform(random)),
                 sign = uniform(random);
    return chance < distribution.zero ? 0.0 : sign < distribution.negative ? -std::min(size, steepest) : size;
}

}  // namespace

Lobes initial_parameterizations(const LobeShape& shape, int start, std::mt19937_64& random) {
    Lobes lobes{shape, {k_pi / 4, 0, k_pi / 2, k_pi / 4}, {}};
    lobes.angle.resize(std::size_t(shape.variates));
    for (std::size_t n = 4; n < lobes.angle.size(); ++n) lobes.angle[n] = k_pi * uniform(random);
    if (start % 2 == 1) {
        if (shape.variates == 3) lobes.angle[2] = k_pi / 4;
        const std::size_t end = shape.variates == 3 ? 2 : 3;
        for (std::size_t n = 1; n < std::min(lobes.angle.size(), end); ++n) lobes.angle[n] += 2 * uniform(random) - 1;
    }
    return lobes;
}

std::vector<double> random_lobe(std::mt19937_64& random, const Lobes& lobes) {
    const LobeShape& shape = lobes.shape;
    const auto clamp_parameter = [&](double w, int i) {
        const Interval range = parameter_range(i, shape);
        return std::clamp(w, range.min, range.max);
    };
    if (lobes.count() > 0 && uniform(random) < k_copies) {
        const auto parent = lobes.parameters_of(int(uniform(random) * lobes.count()));
        std::vector<double> parameter(parent.begin(), parent.end());
        for (int i = 0; i < shape.width(); ++i) {
            double& w = parameter[std::size_t(i)];
            const double scale = uniform(random), shift = uniform(random);  // a fixed order, whatever the compiler
            w = clamp_parameter(w * elementary::exp(k_log_stretch * (2 * scale - 1)) + k_shift * (2 * shift - 1), i);
        }
        return parameter;
    }
    std::vector<double> parameter;
    const auto sharp = [&] { return sample_parameter(k_sharp, k_steepest, random); };
    const auto broad = [&] { return sample_parameter(k_broad, k_broad.min * k_broad.factor, random); };
    for (int n = 0; n < shape.variates; ++n) {
        const double p = sharp();
        if (shape.axial) {
            parameter.push_back(clamp_parameter(p, int(parameter.size())));
            continue;
        }
        const double chance = uniform(random), z = 2 * uniform(random) - 1, phi = 2 * k_pi * uniform(random);
        const Vec3d centre = chance < k_poles ? Vec3d(0, 0, 1) : spherical(elementary::acos(z), phi);
        for (const double component : {centre.x, centre.y, centre.z})
            parameter.push_back(clamp_parameter(p * component, int(parameter.size())));
    }
    for (int k = 0; k < features(shape.form); ++k) {
        const double w = broad();
        parameter.push_back(clamp_parameter(k_terms[std::size_t(k)].is_sharp ? sharp() : w, int(parameter.size())));
    }
    return parameter;
}

std::mt19937_64 generator(std::uint64_t seed, int start, int stream) {
    std::seed_seq seeds{std::uint32_t(seed), std::uint32_t(seed >> 32), std::uint32_t(start), std::uint32_t(stream)};
    return std::mt19937_64(seeds);
}

std::vector<std::vector<double>> random_candidates(std::mt19937_64& random, const Lobes& lobes, int count) {
    std::vector<std::vector<double>> candidates;
    for (int i = 0; i < count; ++i) candidates.push_back(random_lobe(random, lobes));
    return candidates;
}

Lobes with_lobe(Lobes lobes, const std::vector<double>& lobe) {
    lobes.parameter.insert(lobes.parameter.end(), lobe.begin(), lobe.end());
    if (lobe.empty()) lobes.parameter.insert(lobes.parameter.end(), std::size_t(lobes.shape.width()), 0.0);
    return lobes;
}

Lobes without_lobe(Lobes lobes, std::ptrdiff_t j) {
    const auto begin = lobes.parameter.begin() + j * lobes.shape.width();
    lobes.parameter.erase(begin, begin + lobes.shape.width());
    return lobes;
}

Lobes with_variate_zeroed(Lobes lobes, int n) {
    const int D = lobes.shape.components(), W = lobes.shape.width();
    for (int j = 0; j < lobes.count(); ++j) std::fill_n(lobes.parameter.begin() + j * W + n * D, D, 0.0);
    return lobes;
}

}  // namespace
