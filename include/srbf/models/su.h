// Scattered univariate SRBFs, the view-by-view model.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "srbf/brdf.h"

SRBF_BEGIN

/// Which of the two directions is sampled; the lobes are functions of the other one.
enum class Discretise { view, light };

/// The sampled views from which the function at another view direction is interpolated.
enum class SuInterpolation {
    /// the two views adjacent in elevation, rotated to the azimuth of the view direction: for isotropic BRDFs
    rotated,
    plain,  ///< the K nearest views, not rotated (Tsai 2009)
};

/// The eight sampled views nearest to a direction, the nearest first.
using NearestViews = std::array<std::uint16_t, 8>;

/// The layout of a function of direction in a square texture.
enum class DirectionMap {
    cube,       ///< six faces +x, −x, +y, −y, +z, −z, each laid out as OpenGL's
    parabolic,  ///< one square; its point (s, t) in [−1, 1]² is the direction (2s, 2t, 1−s²−t²) / (1+s²+t²)
};

/// The nearest sampled views of each direction, as a texture with 16 bytes per texel (RGBA32UI) for shaders.
struct IndexTexture {
    DirectionMap map = DirectionMap::cube;
    int size = 0;                      ///< texels along a side
    std::vector<NearestViews> texels;  ///< nearest views of the direction at each texel's centre
    friend bool operator==(const IndexTexture&, const IndexTexture&) = default;
};

/// Scattered univariate SRBFs (Tsai 2009, section 7.2): for each sampled view direction wv_i
///   ρ(wl, wv_i) = Σ_j β_ij G(wl·ξ_ij | λ_ij) [1/sr],
/// and between them interpolation. Evaluated by the su_ functions of kernel.glsl. With `discretise` light, wl and wv
/// are exchanged. docs/formats.md describes the file encoding.
struct SuModel {
    Discretise discretise = Discretise::view;
    SuInterpolation interpolation = SuInterpolation::rotated;
    int neighbours = 3;                 ///< K of plain interpolation, 1..k_max_neighbours
    int lobes = 0;                      ///< J, 1..k_max_view_lobes
    std::vector<Vec3f> direction;       ///< n: the sampled views, the Fibonacci set of the hemisphere
    std::vector<Rgb> coefficient;       ///< n × J: β_ij ≥ 0; all 0 for a view without data
    std::vector<Vec3f> centre;          ///< n × J: ξ_ij, unit vectors
    std::vector<float> bandwidth;       ///< n × J: λ_ij ≥ 0
    std::optional<IndexTexture> index;  ///< only if the file contains it
    friend bool operator==(const SuModel&, const SuModel&) = default;
};
inline constexpr int k_max_view_lobes = 64;
/// the largest K: of the eight views in the index, the weights need the distance of the last one
inline constexpr int k_max_neighbours = 7;
inline constexpr int k_min_views = 8, k_max_views = 8192;

/// A view-by-view model (SU).
struct SuRequest {
    using Model = SuModel;
    static constexpr std::string_view k_name = "su";
    static constexpr std::string_view k_about =
        "scattered univariate SRBFs, a sum of lobes for each of many view directions";
    int lobes = 8;  ///< J per sampled direction, 1..k_max_view_lobes
    Discretise discretise = Discretise::view;
    int directions = 1536;  ///< n, k_min_views..k_max_views
    SuInterpolation interpolation = SuInterpolation::rotated;
    int neighbours = 3;                      ///< K of plain interpolation, 1..k_max_neighbours
    std::optional<DirectionMap> index = {};  ///< if set, the file contains an index texture with this map
};

/// ρ(wl, wv) in single precision; 0 below the horizon. Continuous in both directions, except for plain interpolation
/// where the K+1 nearest views are equally near.
Rgb value(const SuModel& model, Vec3f wl, Vec3f wv);
/// `model` as an `Evaluate`. It keeps a reference to `model`.
Evaluate evaluator(const SuModel& model);

SRBF_END
