// The lobes of one view as a least-squares problem: its loss and derivatives.
#include "models/su/view_problem.h"

#include "base/levenberg_marquardt.h"
#include "properties.h"

namespace srbf::view_problem_test {
namespace {

/// Three lobes in three colours on directions of the hemisphere, of which one in ten was not measured; with two lights.
ViewRows rows(bool with_lights) {
    constexpr int count = 900;
    const std::vector<Vec3f> directions = fibonacci_directions(count, 85 * k_degree);
    ViewRows rows;
    rows.directions = DirectionRows(directions);
    rows.scale = 0.4;
    rows.root_weight.assign(rows.directions.blocks * k_block, 0.f);
    for (auto& y : rows.y) y.assign(rows.root_weight.size(), 0.f);
    rows.lights.assign(with_lights ? 2 : 0, Aligned<float>(rows.root_weight.size(), 0.f));
    for (std::size_t i = 0; i < count; ++i) {
        if (i % 10 == 3) continue;
        const Vec3f w = directions[i];
        const auto root = float(std::sqrt(w.z / count));
        rows.root_weight[i] = root;
        const float lobes[] = {elementary::exp(30 * (0.6f * w.x + 0.8f * w.z - 1)), elementary::exp(4 * (w.z - 1)),
                               0.2f + w.y * w.y};
        for (std::size_t c = 0; c < 3; ++c) rows.y[c][i] = root * (lobes[c] + 0.5f * lobes[(c + 1) % 3]);
        for (std::size_t k = 0; k < rows.lights.size(); ++k)
            rows.lights[k][i] = w.z * (k == 0 ? 1.f : elementary::exp(3 * (w.x - 1))) / (100 * root);
    }
    rows.view = {-0.8f, 0.6f, 0};
    rows.largest.fill(100);
    rows.least_cosine = 0.04;
    return rows;
}

const std::vector<ViewLobe> k_lobes{{normalize(Vec3d{0.5, 0.1, 0.8}), 20}, {normalize(Vec3d{-0.1, 0.3, 1}), 2}};

TEST(ViewProblem, LossCountsPairsAndRadiances) {
    const ViewRows view = rows(true);
    ViewProblem problem(2);
    const double loss = problem.loss(problem.start(view, k_lobes));
    const auto coefficient = problem.coefficients();
    double expected = 0;
    for (int c = 0; c < 3; ++c) {
        double off[2]{};
        for (std::size_t i = 0; i < view.root_weight.size(); ++i) {
            double rest = double(view.y[std::size_t(c)][i]);
            for (int j = 0; j < 2; ++j) {
                const auto& [centre, bandwidth, shape] = k_lobes[std::size_t(j)];
                const double cosine = view.directions.w[0][i] * centre.x + view.directions.w[1][i] * centre.y +
                                      view.directions.w[2][i] * centre.z;
                rest -= double(view.root_weight[i]) * coefficient[std::size_t(j)][std::size_t(c)] / view.scale *
                        elementary::exp(bandwidth * (cosine - 1) - shape * (1 / double(view.directions.w[2][i]) - 1));
            }
            expected += rest * rest;
            for (std::size_t k = 0; k < 2; ++k) off[k] += double(view.lights[k][i]) * rest;
        }
        expected += off[0] * off[0] + off[1] * off[1];
    }
    EXPECT_TRUE(near_relative(loss, expected, 1e-3));
    const ViewRows without = rows(false);
    EXPECT_LT(problem.loss(problem.start(without, k_lobes)), loss);
}

/// Whether the gradient at x is that of the loss, by differences, within a share of its length and of the loss.
void expect_gradient(ViewProblem& problem, const Eigen::VectorXd& x, double of_length, double of_loss) {
    Eigen::MatrixXd H;
    Eigen::VectorXd g;
    const double loss = problem.loss(x);
    problem.linearise(x, H, g);
    for (Eigen::Index i = 0; i < x.size(); ++i) {
        constexpr double step = 1e-3;
        Eigen::VectorXd more = x, less = x;
        more[i] += step, less[i] -= step;
        const double difference = (problem.loss(more) - problem.loss(less)) / (2 * step);
        EXPECT_TRUE(near(2 * g[i], difference, of_length * 2 * g.norm() + of_loss * loss)) << "variable " << i;
    }
}

TEST(ViewProblem, GradientIsThatOfTheLoss) {
    for (const bool with_lights : {false, true}) {
        const ViewRows view = rows(with_lights);
        ViewProblem problem(2);
        expect_gradient(problem, problem.start(view, k_lobes), 0.01, 0);
    }
}

/// With pixels: every seventh direction, under a light that lets some of them clip.
ViewRows rows_with_pixels() {
    ViewRows view = rows(true);
    std::vector<Vec3f> towards;
    std::vector<Pixels::Triplet> colours;
    view.pixels.exposure.assign(k_block, 0.f);
    for (std::size_t i = 0; i < 900; i += 7) {
        if (i % 10 == 3) continue;
        const double exposure = 0.8;
        Pixels::Triplet colour;
        for (std::size_t c = 0; c < 3; ++c) colour[c] = exposure * double(view.y[c][i]) / double(view.root_weight[i]);
        towards.push_back({view.directions.w[0][i], view.directions.w[1][i], view.directions.w[2][i]});
        view.pixels.exposure[colours.size()] = float(exposure);
        colours.push_back(colour);
    }
    view.pixels.directions = DirectionRows(towards);
    view.pixels.reference = Pixels(colours);
    return view;
}

const std::vector<ViewLobe> k_bent{{normalize(Vec3d{0.5, 0.1, 0.8}), 20, 0.4}, {normalize(Vec3d{-0.1, 0.3, 1}), 2, 2}};
const std::vector<ViewLobe> k_narrowed{{normalize(Vec3d{0.5, 0.1, 0.8}), 20, -3},
                                       {normalize(Vec3d{-0.1, 0.3, 1}), 2, 2}};

TEST(ViewProblem, GradientOfShapedLobesIsThatOfTheLoss) {
    const ViewRows view = rows(true);
    for (const auto* lobes : {&k_bent, &k_narrowed}) {
        ViewProblem problem(2, true);
        const Eigen::VectorXd x = problem.start(view, *lobes);
        expect_gradient(problem, x, 0, 2e-3);
        EXPECT_EQ(problem.lobes(x)[1].shape, 2);
    }
}

// The derivative by a shape jumps at 0. Shapes of the wrong sign do not keep the other variables from the minimum, and
// the next fit tries the other side.
TEST(ViewProblem, ShapesPassThroughZeroFromFitToFit) {
    ViewRows view = rows(false);
    for (std::size_t i = 0; i < view.root_weight.size(); ++i)
        for (auto& y : view.y)
            y[i] = view.root_weight[i] *
                   elementary::exp(20 * (0.6f * view.directions.w[0][i] + 0.8f * view.directions.w[2][i] - 1) -
                                   0.5f * view.directions.slant[i]);
    ViewProblem problem(1, true);
    std::vector<ViewLobe> lobes{{normalize(Vec3d{0.5, 0.1, 0.8}), 10, -0.3}};
    const auto fit = [&] {
        Eigen::VectorXd x = problem.start(view, lobes);
        const double loss = levenberg_marquardt(problem, x, LevenbergMarquardtOptions{}).loss;
        lobes = problem.lobes(x);
        return loss;
    };
    const double narrowed = fit();
    EXPECT_EQ(lobes[0].shape, 0);
    EXPECT_FALSE(std::signbit(lobes[0].shape));
    EXPECT_LT(fit(), 1e-3 * narrowed);
    EXPECT_NEAR(lobes[0].bandwidth, 20, 1e-2);
    EXPECT_NEAR(lobes[0].shape, 0.5, 1e-3);
}

/// What a pixel costs if all of them cost `importance` times the loss of pairs for these lobes.
double share_of(ViewProblem& problem, const ViewRows& view, const std::vector<ViewLobe>& lobes, double importance) {
    const Eigen::VectorXd x = problem.start(view, lobes);
    const double loss = problem.loss(x);
    return importance * loss / problem.pixel_errors(x);
}

TEST(ViewProblem, PixelsCostAtMostTheirShare) {
    const ViewRows view = rows_with_pixels();
    ViewProblem problem(2, true);
    const double share = share_of(problem, view, k_bent, 3);
    const double loss = problem.loss(problem.start(view, k_bent));
    const Eigen::VectorXd x = problem.start(view, k_bent, share);
    const double with_pixels = problem.loss(x);  // coefficients adapt to them
    EXPECT_GT(with_pixels, loss);
    EXPECT_LT(with_pixels, 4 * loss);
    // Pairs for coefficients that they alone would not have, and pixels.
    EXPECT_GT(with_pixels, loss + share * problem.pixel_errors(x));
    EXPECT_LE(problem.loss(x), with_pixels * (1 + 1e-6));
}

TEST(ViewProblem, GradientWithPixelsIsThatOfTheLoss) {
    const ViewRows view = rows_with_pixels();
    ViewProblem problem(2, true);
    for (const auto* lobes : {&k_bent, &k_narrowed}) {
        const double share = share_of(problem, view, *lobes, 3);
        const Eigen::VectorXd x = problem.start(view, *lobes, share);
        problem.loss(x);
        expect_gradient(problem, x, 0, 1e-2);
    }
}

TEST(ViewProblem, StepsWithPixelsLowerTheLoss) {
    const ViewRows view = rows_with_pixels();
    ViewProblem problem(2, true);
    const double share = share_of(problem, view, k_bent, 3);
    Eigen::VectorXd x = problem.start(view, k_bent, share);
    const double before = problem.loss(x);
    const auto summary = levenberg_marquardt(problem, x, {.max_iterations = 4, .adapts_to_bounds = true});
    EXPECT_LT(summary.loss, 0.95 * before);
    for (const auto& of_lobe : problem.coefficients())
        for (const double beta : of_lobe) EXPECT_GE(beta, 0);
}

}  // namespace
}  // namespace srbf::view_problem_test
