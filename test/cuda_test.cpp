// The text of the CUDA backend, compiled for this processor and run over a serial grid.
#include "fit/cuda/steps.h"

#include <fmt/format.h>

#include "fit/fits.h"
#include "fit/model/features.h"
#include "fit/search/fit_pm.h"
#include "fit/search/search.h"
#include "fit/solve/least_squares.h"
#include "fit/solve/lobe_problem.h"
#include "one_target.h"
#include "properties.h"

namespace srbf::cuda_test {
namespace {

Observations observations(Objective objective = Objective::appearance) {
    const Evaluate f = [](auto wl, auto wv, auto out) {
        for (std::size_t i = 0; i < out.size(); ++i) {
            const Vec3f h = Kernel<float>::psi(wl[i], wv[i], 1, 1);
            const float g = Kernel<float>::gaussian(h, {0, 0, 1}, 80), b = wl[i].z * wv[i].z;
            out[i] = {0.2f + g, 0.3f * b + 0.5f * g, 0.1f * g + 0.05f * b * b};
        }
    };
    return *observe(f, {objective, 0, 1024, 7});
}

on_device::Observed observed(const Rows& rows) {
    on_device::Observed of{};
    for (std::size_t k = 0; k < 3; ++k) of.wl[k] = rows.wl[k].data(), of.wv[k] = rows.wv[k].data();
    for (std::size_t c = 0; c < 3; ++c) of.y[c] = rows.y[c].data();
    of.root_weight = rows.root_weight.data();
    of.pairs = int(rows.blocks * k_block);
    of.radiances = int(rows.radiances), of.rows_of_radiance = int(rows.radiance_blocks * k_block);
    of.scale = rows.scale;
    return of;
}

on_device::Shape shape_on_device(const LobeShape& shape, int lobes) {
    return {shape.variates, shape.components(), features(shape.form), lobes, shape.reciprocal};
}

/// A problem with all its memory.
struct Emulated {
    Emulated(const Rows& rows, const LobeShape& shape, const Eigen::VectorXd& at, double log_peak_limit)
        : x(at.begin(), at.end()), tile(on_device::k_shared) {
        problem.shape = shape_on_device(shape, int(at.size() - shape.variates) / shape.width());
        problem.observed = observed(rows);
        problem.log_peak_limit = log_peak_limit;
        doubles.resize(memory.doubles(problem.shape));
        memory.lay_out(problem.shape, tile.data(), doubles.data());
        LobeProblem bounds(rows, shape, false);
        const Eigen::VectorXd least = bounds.lower(at), most = bounds.upper(at);
        lower.assign(least.begin(), least.end()), upper.assign(most.begin(), most.end());
        const auto J = std::size_t(problem.shape.lobes);
        beta.resize(3 * J), gram.resize(J * J);
        problem.doubles = doubles.data(), problem.x = x.data(), problem.loss = &loss, problem.beta = beta.data();
        problem.gram = gram.data(), problem.lower = lower.data(), problem.upper = upper.data();
    }
    Emulated(const Emulated&) = delete;

