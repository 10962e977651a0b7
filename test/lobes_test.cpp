// Lobes as a least-squares problem: derivatives, the linear subproblem, and the steps of the search.
#include "models/pm/solve/lobe_problem.h"

#include "base/half.h"
#include "base/least_squares.h"
#include "base/levenberg_marquardt.h"
#include "brdf_functions.h"
#include "errors/sphere.h"
#include "models/pm/pm_functions.h"
#include "models/pm/solve/rounding.h"
#include "observe/observations.h"
#include "properties.h"
#include "srbf/kernel.h"

namespace srbf::lobes_test {
namespace {

float gaussian_of_half_vector(Vec3f wl, Vec3f wv) {
    return Kernel<float>::gaussian(Kernel<float>::psi(wl, wv, 1, 1), {0, 0, 1}, 80);
}

/// Two lobes and a constant. No single lobe can fit their sum.
Observations observations(Objective objective, std::size_t count = 4096) {
    const Evaluate f = pairwise([](Vec3f wl, Vec3f wv) {
        const float g = gaussian_of_half_vector(wl, wv), b = wl.z * wv.z;
        return Rgb{0.2f + g, 0.3f * b + 0.5f * g, 0.1f * g + 0.05f * b * b};
    });
    return *observe(f, {objective, 0, count, 7});
}
Observations observations(std::size_t count = 4096) { return observations(Objective::raw, count); }

Lobes general_lobes() {
    return {{PmForm::extended, 2, false}, {0.7, 1.4}, {3,         -2, 40, 0.5, 1,   1, 0.5, 3,  0.2, 2,
                                                       /**/ -1.5, 2,  -1, 1,   0.3, 4, 0.7, -4, 0.3, 5}};
}

Lobes extended_lobes() { return {{PmForm::extended, 2}, {0.7, 1.4}, {40, 1, 0.5, 3, 0.2, 2, 3, -1.5, 1, -4, 0.3, 5}}; }

Lobes reciprocal(Lobes lobes) {
    lobes.shape.form = PmForm::reciprocal;
    return lobes;
}

/// Twice the lobes, so that there are more of them than channels.
Lobes doubled(Lobes lobes) {
    for (const double x : std::vector(lobes.parameter)) lobes.parameter.push_back(0.7 * x);
    return lobes;
}

const PackedObservations& rows() {
    static const PackedObservations cached(observations());
    return cached;
}

Lobes some_lobes() { return {{PmForm::gaussian, 3}, {0.7, 0.1, 1.4}, {40, -2, 1, 3, 0.5, -1.5, -0.7, 4, 2}}; }

LobeProblem problem_of(const PackedObservations& observed, const LobeShape& shape) { return {observed, shape, false}; }

/// Compares 2 Jᵀr from `linearise` with central differences of the loss.
void check_gradient(LobeProblem& problem, const Eigen::VectorXd& x) {
    Eigen::MatrixXd H;
    Eigen::VectorXd g;
    problem.loss(x);
    problem.linearise(x, H, g);
    ASSERT_EQ(g.size(), x.size());
    EXPECT_TRUE(H.isApprox(H.transpose(), 1e-9));
    for (Eigen::Index i = 0; i < x.size(); ++i) {
        const double step = 1e-3 * std::max(1.0, std::abs(x[i]));
        Eigen::VectorXd more = x, less = x;
        more[i] += step;
        less[i] -= step;
        const double difference = (problem.loss(more) - problem.loss(less)) / (2 * step);
        EXPECT_WITHIN(2 * g[i], difference, 0.01 * g.norm() * 2 + 1e-9) << "variable " << i;
    }
}

/// Σ w |f − f̂|² over the pairs.
double loss_of_pairs(const Observations& o, const PmModel& model) {
    double loss = 0;
    for (std::size_t i = 0; i < o.fitted_count(); ++i)
        loss += o.weight[i] * squared_distance(o.f[i], value(model, o.wl[i], o.wv[i]));
    return loss;
}

TEST(Lobes, SpectralGradientMatchesDifferences) {
    Observations o = observations(2048);
    Channels five{{400, 450, 500, 600, 700}, [](auto wl, auto wv, auto f) {
                      for (std::size_t i = 0; i < wl.size(); ++i) {
                          const float g = gaussian_of_half_vector(wl[i], wv[i]), b = wl[i].z * wv[i].z;
                          for (std::size_t c = 0; c < 5; ++c)
                              f[5 * i + c] = 0.1f * float(c + 1) + g / float(c + 1) + float(c % 2) * b * b;
                      }
                  }};
    observe_spectra(o, five);
    const PackedObservations spectral(o, {.spectra = true});
    EXPECT_EQ(spectral.y.size(), 5u);
    for (const Lobes& lobes : {some_lobes(), reciprocal(general_lobes()), doubled(reciprocal(general_lobes()))}) {
        LobeProblem problem = problem_of(spectral, lobes.shape);
        check_gradient(problem, pack(lobes));
    }
    LobeProblem problem = problem_of(spectral, some_lobes().shape);
    const Eigen::VectorXd x = pack(some_lobes());
    problem.loss(x);
    EXPECT_EQ(problem.beta().cols(), 5);
    const PmModel model = to_model(problem, some_lobes(), o.wavelengths);
    EXPECT_EQ(model.spectrum.size(), 15u);
    EXPECT_EQ(model.coefficient, colours(model.spectrum, o.wavelengths));
}

TEST(Lobes, GradientMatchesTheLoss) {
    const Lobes horizon{{PmForm::horizon, 2}, {0.7, 1.4}, {40, 1, 0.5, 3, -1.5, 1}}, extended = extended_lobes();
    for (const Lobes& lobes :
         {some_lobes(), horizon, extended, general_lobes(), reciprocal(extended), reciprocal(general_lobes()),
          doubled(some_lobes()), doubled(general_lobes()), doubled(reciprocal(general_lobes()))}) {
        LobeProblem problem = problem_of(rows(), lobes.shape);
        check_gradient(problem, pack(lobes));
    }
}

// The loss contains the squared difference of each integral, relative to its luminance.
TEST(Lobes, LossIncludesAlbedo) {
    const Observations o = observations();
    const double importance = 0.3;
    const PackedObservations rows_with_integrals(o, {.integral_importance = importance});
    for (const Lobes& lobes : {some_lobes(), general_lobes(), reciprocal(general_lobes())}) {
        LobeProblem problem = problem_of(rows_with_integrals, lobes.shape);
        const Eigen::VectorXd x = pack(lobes);
        const double loss = problem.loss(x);
        check_gradient(problem, x);
        const PmModel model = to_model(problem, lobes);
        double expected = loss_of_pairs(o, model);
        for (const ObservedIntegral& integral : o.integrals) {
            double total = 0;
            std::array<double, 3> difference_sum{};
            for (std::size_t i = 0; i < integral.wl.size(); ++i) {
                total += integral.weight[i] * luminance(integral.f[i]);
                const Rgb f = value(model, integral.wl[i], integral.wv[i]);
                for (int c = 0; c < 3; ++c)
                    difference_sum[std::size_t(c)] += integral.weight[i] * (double(integral.f[i][c]) - double(f[c]));
            }
            for (const double difference : difference_sum)
                expected += importance / double(o.integrals.size()) * elementary::pow(difference / total, 2);
        }
        EXPECT_WITHIN_RELATIVE(loss, expected, 2e-3);
    }
}

/// Returns the rows of the same observations with pictures.
const PackedObservations& rows_with_pictures() {
    static const PackedObservations cached(observations(Objective::appearance), {.picture_importance = 0.01});
    return cached;
}

TEST(Lobes, GradientMatchesTheLossWithPictures) {
    for (const Lobes& lobes : {some_lobes(), extended_lobes(), general_lobes(), reciprocal(general_lobes())}) {
        LobeProblem problem = problem_of(rows_with_pictures(), lobes.shape);
        const Eigen::VectorXd x = pack(lobes);
        for (int i = 0; i < 10; ++i) problem.loss(x);  // each starts from the previous coefficients
        check_gradient(problem, x);
    }
}

TEST(Lobes, LossIncludesPictures) {
    const Observations o = observations(Objective::appearance);
    ASSERT_FALSE(o.views.empty());
    LobeProblem problem = problem_of(rows_with_pictures(), some_lobes().shape);
    const Eigen::VectorXd x = pack(some_lobes());
    double loss = 0;
    for (int i = 0; i < 10; ++i) loss = problem.loss(x);
    const PmModel model = to_model(problem, some_lobes());
    double picture_loss = 0, delta_e = 0;
    int pixels = 0;
    for (const ObservedView& view : o.views)
        for (const ObservedPixel& pixel : view.pixels) {
            Rgb measured, fitted;
            for (std::size_t i = 0; i < pixel.weight.size(); ++i)
                for (int c = 0; c < 3; ++c) {
                    measured[c] += pixel.weight[i] * view.f[pixel.first + i][c];
                    fitted[c] += pixel.weight[i] * value(model, view.wl[pixel.first + i], view.wv)[c];
                }
            for (int c = 0; c < 3; ++c)
                if (measured[c] >= 1) {
                    measured[c] = 1;
                    fitted[c] = std::min(fitted[c], 1.f);
                }
            const double difference = delta_e_itp(measured, fitted);
            delta_e += difference;
            picture_loss += 2 * (std::sqrt(difference * difference + 1) - 1);
            ++pixels;
        }
    EXPECT_WITHIN_RELATIVE(loss, loss_of_pairs(o, model) + 0.01 * picture_loss / pixels, 2e-3);
    EXPECT_WITHIN_RELATIVE(problem.delta_e(), delta_e / pixels, 1e-3);
    // Pictures influence the coefficients: coefficients of the pairs alone have a larger visible error.
    const PackedObservations negligible(o, {.picture_importance = 1e-9});
    LobeProblem without_pictures = problem_of(negligible, some_lobes().shape);
    without_pictures.loss(x);
    EXPECT_LT(problem.delta_e(), 0.98 * without_pictures.delta_e());
}

TEST(Lobes, CoefficientsAreTheBestNonNegativeOnes) {
    LobeProblem problem = problem_of(rows(), some_lobes().shape);
    const Lobes lobes = some_lobes();
    const Eigen::VectorXd x = pack(lobes);
    const double loss = problem.loss(x);
    // Σ w |f − Σ β E|² evaluated directly, for the computed coefficients and for perturbed ones.
    const Observations o = observations();
    const auto loss_of = [&](const Eigen::MatrixXd& beta) {
        double total = 0;
        for (std::size_t i = 0; i < 4096; ++i)
            for (int c = 0; c < 3; ++c) {
                double f = 0;
                for (int j = 0; j < 3; ++j) {
                    double exponent = -problem.offset()[std::size_t(j)];
                    for (int n = 0; n < 3; ++n) {
                        const double angle = lobes.angle[std::size_t(n)];
                        const Vec3d psi = Kernel<double>::psi(to_double(o.wl[i]), to_double(o.wv[i]),
                                                              elementary::cos(angle), elementary::sin(angle));
                        exponent += lobes.parameters_of(j)[std::size_t(n)] * (psi.z - 1);
                    }
                    f += problem.scale() * beta(j, c) * elementary::exp(exponent);
                }
                total += double(o.weight[i]) * elementary::pow(double(o.f[i][c]) - f, 2);
            }
        return total;
    };
    EXPECT_WITHIN_RELATIVE(loss, loss_of(problem.beta()), 1e-4);
    EXPECT_GE(problem.beta().minCoeff(), 0);
    for (int j = 0; j < 3; ++j)
        for (int c = 0; c < 3; ++c)
            for (const double change : {-0.02, 0.02}) {
                Eigen::MatrixXd other = problem.beta();
                other(j, c) = std::max(0.0, other(j, c) + change);
                EXPECT_GE(loss_of(other), loss_of(problem.beta()) * (1 - 1e-6));
            }
}

TEST(Lobes, CostOfDroppingIsARiseOfTheLoss) {
    LobeProblem problem = problem_of(rows(), some_lobes().shape);
    const Lobes lobes{{PmForm::gaussian, 3}, {k_pi / 4, 0, k_pi / 2}, {80, 0, 0, 0, 0, 0, 0, 3, 3}};
    const double loss = problem.loss(pack(lobes));
    const std::vector<double> cost = cost_of_dropping(problem.gram(), problem.beta());
    for (std::size_t j = 0; j < 3; ++j) {
        Lobes fewer = lobes;
        fewer.parameter.erase(fewer.parameter.begin() + std::ptrdiff_t(3 * j),
                              fewer.parameter.begin() + std::ptrdiff_t(3 * j + 3));
        const double rise = problem.loss(pack(fewer)) - loss;
        EXPECT_GE(rise, cost[j] * 0.99) << j;  // constraints on the sign can only increase it
        EXPECT_LE(rise, cost[j] * 1.5) << j;
    }
}

TEST(Lobes, BestAdditionIsTheBestOfItsCandidates) {
    LobeProblem problem = problem_of(rows(), some_lobes().shape);
    Lobes lobes = some_lobes();
    lobes.parameter.resize(6);
    std::mt19937_64 random(5);
    std::vector<std::vector<double>> candidates;
    for (int k = 0; k < 40; ++k) {
        std::vector<double> weight(3);
        for (double& w : weight) w = 60 * uniform(random) - 2;  // its coefficient is far below the bound
        candidates.push_back(weight);
    }
    const double before = problem.loss(pack(lobes));
    const std::vector<double> best = problem.best_addition(candidates);
    std::vector<double> losses;
    for (const auto& candidate : candidates) {
        Lobes more = lobes;
        more.parameter.insert(more.parameter.end(), candidate.begin(), candidate.end());
        losses.push_back(problem.loss(pack(more)));
    }
    const auto chosen = std::find(candidates.begin(), candidates.end(), best) - candidates.begin();
    ASSERT_LT(chosen, 40);
    EXPECT_LT(losses[std::size_t(chosen)], before);
    // The gain assumes signed coefficients, so the choice is good but not always optimal.
    const double smallest = *std::min_element(losses.begin(), losses.end());
    EXPECT_LT(losses[std::size_t(chosen)] - smallest, 0.2 * (before - smallest));
}

TEST(Rounding, KeepsDirections) {
    std::mt19937_64 random(1);
    double largest = 0;
    for (int i = 0; i < 2000; ++i) {
        const double angle = 20 * uniform(random) - 10;
        const Parameterization p = rounded_direction(angle);
        EXPECT_EQ(round_to_half(p.a), p.a);
        EXPECT_EQ(round_to_half(p.b), p.b);
        largest =
            std::max(largest, std::abs(std::remainder(elementary::atan2(double(p.b), double(p.a)) - angle, 2 * k_pi)));
    }
    EXPECT_LT(largest, 3e-5);
}

// The columns of a problem are the values of the model of its lobes, in both orders of a reciprocal one.
TEST(Rounding, ModelOfReciprocalLobesHasTheirLoss) {
    const Observations o = observations();
    for (const Lobes& lobes : {reciprocal(general_lobes()), doubled(reciprocal(general_lobes()))}) {
        LobeProblem problem = problem_of(rows(), lobes.shape);
        const double loss = problem.loss(pack(lobes));
        const PmModel model = to_model(problem, lobes);
        EXPECT_TRUE(is_reciprocal(model));
        EXPECT_WITHIN_RELATIVE(loss, loss_of(o, evaluator(model)), 1e-3);
    }
}

TEST(Rounding, IsAtLeastAsGoodAsRoundingEachNumber) {
    for (const PackedObservations* observed : {&rows(), &rows_with_pictures()})
        for (const Lobes& lobes : {some_lobes(), extended_lobes(), general_lobes(), reciprocal(extended_lobes())}) {
            LobeProblem problem = problem_of(*observed, lobes.shape);
            Eigen::VectorXd x = pack(lobes);
            const double unrounded = levenberg_marquardt(problem, x, {.max_iterations = 30}).loss;
            const Lobes best = unpack(x, lobes.shape);
            const Eigen::MatrixXd beta = problem.beta();
            const Lobes each_rounded = round_lobes(problem, best, unrounded * 1e3);
            problem.continue_from(beta);
            const double loss_of_each = problem.loss(pack(each_rounded));
            problem.continue_from(beta);
            problem.loss(x);
            const Lobes rounded = round_lobes(problem, best, 0);  // no increase is acceptable
            EXPECT_LE(problem.loss(pack(rounded)), 1.001 * loss_of_each);
            const PmModel model = to_model(problem, rounded);
            EXPECT_EQ(pack(to_lobes(to_halves(model, rounded), lobes.shape)), pack(rounded));
        }
}

}  // namespace
}  // namespace srbf::lobes_test
