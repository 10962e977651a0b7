// The von Mises-Fisher distribution of kernel.glsl: density, sampler, and their agreement.
#include "properties.h"
#include "srbf/kernel.h"
#include "statistics.h"

namespace srbf::vmf_test {
namespace {

template <typename Real> class VmfOf : public testing::Test {
  protected:
    static Vec3<Real> convert(Vec3d w) { return {Real(w.x), Real(w.y), Real(w.z)}; }
    static Vec3d sample(Vec3d centre, double bandwidth, double u1, double u2) {
        const auto w = Kernel<Real>::sample_vmf(convert(centre), Real(bandwidth), Real(u1), Real(u2));
        return {double(w.x), double(w.y), double(w.z)};
    }
    static double pdf(Vec3d w, Vec3d centre, double bandwidth) {
        return double(Kernel<Real>::vmf_pdf(convert(w), convert(centre), Real(bandwidth)));
    }
    /// u in [0, 1), also after rounding to Real.
    double draw() { return std::min(uniform(random), 1 - double(std::numeric_limits<Real>::epsilon())); }
    std::mt19937_64 random{3};
};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(VmfOf, Reals);

const std::vector<double> k_bandwidths{0, 1e-3, 0.0099, 0.0101, 1, 30, 1e3, 6e4};
const std::vector<Vec3d> k_centres{
    {0, 0, 1}, {0, 0, -1}, {0.6, 0, 0.8}, {-0.36, 0.48, -0.8}, normalize(Vec3d(1e-4, -2e-4, -1))};

/// Rings that share a lobe of this bandwidth among them.
PolarBins bins_about(Vec3d centre, double bandwidth) {
    PolarBins bins{centre, {0}};
    const double reach = bandwidth > 8 ? 8 / bandwidth : 1;
    for (const double t : {0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 0.8, 1.0}) bins.edge.push_back(reach * t);
    if (bandwidth > 8) bins.edge.push_back(std::min(2.0, 40 / bandwidth) / 2);
    if (bandwidth > 40) bins.edge.push_back(40 / bandwidth);
    bins.edge.push_back(2);
    return bins;
}

TYPED_TEST(VmfOf, DensityIntegratesToOne) {
    for (const double bandwidth : k_bandwidths) {
        for (const Vec3d& centre : k_centres) {
            double sum = 0;
            const auto pdf = [&](Vec3d w) { return this->pdf(w, centre, bandwidth); };
            for (const double mass : bins_about(centre, bandwidth).integrals(pdf)) sum += mass;
            EXPECT_WITHIN(sum, 1, 5e-4) << bandwidth;
        }
    }
}

TYPED_TEST(VmfOf, SamplesFollowTheDensity) {
    const double significance = sidak(0.01, int(k_bandwidths.size() * k_centres.size()));
    for (const double bandwidth : k_bandwidths) {
        for (const Vec3d& centre : k_centres) {
            const auto pdf = [&](Vec3d w) { return Kernel<double>::vmf_pdf(w, centre, bandwidth); };
            const auto sample = [&] { return this->sample(centre, bandwidth, this->draw(), this->draw()); };
            EXPECT_GT(sampler_p_value(bins_about(centre, bandwidth), pdf, 20000, sample), significance)
                << bandwidth << " at z " << centre.z;
        }
    }
}

TYPED_TEST(VmfOf, WarpIsContinuousAcrossItsSeries) {
    const TypeParam at = TypeParam(0.01), before = std::nextafter(at, TypeParam(0));
    const double tolerance = std::is_same_v<TypeParam, float> ? 2e-5 : 1e-7;
    double largest = 0;
    for (int i = 0; i < 2000; ++i) {
        const double u1 = this->draw(), u2 = this->draw();
        const Vec3d centre = random_direction(this->random);
        const Vec3d difference =
            this->sample(centre, double(at), u1, u2) - this->sample(centre, double(before), u1, u2);
        // Near the poles the sine grows as the root of the cosine's difference.
        const double cosine = dot(this->sample(centre, double(at), u1, u2), centre);
        const double steepness = std::max(1.0, std::abs(cosine) / std::sqrt(std::max(1 - cosine * cosine, 1e-6)));
        EXPECT_LE(std::sqrt(dot(difference, difference)) / steepness, tolerance);
        largest = std::max(largest, std::sqrt(dot(difference, difference)));
    }
    EXPECT_GT(largest, 0);  // both forms are in use
}

TEST(Vmf, AreaOfTheWarpTimesTheDensityIsOne) {
    std::mt19937_64 random(4);
    using K = Kernel<double>;
    const double h = 1e-6;
    for (const double bandwidth : k_bandwidths) {
        for (int i = 0; i < 200; ++i) {
            const Vec3d centre = random_direction(random);
            const double u1 = 0.01 + 0.98 * uniform(random), u2 = 0.01 + 0.98 * uniform(random);
            const auto by = [&](double d1, double d2) {
                const Vec3d after = K::sample_vmf(centre, bandwidth, u1 + d1, u2 + d2);
                return (0.5 / h) * (after - K::sample_vmf(centre, bandwidth, u1 - d1, u2 - d2));
            };
            const Vec3d area = cross(by(h, 0), by(0, h));
            const Vec3d w = K::sample_vmf(centre, bandwidth, u1, u2);
            EXPECT_WITHIN(std::sqrt(dot(area, area)) * K::vmf_pdf(w, centre, bandwidth), 1, 1e-5) << bandwidth;
        }
    }
}

TYPED_TEST(VmfOf, EveryDrawIsADirection) {
    const double edges[] = {0, std::numeric_limits<TypeParam>::denorm_min(), 1e-37, 0.5,
                            1 - double(std::numeric_limits<TypeParam>::epsilon())};
    for (const double bandwidth : {0.0, 1e-7, 0.01, 1.0, 50.0, 65504.0, 1e30})
        for (const Vec3d& centre : k_centres)
            for (const double u1 : edges)
                for (const double u2 : edges) {
                    const Vec3d w = this->sample(centre, bandwidth, u1, u2);
                    EXPECT_WITHIN(dot(w, w), 1, 1e-5) << bandwidth << ' ' << u1 << ' ' << u2;
                }
}

}  // namespace
}  // namespace srbf::vmf_test