    std::vector<double> x, doubles, lower, upper, beta, gram;
    std::vector<float> tile;
    double loss = 0;
    on_device::Memory memory{};
    on_device::Problem problem{};
    static constexpr on_device::Block block{};
};

LobeShape shape_of(PmForm form, bool axial, bool reciprocal, int variates) {
    LobeShape shape;
    shape.form = form, shape.axial = axial, shape.reciprocal = reciprocal, shape.variates = variates;
    return shape;
}

Eigen::VectorXd random_variables(const LobeShape& shape, int lobes, std::mt19937_64& random) {
    Lobes of = without_lobes(shape, 1, random);
    for (int j = 0; j < lobes; ++j) {
        const std::vector<double> lobe = random_lobe(random, of);
        of.weight.insert(of.weight.end(), lobe.begin(), lobe.end());
    }
    return pack(of);
}

/// Calls check(rows, shape, x, log peak limit) for random problems of every form.
template <typename Check> void for_problems(const Check& check) {
    const Observations all = observations(Objective::cosine);
    const Rows pairs(all), with_radiances(all, {.radiance_importance = 0.05});
    std::mt19937_64 random(5);
    for (const PmForm form : k_forms)
        for (const bool axial : {true, false})
            for (const bool reciprocal : {false, true})
                for (const int lobes : {2, 3, 7}) {
                    SCOPED_TRACE(
                        fmt::format("{} axial {} reciprocal {} lobes {}", name(form), axial, reciprocal, lobes));
                    const LobeShape shape = shape_of(form, axial, reciprocal, reciprocal ? 2 : 3);
                    const Eigen::VectorXd x = random_variables(shape, lobes, random);
                    // The second one bounds the coefficients.
                    for (const double log_peak_limit : {300.0, -12.0})
                        check(lobes % 2 == 1 ? with_radiances : pairs, shape, x, log_peak_limit);
                }
}

/// The loss, Hessian and gradient of the processor's own code.
struct Expected {
    Expected(const Rows& rows, const LobeShape& shape, const Eigen::VectorXd& x, double log_peak_limit) {
        LobeProblem problem(rows, shape, false, log_peak_limit);
        loss = problem.loss(x), beta = problem.beta();
        problem.linearise(x, H, g);
    }
    double loss;
    Eigen::MatrixXd beta, H;
    Eigen::VectorXd g;
};

/// The norm of A − B with row and column v divided by √scale_v, of which all but the smallest 1e-12 count, as for
/// damping.
double difference(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, const Eigen::VectorXd& scale) {
    const Eigen::VectorXd by = scale.cwiseMax(1e-12 * scale.maxCoeff()).cwiseSqrt().cwiseInverse();
    return (by.asDiagonal() * (A - B) * by.asDiagonal()).norm();
}

/// How much what the processor itself computes of `rows` depends on rounding, by off(rows): on the instruction set, and
/// on the last bit of the directions.
template <typename Off> double by_rounding(const Rows& rows, const Off& off) {
    double most = 0;
    for (const Target target : hwy::SupportedAndGeneratedTargets()) {
        const OneTarget one(target);
        most = std::max(most, off(rows));
    }
    std::mt19937_64 random(3);
    for (int k = 0; k < 10; ++k) {
        Rows moved = rows;
        for (auto* w : {&moved.wl, &moved.wv})
            for (auto& component : *w)
                for (float& value : component) value = std::nextafter(value, uniform(random) < 0.5 ? -2.f : 2.f);
        most = std::max(most, off(moved));
    }
    return most;
}

TEST(Cuda, features_are_those_of_the_problem) {
    constexpr double tolerance = 5e-6;  // the device fuses products and sums, the processor does not
    for_problems([&](const Rows& rows, const LobeShape& shape, const Eigen::VectorXd& x, double log_peak_limit) {
        if (shape.reciprocal) return;  // sums of these
        const Emulated of(rows, shape, x, log_peak_limit);
        const int C = shape.components();
        Aligned<float> s(std::size_t(shape.width()) * k_block), by_angle(3 * k_block);
        on_device::Row row;
        on_device::keep(of.block, of.problem.shape, of.memory, of.x.data());
        for (std::size_t block = 0; block < rows.blocks; ++block) {
            for (int n = 0; n < shape.variates; ++n)
                (shape.axial ? axial_feature : general_features)(rows, block, float(std::cos(x[n])),
                                                                 float(std::sin(x[n])),
                                                                 &s[std::size_t(n * C) * k_block], by_angle.data());
            if (features(shape.form) > 0)
                further_features(rows, block, features(shape.form), &s[std::size_t(shape.directional()) * k_block]);
            for (std::size_t i = 0; i < k_block; ++i) {
                if (!(rows.root_weight[block * k_block + i] > 0)) continue;
                on_device::features_of(of.problem.shape, of.problem.observed, of.memory, int(block * k_block + i), row);
                for (int k = 0; k < shape.width(); ++k) {
                    const double expected = s[std::size_t(k) * k_block + i];
                    EXPECT_TRUE(near(row.s[k], expected, tolerance * std::max(1.0, std::abs(expected)))) << k;
                }
            }
        }
    });
}

TEST(Cuda, loss_gradient_and_products_are_those_of_the_problem) {
    int limited = 0, not_adapting = 0, close = 0, count = 0;
    constexpr double allowed = 10;  // times by_rounding
    for_problems([&](const Rows& rows, const LobeShape& shape, const Eigen::VectorXd& x, double log_peak_limit) {
        const Expected expected(rows, shape, x, log_peak_limit);
        Emulated of(rows, shape, x, log_peak_limit);
        const auto& [memory, problem] = std::tie(of.memory, of.problem);
        const double found =
            on_device::loss(of.block, problem.shape, problem.observed, log_peak_limit, memory, of.x.data());
        EXPECT_TRUE(near(found, expected.loss, 1e-5 * expected.loss)) << found << ' ' << expected.loss;
        bool adapt = false;
        for (int j = 0; j < problem.shape.lobes; ++j)
            for (int c = 0; c < 3; ++c) {
                const bool is_limited = memory.beta[j * 3 + c] == memory.limit[j];
                limited += is_limited;
                adapt = adapt || (expected.beta(j, c) > 0 && !is_limited);
            }
        not_adapting += !adapt;
        on_device::linearise(of.block, problem.shape, problem.observed, memory, of.x.data());
        const Eigen::Index n = x.size();
        const Eigen::Map<const Eigen::MatrixXd> hessian(memory.hessian, n, n);
        const Eigen::Map<const Eigen::VectorXd> gradient(memory.gradient, n);
        // The scale of each variable: the sizes of the products of columns that its diagonal element is a sum of, which
        // cancel where coefficients adapt or follow their bounds.
        Eigen::VectorXd products = Eigen::VectorXd::Zero(n);
        for (int v = 0; v < int(n); ++v)
            for (int c = 0; c < 3; ++c)
                on_device::for_columns(problem.shape, memory, of.x.data(), c, v, [&](int i, double of_i) {
                    on_device::for_columns(problem.shape, memory, of.x.data(), c, v, [&](int k, double of_k) {
                        products[v] += std::abs(of_i * of_k * on_device::entry(memory, problem.shape.columns(), i, k));
                    });
                });
        EXPECT_GE(products.sum(), 0.99 * expected.H.trace());
        EXPECT_LE((gradient - expected.g).norm(), 1e-5 * std::sqrt(expected.loss * products.sum()));
        // Lobes of weights of 1e3 and more amplify the rounding of their features, and lobes that nearly coincide that
        // of their products; then the processor's own result depends as much on the instruction set and the last bits.
        const double off = difference(hessian, expected.H, products);
        close += off <= 1e-5, ++count;
        const auto off_on = [&](const Rows& others) {
            return difference(Expected(others, shape, x, log_peak_limit).H, expected.H, products);
        };
        EXPECT_TRUE(off <= 1e-5 || off <= allowed * by_rounding(rows, off_on)) << off;
    });
    EXPECT_GT(limited, 10);  // coefficients at their bounds are among them, and problems in which none adapts
    EXPECT_GT(not_adapting, 5);
    EXPECT_GE(close, count / 2);
}

TEST(Cuda, steps_reach_the_same_loss) {
    int count = 0, same = 0, close = 0;
    for_problems([&](const Rows& rows, const LobeShape& shape, const Eigen::VectorXd& start, double log_peak_limit) {
        if (log_peak_limit < 0 || start.size() > 40) return;  // the largest take most of the time
        LobeProblem problem(rows, shape, false, log_peak_limit);
        LevenbergMarquardtOptions options;
        options.max_iterations = 2;
        const auto reached = [&](LobeProblem& of) {
            Eigen::VectorXd x = start;
            return levenberg_marquardt(of, x, options).loss;
        };
        const double expected = reached(problem);
        Emulated of(rows, shape, start, log_peak_limit);
        of.problem.iterations = options.max_iterations, of.problem.target = options.target;
        on_device::levenberg_marquardt(of.block, of.problem, of.tile.data());
        EXPECT_LE(of.loss, (1 + 1e-6) * problem.loss(start));  // no step raises it
        // It is the loss of these numbers.
        const double loss = problem.loss(Eigen::Map<Eigen::VectorXd>(of.x.data(), start.size()));
        EXPECT_TRUE(near(loss, of.loss, 1e-5 * of.loss)) << of.loss;
        // Where lobes nearly coincide rounding decides which way a step goes.
        const double off = std::abs(of.loss - expected) / expected;
        const auto off_on = [&](const Rows& others) {
            LobeProblem other(others, shape, false, log_peak_limit);
            return std::abs(reached(other) - expected) / expected;
        };
        close += off < 1e-3, ++count;
        same += off < 1e-3 || off <= 2 * by_rounding(rows, off_on);
    });
    EXPECT_GE(close, count - count / 4);
    EXPECT_GE(same, count - count / 10);
}

TEST(Cuda, the_same_candidates_are_best) {
    for_problems([&](const Rows& rows, const LobeShape& shape, const Eigen::VectorXd& x, double log_peak_limit) {
        if (log_peak_limit < 0) return;
        std::mt19937_64 random(9);
        LobeProblem problem(rows, shape, false, log_peak_limit);
        problem.loss(x);
        std::vector<std::vector<double>> candidates;
        std::vector<float> weights;
        for (int k = 0; k < 40; ++k) {
            candidates.push_back(random_lobe(random, unpack(x, shape)));
            weights.insert(weights.end(), candidates.back().begin(), candidates.back().end());
        }
        Emulated of(rows, shape, x, log_peak_limit);
        const std::size_t stride = std::size_t(of.problem.shape.of_candidate());
        std::vector<double> gain(40 * stride);
        of.problem.candidates = weights.data(), of.problem.candidate_count = 40, of.problem.gain = gain.data();
        on_device::gains_of_additions(of.block, of.problem, of.tile.data());
        std::size_t best = 0;
        for (std::size_t k = 1; k < 40; ++k)
            if (gain[k * stride] > gain[best * stride]) best = k;
        EXPECT_EQ(candidates[best], problem.best_addition(candidates));
    });
}

TEST(Cuda, searches_in_batches_find_fits_as_good) {
    const Observations first = beginning(observations(), 1024);
    Observations second = first;
    for (Rgb& f : second.f) f = {0.5f * f.g, 2 * f.r, f.b};
    FitOptions options;
    options.lobes = 3, options.variates = 2, options.starts = 3, options.perturbations = 4, options.threads = 1;
    const Observations* const both[] = {&first, &second};
    const auto fits = fit_pm(both, options, Where::emulated);
    ASSERT_TRUE(fits) << message(fits.error());
    const auto again = fit_pm(std::span(both).last(1), options, Where::emulated);
    ASSERT_TRUE(again);
    EXPECT_EQ(again->front().model, (*fits)[1].model);  // whatever else is in the batch
    for (std::size_t i = 0; i < 2; ++i) {
        const auto expected = fit_pm(*both[i], options);
        ASSERT_TRUE(expected);
        EXPECT_LT((*fits)[i].loss, 1.5 * expected->loss);
    }
}

TEST(Cuda, without_a_device_the_error_says_so) {
    if (cuda_device()) GTEST_SKIP() << "there is a device";
    FitOptions options;
    options.device = Device::cuda;
    const auto fit = fit_pm(beginning(observations(), 1024), options);
    ASSERT_FALSE(fit);
    EXPECT_TRUE(
        message(fit.error()).starts_with("cuda: device: expected one of compute capability 7.5 or more, found "))
        << message(fit.error());
}

}  // namespace
}  // namespace srbf::cuda_test
