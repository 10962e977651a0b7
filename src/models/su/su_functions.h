// View-by-view models as any kind of model: the functions of a `Model` (model.h). Their sampled views, index textures,
// and the names of their choices.
#pragma once
#include <cstddef>
#include <span>
#include <string_view>

#include "srbf/models/su.h"

SRBF_BEGIN

/// In SIMD over consecutive pairs that share the sampled direction. Within 1e-4 of `value` or 1e-6 of the model's peak.
void evaluate(const SuModel& model, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f);
inline bool is_isotropic(const SuModel&) { return true; }
void exchange(SuModel& model);
/// Size of the stored numbers: n·J·(3 coefficients + 2 angles + 1 bandwidth) halves.
std::size_t payload_bytes(const SuModel& model);
/// Size of the tables that plain interpolation needs at run time, whether or not the file contains them: the index
/// texture (a cube map unless the model has another) and the table of directions, four halves per view.
std::size_t auxiliary_bytes(const SuModel& model);
SuModel rounded(const SuModel& model);

std::string_view name(Discretise discretise);
std::optional<Discretise> discretise_named(std::string_view text);
std::string_view name(SuInterpolation interpolation);
std::optional<SuInterpolation> interpolation_named(std::string_view text);
/// The sizes in Tsai 2009: 6 × 128 × 128 and 256 × 256.
constexpr int default_size(DirectionMap map) { return map == DirectionMap::cube ? 128 : 256; }
inline constexpr int k_largest_texture = 1024;
std::string_view name(DirectionMap map);
std::optional<DirectionMap> map_named(std::string_view text);

/// The integral ∫ ρ(w, wv_i) cosθ dω of each sampled direction, over the directions w of which the lobes are functions:
/// the sum of the lobes' integrals, each from 512 points of a Gaussian about its maximum.
std::vector<Rgb> view_integrals(const SuModel& model);
/// A number of each sampled direction, interpolated as ρ is: of `view_integrals` the integral for a view wv between
/// them.
Rgb between_views(const SuModel& model, std::span<const Rgb> view_values, Vec3f wv);

/// The eight sampled views nearest to `w`.
NearestViews nearest_views(const SuModel& model, Vec3f w);
/// The texture of nearest views; `size` 0: `default_size`.
IndexTexture index_texture(const SuModel& model, DirectionMap map, int size = 0);

SRBF_END
