// The inner loops of fits, compared with plain loops for every instruction set of this machine.
#include "models/pm/solve/packed_observations.h"
#include "models/pm/solve/simd_columns.h"

#include "observe/observations.h"
#include "one_target.h"
#include "properties.h"
#include "srbf/kernel.h"
#include "srbf/models/pm.h"

namespace srbf::inner_loops_test {
namespace {

constexpr std::size_t k_count = 2 * k_block + 300, k_bound_pairs = 7;

/// Two full blocks and part of a third. Some weights are 0.
Observations random_observations() {
    std::mt19937_64 random(1);
    Observations observations;
    observations.bound_pairs = k_bound_pairs;
    for (std::size_t i = 0; i < k_count + k_bound_pairs; ++i) {
        observations.wl.push_back(to_float(random_direction(random)));
        observations.wv.push_back(to_float(random_direction(random)));
        observations.f.push_back({float(uniform(random)), float(uniform(random)), float(uniform(random))});
        observations.weight.push_back(i % 10 == 3 ? 0 : float(uniform(random)));
    }
    return observations;
}

Aligned<float> column(std::mt19937_64& random, double low = 0, double high = 1) {
    Aligned<float> numbers(k_block);
    for (float& x : numbers) x = float(low + (high - low) * uniform(random));
    return numbers;
}

std::vector<const float*> pointers(const std::vector<Aligned<float>>& columns) {
    std::vector<const float*> pointers;
    for (const auto& column : columns) pointers.push_back(column.data());
    return pointers;
}

std::vector<Aligned<float>> random_columns(std::mt19937_64& random, std::size_t count) {
    std::vector<Aligned<float>> columns;
    for (std::size_t j = 0; j < count; ++j) columns.push_back(column(random, -0.5, 1));
    return columns;
}

/// Expects that the product of two columns was added to `before`.
void expect_added_product(double found, double before, const Aligned<float>& a, const Aligned<float>& b) {
    double sum = before, size = 0;
    for (std::size_t i = 0; i < k_block; ++i) {
        const double product = double(a[i]) * double(b[i]);
        sum += product;
        size += std::abs(product);
    }
    EXPECT_WITHIN(found, sum, 3e-6 * size);
}

/// Each test runs once per instruction set.
class InnerLoops : public testing::TestWithParam<Target> {
  protected:
    const OneTarget target_{GetParam()};
    const Observations observations_ = random_observations();
    const PackedObservations rows_{observations_};
    std::mt19937_64 random_{2};
};
INSTANTIATE_TEST_SUITE_P(EachTarget, InnerLoops, testing::ValuesIn(hwy::SupportedAndGeneratedTargets()),
                         [](const auto& target) { return std::string(hwy::TargetName(target.param)); });

TEST_P(InnerLoops, RowsContainTheObservationsWithoutBoundPairs) {
    ASSERT_EQ(rows_.blocks, 3u);
    for (std::size_t i = 0; i < 3 * k_block; ++i) {
        const Vec3f wl(rows_.wl[0][i], rows_.wl[1][i], rows_.wl[2][i]),
            wv(rows_.wv[0][i], rows_.wv[1][i], rows_.wv[2][i]);
        if (i < k_count) {
            EXPECT_EQ(wl, observations_.wl[i]);
            EXPECT_EQ(wv, observations_.wv[i]);
            const double root = std::sqrt(observations_.weight[i]);
            EXPECT_WITHIN_RELATIVE(rows_.root_weight[i], rows_.scale * root, 1e-6);
            for (int c = 0; c < 3; ++c)
                EXPECT_WITHIN_RELATIVE(rows_.y[std::size_t(c)][i], root * double(observations_.f[i][c]), 1e-6);
        } else {
            EXPECT_WITHIN(dot(wl, wl), 1, 1e-6);
            EXPECT_WITHIN(dot(wv, wv), 1, 1e-6);
            EXPECT_EQ(rows_.root_weight[i], 0);
            for (int c = 0; c < 3; ++c) EXPECT_EQ(rows_.y[std::size_t(c)][i], 0);
        }
    }
    Observations few = observations_;
    few.bound_pairs = few.f.size() - k_block;
    EXPECT_EQ(PackedObservations(few).blocks, 1u);
    few.bound_pairs -= 1;
    EXPECT_EQ(PackedObservations(few).blocks, 2u);
    few.bound_pairs = few.f.size();
    EXPECT_EQ(PackedObservations(few).blocks, 0u);
}

TEST_P(InnerLoops, WeightsOfRowsSumToOne) {
    double sum = 0;
    for (const float root : rows_.root_weight) sum += double(root) * double(root);
    EXPECT_WITHIN(sum, 1, 1e-5);
}

TEST_P(InnerLoops, AxialFeatureIsTheExponentOfAKernelAtTheNormal) {
    using K = Kernel<double>;
    for (int trial = 0; trial < 20; ++trial) {
        const double angle = 2 * k_pi * uniform(random_), h = 1e-5;
        Aligned<float> s(k_block), derivative(k_block);
        for (std::size_t block = 0; block < 3; ++block) {
            variate_features(rows_, block, 0, float(std::cos(angle)), float(std::sin(angle)), true, s.data(),
                             derivative.data());
            for (std::size_t i = 0; i < k_block && block * k_block + i < k_count; ++i) {
                const Vec3d wl = to_double(observations_.wl[block * k_block + i]),
                            wv = to_double(observations_.wv[block * k_block + i]);
                const auto psi = [&](double t) { return K::psi(wl, wv, std::cos(t), std::sin(t)); };
                const Vec3d d = std::cos(angle) * wl + std::sin(angle) * wv;
                const double steepness = 1 / std::sqrt(dot(d, d));
                EXPECT_WITHIN(s[i], K::gaussian_exponent(psi(angle), {0, 0, 1}, 1), 1e-6 * (1 + steepness));
                EXPECT_WITHIN(s[i], psi(angle).z - 1, 1e-6 * (1 + steepness));
                EXPECT_WITHIN(derivative[i], K::psi_by_angle(wl, wv, std::cos(angle), std::sin(angle)).z,
                              1e-6 * steepness * steepness);
                const double difference = (psi(angle + h).z - psi(angle - h).z) / (2 * h);
                EXPECT_WITHIN(derivative[i], difference, 1e-6 * std::pow(steepness, 3));
            }
        }
    }
}

TEST_P(InnerLoops, GeneralFeaturesMatchTheKernel) {
    using K = Kernel<double>;
    const double a = std::cos(0.4), b = std::sin(0.4);
    Aligned<float> s(3 * k_block), derivative(3 * k_block);
    for (std::size_t block = 0; block < 6; ++block) {
        const std::size_t first = block / 2 * k_block;
        const bool is_exchanged = block % 2 == 1;
        variate_features(rows_, block / 2, int(is_exchanged), float(a), float(b), false, s.data(), derivative.data());
        for (std::size_t i = 0; i < k_block && first + i < k_count; ++i) {
            Vec3d wl = to_double(observations_.wl[first + i]), wv = to_double(observations_.wv[first + i]);
            if (is_exchanged) std::swap(wl, wv);
            const Vec3d psi = K::psi(wl, wv, a, b), psi_derivative = K::psi_by_angle(wl, wv, a, b);
            const double expected[] = {psi.x, psi.y, psi.z - 1, psi_derivative.x, psi_derivative.y, psi_derivative.z};
            for (std::size_t k = 0; k < 3; ++k) {
                EXPECT_WITHIN(s[k * k_block + i], expected[k], 2e-6);
                EXPECT_WITHIN(derivative[k * k_block + i], expected[3 + k], 4e-6);
            }
        }
    }
}

TEST_P(InnerLoops, FurtherFeaturesMatchTheKernel) {
    for (const PmForm form : k_forms) {
        const int count = features(form);
        Aligned<float> x(std::size_t(count) * k_block);
        for (std::size_t block = 0; block < 3; ++block) {
            further_features(rows_, block, count, x.data());
            for (std::size_t i = 0; i < k_block && block * k_block + i < k_count; ++i) {
                const auto expected =
                    Kernel<double>::pm_further_features(count, to_double(observations_.wl[block * k_block + i]),
                                                        to_double(observations_.wv[block * k_block + i]));
                for (std::size_t k = 0; k < std::size_t(count); ++k) {
                    const double tolerance = k == 0 ? 2e-5 * (1 + std::abs(expected.x[k])) : 1e-6;
                    EXPECT_WITHIN(x[k * k_block + i], expected.x[k], tolerance) << k;
                }
            }
        }
    }
}

TEST_P(InnerLoops, ExponentIsTheWeightedSumAndItsMaximumSkipsWeightsOfZero) {
    for (const std::size_t variates : {1u, 3u, 8u}) {
        std::vector<Aligned<float>> s;
        std::vector<float> weight;
        for (std::size_t n = 0; n < variates; ++n) {
            s.push_back(column(random_, -2, 0));
            weight.push_back(float(40 * uniform(random_)));
        }
        // The largest sums are in rows of weight 0.
        for (std::size_t block = 0; block < 3; ++block) {
            auto columns = s;
            for (auto& c : columns)
                for (std::size_t i = 0; i < k_block; ++i)
                    if (rows_.root_weight[block * k_block + i] == 0) c[i] = 1;
            Aligned<float> x(k_block);
            const float largest = exponent(weight, pointers(columns), &rows_.root_weight[block * k_block], x.data(),
                                           rows_.rows_in(block));
            double expected_largest = -INFINITY;
            for (std::size_t i = 0; i < rows_.rows_in(block); ++i) {
                double sum = 0, size = 0;
                for (std::size_t n = 0; n < variates; ++n) {
                    sum += double(weight[n]) * double(columns[n][i]);
                    size += std::abs(double(weight[n]) * double(columns[n][i]));
                }
                EXPECT_WITHIN(x[i], sum, 1e-6 * size);
                if (rows_.root_weight[block * k_block + i] > 0)
                    expected_largest = std::max(expected_largest, double(x[i]));
            }
            EXPECT_EQ(double(largest), expected_largest);
        }
    }
    // A block whose weights are all 0.
    Observations idle = observations_;
    std::fill(idle.weight.begin(), idle.weight.end(), 0.f);
    const auto s = column(random_);
    const float* const columns[] = {s.data()};
    Aligned<float> x(k_block);
    EXPECT_EQ(exponent(std::vector{1.f}, columns, PackedObservations(idle).root_weight.data(), x.data(), k_block),
              std::numeric_limits<float>::lowest());
}

TEST_P(InnerLoops, ExponentiateSubtractsTheOffset) {
    for (const float offset : {0.f, -30.f, 80.f}) {
        const auto exponents = column(random_, -90, 0);
        for (std::size_t block = 0; block < 3; ++block) {
            Aligned<float> x(k_block);
            for (std::size_t i = 0; i < k_block; ++i) {
                const bool has_weight = rows_.root_weight[block * k_block + i] > 0;
                // Rows of weight 0 may have any exponent.
                x[i] = offset + (has_weight ? exponents[i] : 100.f * float(i));
            }
            const auto input = x;
            exponentiate(x.data(), &rows_.root_weight[block * k_block], offset, x.data(), rows_.rows_in(block));
            for (std::size_t i = 0; i < rows_.rows_in(block); ++i) {
                const double root = double(rows_.root_weight[block * k_block + i]);
                const double expected = root > 0 ? root * std::exp(double(input[i]) - double(offset)) : 0;
                const double size = std::abs(double(input[i]) - double(offset));
                EXPECT_WITHIN(x[i], expected, 3e-7 * (1 + size / 2) * expected + 0x1p-93) << input[i];
            }
        }
    }
}

TEST_P(InnerLoops, MultiplyAndResidualMatchTheirFormulas) {
    const auto a = column(random_, -1, 1), b = column(random_, -1, 1);
    Aligned<float> product(k_block);
    multiply(a.data(), b.data(), product.data());
    for (std::size_t i = 0; i < k_block; ++i) EXPECT_EQ(product[i], a[i] * b[i]);

    for (const std::size_t lobes : {0u, 1u, 7u}) {
        std::vector<Aligned<float>> columns;
        std::vector<float> beta;
        for (std::size_t j = 0; j < lobes; ++j) {
            columns.push_back(column(random_));
            beta.push_back(float(3 * uniform(random_)));
        }
        Aligned<float> r(k_block);
        const double sum = residual(a.data(), beta, pointers(columns), r.data());
        double squares = 0;
        for (std::size_t i = 0; i < k_block; ++i) {
            double difference = double(a[i]);
            for (std::size_t j = 0; j < lobes; ++j) difference -= double(beta[j]) * double(columns[j][i]);
            EXPECT_WITHIN(r[i], difference, 1e-6 * double(lobes + 1));
            squares += difference * difference;
        }
        EXPECT_WITHIN_RELATIVE(sum, squares, 1e-5);
    }
}

TEST_P(InnerLoops, AddProductsAddsProductsOfRowsAndColumns) {
    for (const std::size_t m : {1u, 4u, 7u})
        for (const std::size_t n : {1u, 3u, 8u}) {
            const auto rows = random_columns(random_, m), columns = random_columns(random_, n);
            std::vector<double> G(m * n, 0.5);
            add_products(pointers(rows), pointers(columns), G.data());
            for (std::size_t i = 0; i < m; ++i)
                for (std::size_t k = 0; k < n; ++k) expect_added_product(G[i * n + k], 0.5, rows[i], columns[k]);
        }
}

TEST_P(InnerLoops, AddGramAddsProductsUpToTheDiagonal) {
    for (std::size_t n = 1; n <= 30; ++n) {
        const auto columns = random_columns(random_, n);
        std::vector<double> G(n * n);
        for (double& x : G) x = uniform(random_);
        const std::vector<double> before = G;
        add_gram(pointers(columns), G.data());
        for (std::size_t i = 0; i < n; ++i)
            for (std::size_t k = 0; k < n; ++k)
                if (k <= i)
                    expect_added_product(G[i * n + k], before[i * n + k], columns[i], columns[k]);
                else
                    EXPECT_EQ(G[i * n + k], before[i * n + k]) << n << ' ' << i << ' ' << k;
    }
    std::vector<double> none;
    add_gram({}, none.data());
}

/// The results of all loops for one set of random columns.
std::vector<double> all_results(const PackedObservations& rows) {
    constexpr std::size_t k_columns = 13;     // no multiple of a vector's width
    constexpr std::size_t k_gram_rows = 448;  // fewer than a block has
    std::mt19937_64 random(3);
    const auto columns = random_columns(random, k_columns);
    const auto pointers_to = pointers(columns);
    const std::vector<float> weight(k_columns, 0.3f);
    std::vector<double> results;
    const auto add = [&](const auto& numbers) { results.insert(results.end(), numbers.begin(), numbers.end()); };
    Aligned<float> x(k_block), s(3 * k_block), derivatives(3 * k_block), further(SRBF_TERMS * k_block);
    const auto add_features = [&](std::size_t block, int exchanged, float b, bool axial) {
        variate_features(rows, block, exchanged, 0.6f, b, axial, s.data(), derivatives.data());
        add(s);
        add(derivatives);
    };
    add_features(0, 0, -0.8f, true);
    add_features(1, 1, 0.8f, false);
    further_features(rows, 0, SRBF_TERMS, further.data());
    add(further);
    const float* const root_weight = &rows.root_weight[k_block];
    results.push_back(exponent(weight, pointers_to, root_weight, x.data(), rows.rows_in(1)));
    add(x);
    exponentiate(x.data(), root_weight, 5, x.data(), rows.rows_in(1));
    add(x);
    results.push_back(residual(columns[0].data(), weight, pointers_to, x.data()));
    add(x);
    results.push_back(sum(x.data()));
    results.push_back(sum_of_squares(x.data()));
    std::vector<double> G(k_columns * k_columns);
    add_gram(pointers_to, G.data(), k_gram_rows);
    add(G);
    add_products(pointers_to, pointers_to, G.data());
    add(G);
    return results;
}

TEST(InnerLoops, LoopsHaveTheSameBitsWithAllInstructionSets) {
    const PackedObservations rows(random_observations());
    const auto expected = all_results(rows);
    for (const Target target : hwy::SupportedAndGeneratedTargets()) {
        const OneTarget one(target);
        EXPECT_TRUE(all_results(rows) == expected) << hwy::TargetName(target);
    }
}

}  // namespace
}  // namespace srbf::inner_loops_test
