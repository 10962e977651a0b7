// Random lobes: the starts and the moves of the search.
#pragma once
#include <random>

#include "models/pm/solve/lobes.h"

namespace SRBF_NAMESPACE {

/// The random generator of one of the streams of a start: 0 for its growth, 1 for its polish, 2 + i for
/// perturbation i.
std::mt19937_64 generator(std::uint64_t seed, int start, int stream);

/// Initial parameterizations: half vector, light, view (Tsai 2009), the half vector again, and random ones. A peak
/// narrower than the largest 16-bit bandwidth needs two half vectors. In every second start light and view are
/// rotated by up to a radian, because some optima are far from both, and with three variates the last is the half
/// vector.
Lobes initial_parameterizations(const LobeShape& shape, int start, std::mt19937_64& random);

/// A random lobe. Its weights are log-uniform with either sign, and some are 0; or it is a perturbed copy of one of
/// `lobes`. Half of the general centres are poles, the others are uniform on the sphere.
std::vector<double> random_lobe(std::mt19937_64& random, const Lobes& lobes);

/// Random candidates for an additional lobe.
std::vector<std::vector<double>> random_candidates(std::mt19937_64& random, const Lobes& lobes);
/// The lobes with `lobe` added, or with a lobe of weights 0 if `lobe` is empty.
Lobes with_lobe(Lobes lobes, const std::vector<double>& lobe);
Lobes without_lobe(Lobes lobes, std::ptrdiff_t j);
/// The lobes with the weights of variate n set to 0.
Lobes with_variate_zeroed(Lobes lobes, int n);

}  // namespace srbf
