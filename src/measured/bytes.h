// Numbers in bytes, and constants that readers and writers of binary formats share.
#pragma once
#include <array>
#include <cstddef>
#include <cstring>
#include <limits>
#include <span>
#include <string_view>
#include <vector>

#include "srbf/elementary.h"
#include "srbf/vec.h"

namespace SRBF_NAMESPACE {

static_assert(std::endian::native == std::endian::little, "the formats read here are little-endian");

/// Reads a number at `bytes`, which need not be aligned.
template <typename T> T load(const std::byte* bytes) {
    T number;
    std::memcpy(&number, bytes, sizeof number);
    return number;
}

template <typename T> void store(std::vector<std::byte>& bytes, const T& number) {
    const auto raw = std::as_bytes(std::span(&number, 1));
    bytes.insert(bytes.end(), raw.begin(), raw.end());
}

/// The first line, and the lines at the head of a block. Reflection has two alternatives.
inline constexpr std::string_view k_mbsdf_magic = "NVIDIA ARC MBSDF V1", k_mbsdf_reflection = "MBSDF_DATA_REFLECTION=",
                                  k_mbsdf_data = "MBSDF_DATA=", k_mbsdf_transmission = "MBSDF_DATA_TRANSMISSION=";

/// True for characters that a line of the header may not contain.
inline bool is_control(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }

/// The factors from numbers of the file to f_r [1/sr].
inline constexpr std::array<double, 3> k_merl_channel_scale{1.0 / 1500, 1.15 / 1500, 1.66 / 1500};

struct MerlPair {
    Vec3d wl, wv;
};

/// The directions at θ_h, θ_d, φ_d [rad], with the half vector at azimuth 0 and the light at (θ_d, φ_d) relative to it.
inline MerlPair merl_pair(double theta_h, double theta_d, double phi_d) {
    const double c = elementary::cos(theta_h), s = elementary::sin(theta_h);
    const auto rotate = [&](Vec3d w) { return Vec3d{c * w.x + s * w.z, w.y, c * w.z - s * w.x}; };
    const Vec3d difference = spherical(theta_d, phi_d);
    return {rotate(difference), rotate(mirror(difference))};
}

inline constexpr std::uint32_t k_largest_dimension = 4096;  ///< the largest dimension of a table
/// The largest f_r [1/sr]: far above any measurement, while sums and products of such numbers stay finite.
inline constexpr float k_largest_value = 1e12f;
inline constexpr float k_max_float = std::numeric_limits<float>::max();
inline constexpr float k_nan = std::numeric_limits<float>::quiet_NaN();

}  // namespace
