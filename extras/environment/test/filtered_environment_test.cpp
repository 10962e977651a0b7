// Environments filtered as a cube map.
#include "extras/environment/app/filtered_environment.h"
#include "properties.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "base/half.h"

namespace srbf::filtered_environment_test {
namespace {

constexpr int k_size = FilteredEnvironment::k_min_size;

/// A lamp of 9 degrees, 200 times as bright as the sky, above a dark red ground.
Environment lamp_and_sky() {
    Image texels(128, 64);
    for (int y = 0; y < texels.height; ++y)
        for (int x = 0; x < texels.width; ++x) texels.at(x, y) = y < 32 ? Rgb{0.2f, 0.3f, 0.5f} : Rgb{0.1f, 0.02f, 0};
    for (int y = 14; y < 17; ++y)
        for (int x = 30; x < 33; ++x) texels.at(x, y) = {100, 100, 80};
    return Environment(texels);
}

/// Directions that are spread over the sphere.
std::vector<Vec3d> directions(int count) {
    std::vector<Vec3d> all;
    for (int i = 0; i < count; ++i) {
        const double z = 1 - (2 * i + 1.0) / count, r = std::sqrt(1 - z * z), phi = 2.399963 * i;
        all.push_back({r * std::cos(phi), r * std::sin(phi), z});
    }
    return all;
}

TEST(FilteredEnvironment, IsTheMeanByTheKernel) {
    const Environment environment = lamp_and_sky();
    const FilteredEnvironment filtered(environment, 256);
    const std::vector<Vec3d> all = directions(60'000);
    for (const float roughness : {0.36f, 0.5f, 0.64f, 1.f})
        for (const Vec3d& w : directions(40)) {
            double sum = 0, weight = 0;
            for (const Vec3d& direction : all) {
                const double k = double(filter_kernel(roughness, float(dot(w, direction))));
                sum += k * double(environment.at(to_float(direction)).radiance.g);
                weight += k;
            }
            const double mean = sum / weight, brightest = 100 * (roughness < 0.6f ? 0.05 : 0.01);
            EXPECT_WITHIN(double(filtered.at(to_float(w), roughness).g), mean, 0.02 * mean + 0.02 * brightest)
                << roughness << " " << w.x << " " << w.y << " " << w.z;
        }
}

// Levels begin and end at the right roughnesses, and at an edge of the cube nothing jumps.
TEST(FilteredEnvironment, IsContinuousAndBeginsWithTheEnvironment) {
    const Environment environment = lamp_and_sky();
    const FilteredEnvironment filtered(environment, k_size);
    const auto green = [&](Vec3d w, float roughness) { return filtered.at(to_float(normalize(w)), roughness).g; };
    EXPECT_WITHIN(green({0.3, 0.9, 0.2}, 0), 0.3f, 1e-3f);
    EXPECT_WITHIN(green({0.3, -0.9, 0.2}, 0), 0.02f, 1e-3f);
    for (const float roughness : {0.f, 0.1f, 0.4f, 1.f})
        for (double s = -0.95; s < 1; s += 0.1) {
            const float scale = std::max(green({1, s, 1}, roughness), 0.02f);
            EXPECT_WITHIN(green({1, s, 0.9999}, roughness), green({0.9999, s, 1}, roughness), 0.01f * scale);
            EXPECT_WITHIN(green({s, 1, 0.9999}, roughness), green({s, 0.9999, 1}, roughness), 0.01f * scale);
        }
}

TEST(FilteredEnvironment, FileHasAllFacesAndLevels) {
    Image bright(16, 8);
    std::ranges::fill(bright.pixels, Rgb{1, 70000, 0.5f});
    const FilteredEnvironment filtered(Environment(bright), k_size);
    const CubeFile file = to_dds(filtered);
    std::size_t texels = 0;
    for (int k = 0; k < FilteredEnvironment::k_levels; ++k) {
        EXPECT_EQ(filtered.level(k).side, k_size >> k);
        texels += filtered.level(k).texels.size();
    }
    ASSERT_EQ(file.bytes.size(), 128 + 8 * texels);
    EXPECT_EQ(file.clamped, texels);
    EXPECT_EQ(std::memcmp(file.bytes.data(), "DDS ", 4), 0);
    std::array<std::uint16_t, 4> last;
    std::memcpy(last.data(), &file.bytes[file.bytes.size() - sizeof last], sizeof last);
    EXPECT_EQ(last, (std::array{to_half(1.f), to_half(k_half_max), to_half(0.5f), to_half(1.f)}));
}

}  // namespace
}  // namespace srbf::filtered_environment_test
