// Light from afar: a picture of radiance over all directions: level 5.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "render/image.h"

namespace srbf {

/// Radiance by direction, a picture in latitude and longitude: with y upwards, column (½ + φ/2π) width for φ = atan2(x, −z), row θ/π height for θ
/// from +y; bilinear between the texels' centres. It is drawn from by the mean luminance of each texel.
class Environment {
  public:
    /// Texels that are negative or not finite in a channel have that channel set to 0; how many did is told by `clamped`. At least
    /// one texel.
    explicit Environment(Image texels);

    struct Light {
        Rgb radiance;
        float pdf;  ///< [1/sr], by which `sample` draws; positive where the radiance is
    };
    Light at(Vec3f w) const;
    /// A direction from u1, u2 even in [0,1).
    Vec3f sample(float u1, float u2) const;

    bool is_black() const { return !(row_.back() > 0); }
    const Image& texels() const { return texels_; }
    std::uint64_t clamped() const { return clamped_; }

  private:
    Image texels_;
    std::uint64_t clamped_ = 0;
    std::vector<float> column_;       ///< height × (width + 1): running shares along each row
    std::vector<float> row_;          ///< height + 1: running share of the rows; all 0 where everything is black
    std::vector<float> solid_angle_;  ///< height: of a texel [sr]
};

/// Reads a Radiance `.hdr` (RGBE, flat or run-length encoded, rows from the top and columns from the left).
Result<Image> read_hdr(std::span<const std::byte> bytes, const std::string& source);
/// Reads an environment, `.hdr` or `.exr` as its content tells.
Result<Environment> read_environment(std::span<const std::byte> bytes, const std::string& source);
/// The one in a file, or the bundled one by its name, "studio".
Result<Environment> load_environment(const std::string& name);
inline constexpr std::string_view k_built_in_environment = "studio";

}  // namespace srbf
