// A fit may exceed the measurement between the pairs it was fitted to. Such pairs are found and added to the
// observations.
#include "observe/excess.h"

#include "brdf/directions.h"
#include "brdf_functions.h"
#include "models/pm/search/subsets.h"
#include "observe/observations.h"
#include "observe/pairs.h"
#include "properties.h"

namespace srbf::excess_test {
namespace {

Observations lambertian_observations() {
    return *observe(constant_brdf({0.3f, 0.3f, 0.3f}), {Objective::cosine, 0, 1 << 16, 4});
}

/// A constant, and a lobe of 1e6 about grazing directions of light and viewer, both at one azimuth.
PmModel with_spike() {
    PmModel model;
    model.form = PmForm::gaussian;
    model.axial = false;
    model.lobes = model.variates = 2;
    model.parameterization = {{1, 0}, {0, 1}};
    model.centre = {{0, 0, 1}, {0, 0, 1}, {1, 0, 0}, {1, 0, 0}};
    model.bandwidth = {0, 0, 30, 30};
    model.coefficient = {{0.3f, 0.3f, 0.3f}, {1e6f, 1e6f, 1e6f}};
    model.log_scale = {0, 0};
    return model;
}

TEST(Excess, PairsThatExceedTheMeasurementAreFound) {
    const Observations o = lambertian_observations();
    const double largest = largest_measured(o);
    EXPECT_WITHIN(largest, 0.3, 1e-3);  // at the normal
    const std::vector<std::size_t> where = exceeded_pairs(o, 4096, with_spike(), largest);
    ASSERT_FALSE(where.empty());
    std::size_t next = 0, expected = 0;
    for (std::size_t i = 4096; i < o.f.size(); ++i) {
        const double f = double(value(with_spike(), o.wl[i], o.wv[i]).r) * double(o.wl[i].z) * double(o.wv[i].z);
        if (std::abs(f / (1.6 * largest) - 1) < 1e-3) continue;  // at the threshold, rounding decides
        if (f < 1.6 * largest) continue;
        ++expected;
        while (next < where.size() && where[next] < i) ++next;
        ASSERT_LT(next, where.size());
        EXPECT_EQ(where[next], i);
    }
    EXPECT_GE(where.size(), expected);
}

TEST(Excess, PairsBecomeObservationsAndThenWeighMore) {
    Observations o = lambertian_observations();
    const std::size_t first = o.fitted_count(), bound_pairs = o.bound_pairs;
    const std::size_t taken = promote_exceeded_pairs(o, first, with_spike(), 0.01);
    ASSERT_GT(taken, 0u);
    EXPECT_EQ(o.bound_pairs, bound_pairs - taken);
    const double largest = largest_measured(o);
    std::vector<double> weight;
    for (std::size_t i = first; i < first + taken; ++i) {
        const auto cosine = [](float z) { return std::max(double(z), k_grazing_cosine); };
        EXPECT_GT(double(value(with_spike(), o.wl[i], o.wv[i]).r) * cosine(o.wl[i].z) * cosine(o.wv[i].z),
                  1.6 * largest * (1 - 1e-5));
        EXPECT_WITHIN_RELATIVE(o.weight[i], bound_weight(o, i, 0.01, largest), 1e-12);
        weight.push_back(o.weight[i]);
    }
    EXPECT_EQ(promote_exceeded_pairs(o, first, with_spike(), 0.01), taken);
    EXPECT_EQ(o.bound_pairs, bound_pairs - taken);
    for (std::size_t i = 0; i < taken; ++i) EXPECT_EQ(o.weight[first + i], 4 * weight[i]);
}

// The search's subsets grow only by pairs at which a candidate exceeds the measurement.
TEST(Subsets, GrowByPairsAtWhichCandidatesExceedTheMeasurement) {
    const Observations o = lambertian_observations();
    const PmFitOptions options{.form = PmForm::gaussian, .axial = false, .lobes = 1, .variates = 1};
    Subsets subsets(o);
    const auto rows = [&] { return subsets.rows(RowSet::search, {.albedos = false}).wl[0].size(); };
    const std::size_t before = rows();
    const auto rows_after_adding = [&](Vec3d p) {
        const Candidate candidate{.lobes = {shape_of(options), {0}, {p.x, p.y, p.z}}, .loss = 1};
        subsets.add_exceeded_pairs({candidate}, shape_of(options));
        return rows();
    };
    EXPECT_EQ(rows_after_adding({0, 0, 0}), before);        // the constant
    EXPECT_WITHIN(subsets.integral_importance(), 0, 1e-6);  // which leaves no loss
    // A lobe of a quarter of a degree, as large as the constant where it is seen first, a degree from its centre.
    EXPECT_GT(rows_after_adding(60000.0 * spherical(0.7, 1.3)), before);
    EXPECT_WITHIN(subsets.integral_importance(), 0.004 / 0.03, 1e-6);  // no more than a loss of 0.004 counts
}

}  // namespace
}  // namespace srbf::excess_test
