// Environments filtered for surfaces, in the form that engines look up.
#pragma once
#include <cstddef>
#include <functional>

#include "extras/render/environment.h"
#include "srbf/extended_light.h"

namespace SRBF_NAMESPACE {

/// An image on the faces of a cube, +x −x +y −y +z −z, each with `side` × `side` texels in rows as in OpenGL and
/// Direct3D.
struct CubeImage {
    int side = 0;
    std::vector<Rgb> texels;  ///< 6 side²
    /// Linear between texels, also across edges of the cube.
    Rgb at(const Vec3d& w) const;
};

/// A cube map of an environment whose levels are blurred increasingly by K of srbf/extended_light.h: level k for
/// roughness (k / (k_levels − 1))², with size / 2ᵏ texels along a side. Level 0 is the environment itself, the last
/// level irradiance / π.
class FilteredEnvironment {
  public:
    static constexpr int k_levels = ExtendedLight::k_levels;
    /// With 256 texels, irradiance has 8 along a side: the error of pictures of white paper in a studio is ΔE_ITP
    /// 6.1 instead of 4.0.
    static constexpr int k_usual_size = 512, k_min_size = 64, k_largest_size = 2048;
    /// `size` must be a power of two in this range. `progress` is called as in PathOptions.
    explicit FilteredEnvironment(const Environment& environment, int size = k_usual_size, int threads = 0,
                                 const std::function<void(double)>& progress = {});

    const CubeImage& level(int k) const { return levels_[std::size_t(k)]; }
    /// ∫ K(r, w · w') L(w') dω': linear between levels.
    Rgb at(Vec3f w, float roughness) const;

  private:
    std::vector<CubeImage> levels_;
};

/// The bytes of a DirectDraw Surface (.dds) of a filtered environment: a cube map with its levels in 16-bit floats
/// R, G, B, A = 1. Values above 65504, the largest 16-bit float, are set to it; `clamped` is the number of such
/// texels.
struct CubeFile {
    std::vector<std::byte> bytes;
    std::size_t clamped = 0;
};
CubeFile to_dds(const FilteredEnvironment& environment);

}  // namespace
