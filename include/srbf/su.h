// Scattered univariate SRBFs, the view-by-view model: level 3.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "srbf/brdf.h"
#include "srbf/directions.h"

namespace srbf {

/// Which of the two directions is sampled; the lobes are functions of the other one.
enum class Discretise { view, light };
std::string_view name(Discretise discretise);
std::optional<Discretise> discretise_named(std::string_view text);

/// How a function between the sampled views is made of theirs.
enum class SuInterpolation {
    rotated,  ///< the two next in elevation, rotated to the azimuth asked for: for isotropic BRDFs
    plain,    ///< the K nearest as they are (Tsai 2009)
};
std::string_view name(SuInterpolation interpolation);
std::optional<SuInterpolation> interpolation_named(std::string_view text);

/// The eight sampled views nearest to a direction, the nearest first.
using NearestViews = std::array<std::uint16_t, 8>;

/// The nearest sampled views of each direction, as a texture of 16 bytes a texel (RGBA32UI): what a shader looks up.
struct IndexTexture {
    DirectionMap map = DirectionMap::cube;
    int size = 0;                      ///< texels along a side
    std::vector<NearestViews> texels;  ///< of the directions at their centres
    friend bool operator==(const IndexTexture&, const IndexTexture&) = default;
};
/// The source's sizes: 6 × 128 × 128 and 256 × 256.
constexpr int default_size(DirectionMap map) { return map == DirectionMap::cube ? 128 : 256; }
inline constexpr int k_largest_texture = 1024;
std::string_view name(DirectionMap map);
std::optional<DirectionMap> map_named(std::string_view text);

/// Scattered univariate SRBFs (Tsai 2009, section 7.2): for each sampled view direction wv_i
///   ρ(wl, wv_i) = Σ_j β_ij G(wl·ξ_ij | λ_ij) [1/sr],
/// between them by interpolation, evaluated by kernel.glsl's su_ functions. With `discretise` light, wl and wv change places.
/// The file's encoding is in `write_model`.
struct SuModel {
    Discretise discretise = Discretise::view;
    SuInterpolation interpolation = SuInterpolation::rotated;
    int neighbours = 3;                 ///< K of plain interpolation, 1..k_most_neighbours
    int lobes = 0;                      ///< J, 1..k_most_view_lobes
    std::vector<Vec3f> direction;       ///< n: the sampled views, the Fibonacci set of the hemisphere
    std::vector<Rgb> coefficient;       ///< n × J: β_ij ≥ 0; all 0 for a view without data
    std::vector<Vec3f> centre;          ///< n × J: ξ_ij, unit vectors
    std::vector<float> bandwidth;       ///< n × J: λ_ij ≥ 0
    std::optional<IndexTexture> index;  ///< where the file holds it
    friend bool operator==(const SuModel&, const SuModel&) = default;
};
inline constexpr int k_most_view_lobes = 64;
inline constexpr int k_most_neighbours = 7;  ///< of the eight that are known; the next one says when a neighbour leaves
inline constexpr int k_least_views = 8, k_most_views = 8192;

/// ρ(wl, wv) in float; 0 below the horizon. Continuous in both directions, but for plain interpolation where the K+1 nearest
/// views are equally near.
Rgb value(const SuModel& model, Vec3f wl, Vec3f wv);
/// The same by plain interpolation with the views that the texture names: of its eight the nearest to the direction.
Rgb value(const SuModel& model, const IndexTexture& index, Vec3f wl, Vec3f wv);

/// f[i] = value(model, wl[i], wv[i]) for spans of one length, in SIMD over neighbouring pairs that share the sampled
/// direction: within 1e-4 of `value` or 1e-6 of the model's peak.
void evaluate(const SuModel& model, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f);
/// The same as a function. It refers to `model`.
Evaluate evaluator(const SuModel& model);

/// The eight sampled views nearest to `w`.
NearestViews nearest_views(const SuModel& model, Vec3f w);
/// The texture of nearest views; `size` 0: the source's.
IndexTexture index_texture(const SuModel& model, DirectionMap map, int size = 0);

/// Bytes of the model's numbers as stored: n·J·(3 coefficients + 2 angles + 1 bandwidth) halves.
std::size_t payload_bytes(const SuModel& model);
/// Bytes of what plain interpolation looks up at run time, whether the file holds it or not: the index texture, a cube
/// unless the model has another, and the direction table of four halves a view.
std::size_t auxiliary_bytes(const SuModel& model);
/// `model` with every number rounded to what a file holds.
SuModel rounded(const SuModel& model);

}  // namespace srbf
