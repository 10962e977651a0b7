#include "models/pm/solve/spectra.h"

#include <limits>

#include "base/least_squares.h"
#include "brdf/colour.h"
#include "models/pm/solve/rounding.h"
#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {
namespace {

/// The cost of an error of a lobe's colour, compared with that of an error of its spectrum. It is small, so that the
/// problem stays well-conditioned; rounds that ask for what is still missing make the colour exact.
constexpr double k_colour_importance = 10;
constexpr int k_colour_rounds = 5;

/// The coefficients of the model's lobes in the units of a problem that has evaluated them, J × 3.
Eigen::MatrixXd coefficients_in(const LobeProblem& problem, const PmModel& model, const Lobes& lobes) {
    Eigen::MatrixXd beta(model.lobes, 3);
    for (int j = 0; j < model.lobes; ++j) {
        const auto k = std::size_t(j);
        const double log_unit =
            elementary::log(problem.scale()) + log_peak_factor(lobes.weights_of(j), lobes.shape, problem.offset()[k]);
        const double factor = elementary::exp(double(model.log_scale[k]) - log_unit);
        for (int c = 0; c < 3; ++c) beta(j, c) = factor * double(model.coefficient[k][c]);
    }
    return beta;
}

}  // namespace

// Σ |y − Σ_j E_j s_j|², where s_j are spectra of given colours and y is data, is least if each s_j is the one of these
// colours nearest to the spectrum without that condition, whatever the products of the lobes are.
PmModel with_spectra(PmModel model, const LobeShape& shape, const Observations& observations) {
    const Lobes lobes = to_lobes(model, shape);
    const Rows rows(observations, {.spectra = true});
    LobeProblem problem(rows, shape, true);
    problem.loss(pack(lobes));

    const std::vector<Rgb> weights = rgb_weights(observations.wavelengths);
    const auto C = Eigen::Index(weights.size());
    Eigen::MatrixXd to_colour(C, 3);
    for (Eigen::Index i = 0; i < C; ++i)
        for (int c = 0; c < 3; ++c) to_colour(i, c) = double(weights[std::size_t(i)][c]);
    const double importance = k_colour_importance * double(C);  // Σ |to_colour|² falls with the number of wavelengths
    const Eigen::MatrixXd G = Eigen::MatrixXd::Identity(C, C) + importance * to_colour * to_colour.transpose();
    const Eigen::VectorXd unlimited = Eigen::VectorXd::Constant(C, std::numeric_limits<double>::infinity());
    const Eigen::MatrixXd colour = coefficients_in(problem, model, lobes);
    Eigen::MatrixXd spectrum = problem.beta();
    for (Eigen::Index j = 0; j < spectrum.rows(); ++j) {
        const Eigen::VectorXd free = spectrum.row(j).transpose(), wanted = colour.row(j).transpose();
        Eigen::VectorXd asked = wanted, nearest;
        for (int round = 0; round < k_colour_rounds; ++round) {
            nearest = bounded_least_squares(G, free + importance * to_colour * asked, unlimited);
            asked += wanted - to_colour.transpose() * nearest;
        }
        spectrum.row(j) = nearest.transpose();
    }
    problem.continue_from(spectrum);
    const PmModel spectral = to_model(problem, lobes, observations.wavelengths);
    model.spectrum = spectral.spectrum, model.wavelength = spectral.wavelength;
    model.coefficient = spectral.coefficient, model.log_scale = spectral.log_scale;
    return model;
}

}  // namespace srbf
