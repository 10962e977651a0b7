// The lobes of one view as a least-squares problem: its loss and derivatives.
#include "models/su/view_problem.h"

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
    rows.largest.fill(100);
    rows.min_cosine = 0.04;
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
                const auto& [centre, bandwidth] = k_lobes[std::size_t(j)];
                const double cosine = view.directions.w[0][i] * centre.x + view.directions.w[1][i] * centre.y +
                                      view.directions.w[2][i] * centre.z;
                rest -= double(view.root_weight[i]) * coefficient[std::size_t(j)][std::size_t(c)] / view.scale *
                        elementary::exp(bandwidth * (cosine - 1));
            }
            expected += rest * rest;
            for (std::size_t k = 0; k < 2; ++k) off[k] += double(view.lights[k][i]) * rest;
        }
        expected += off[0] * off[0] + off[1] * off[1];
    }
    EXPECT_WITHIN_RELATIVE(loss, expected, 1e-3);
    const ViewRows without = rows(false);
    EXPECT_LT(problem.loss(problem.start(without, k_lobes)), loss);
}

/// Expects that the gradient at x is that of the loss, by differences.
void expect_gradient(ViewProblem& problem, const Eigen::VectorXd& x) {
    Eigen::MatrixXd H;
    Eigen::VectorXd g;
    problem.loss(x);
    problem.linearise(x, H, g);
    for (Eigen::Index i = 0; i < x.size(); ++i) {
        constexpr double step = 1e-3;
        Eigen::VectorXd more = x, less = x;
        more[i] += step;
        less[i] -= step;
        const double difference = (problem.loss(more) - problem.loss(less)) / (2 * step);
        EXPECT_WITHIN(2 * g[i], difference, 0.01 * 2 * g.norm()) << "variable " << i;
    }
}

TEST(ViewProblem, GradientIsThatOfTheLoss) {
    for (const bool with_lights : {false, true}) {
        const ViewRows view = rows(with_lights);
        ViewProblem problem(2);
        expect_gradient(problem, problem.start(view, k_lobes));
    }
}

}  // namespace
}  // namespace srbf::view_problem_test
