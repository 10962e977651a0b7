// Where the search begins and what it tries: random lobes, and lobes with one more or less.
#pragma once
#include <random>
#include <vector>

#include "models/pm/solve/lobes.h"

namespace srbf {

/// The random generator of one of the streams of a start: 0 of its growth, 1 of its polish, 2 + i of perturbation i.
std::mt19937_64 generator(std::uint64_t seed, int start, int stream);

/// Initial parameterizations: half vector, light, view (Tsai 2009), the half vector again (a peak narrower than the
/// largest bandwidth in 16 bits needs two), further ones at random. In every other start those of light and view are
/// rotated by up to a radian, since some optima are far from both, and of three the last is the half vector.
Lobes initial_parameterizations(const LobeShape& shape, int start, std::mt19937_64& random);

/// A random lobe: weights of either sign, log-uniform, some of them 0; or a perturbed copy of one of `lobes`. Half of
/// the general centres are poles, the others uniform on the sphere.
std::vector<double> random_lobe(std::mt19937_64& random, const Lobes& lobes);

/// Random lobes to choose an additional one from.
std::vector<std::vector<double>> random_candidates(std::mt19937_64& random, const Lobes& lobes);
/// The lobes with another one: `lobe`, or one of weights 0 if it is empty.
Lobes with_lobe(Lobes lobes, const std::vector<double>& lobe);
Lobes without_lobe(Lobes lobes, std::ptrdiff_t j);
/// The lobes with the weights of variate n set to 0.
Lobes with_variate_zeroed(Lobes lobes, int n);

}  // namespace srbf
