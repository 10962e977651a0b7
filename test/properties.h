// Parts of all tests: comparisons that fail for NaN, the location of data, random directions.
#pragma once
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "brdf/directions.h"
#include "srbf/vec.h"

namespace srbf {

/// |a − b| ≤ tolerance, with a finite.
inline bool near(double a, double b, double tolerance) { return std::isfinite(a) && std::abs(a - b) <= tolerance; }
/// |a − b| ≤ tolerance |b|, with a finite.
inline bool near_relative(double a, double b, double tolerance) { return near(a, b, tolerance * std::abs(b)); }

/// The measurements bundled with the project.
inline std::filesystem::path bundled_data() { return std::filesystem::path(SRBF_SOURCE_DIR) / "data"; }
/// More measurements, if available: $SRBF_DATA, otherwise shared/data beside the checkout; may not exist.
inline std::filesystem::path shared_data() {
    const char* folder = std::getenv("SRBF_DATA");
    return folder ? std::filesystem::path(folder) : std::filesystem::path(SRBF_SOURCE_DIR) / ".." / "shared" / "data";
}

/// A direction uniform on the sphere (for z ≥ z_min).
inline Vec3d random_direction(std::mt19937_64& random, double z_min = -1) {
    const double z = z_min + (1 - z_min) * uniform(random), phi = 2 * k_pi * uniform(random);
    const double r = std::sqrt(std::max(0.0, 1 - z * z));
    return {r * elementary::cos(phi), r * elementary::sin(phi), z};
}

}  // namespace srbf
