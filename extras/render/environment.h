// Environment maps.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "extras/render/tone.h"

namespace SRBF_NAMESPACE {

/// Radiance by direction, as an image in latitude and longitude. With y upwards, column (½ + φ/2π) width belongs to
/// φ = atan2(x, −z), row θ/π height to θ from +y; values are bilinear between texel centres. It is importance
/// sampled by the mean luminance of each texel.
class Environment {
  public:
    /// Sets channels that are negative or not finite to 0; `clamped` is the number of such texels. Requires at
    /// least one texel.
    explicit Environment(Image texels);

    struct Light {
        Rgb radiance;
        float pdf;  ///< [1/sr], density of `sample`; positive wherever the radiance is
    };
    Light at(Vec3f w) const;
    /// Samples a direction from u1, u2 uniform in [0,1).
    Vec3f sample(float u1, float u2) const;

    bool is_black() const { return !(row_.back() > 0); }
    const Image& texels() const { return texels_; }
    std::uint64_t clamped() const { return clamped_; }
    /// The distributions that `sample` inverts: the running sums of the texels' light along each row, height ×
    /// (width + 1), and over the rows, height + 1, both from 0 to 1.
    std::span<const float> columns() const { return column_; }
    std::span<const float> rows() const { return row_; }

  private:
    Image texels_;
    std::uint64_t clamped_ = 0;
    std::vector<float> column_;       ///< height × (width + 1): cumulative distribution along each row
    std::vector<float> row_;          ///< height + 1: cumulative distribution over the rows; all 0 if the map is black
    std::vector<float> solid_angle_;  ///< height: solid angle of a texel [sr]
};

/// The map with half the width and height, rounded down but at least 1. A texel is the mean over the solid angle
/// that it covers.
Image halved(const Image& texels);

/// Colours in the texel format of Radiance files: 8-bit mantissas and a common exponent, rounded to nearest.
std::vector<std::array<std::uint8_t, 4>> to_rgbe(const Image& image);
/// Reads a Radiance `.hdr` (RGBE, flat or run-length encoded, rows from the top and columns from the left).
Result<Image> read_hdr(std::span<const std::byte> bytes, const std::string& file_name);
/// Reads an environment, `.hdr` or `.exr`, recognised by its content.
Result<Environment> read_environment(std::span<const std::byte> bytes, const std::string& file_name);
/// Loads an environment from a file, or the bundled one by its name, "studio".
Result<Environment> load_environment(const std::string& name);
inline constexpr std::string_view k_built_in_environment = "studio";

}  // namespace
