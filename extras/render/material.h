// Materials of measurements and models for shaders.
#pragma once
#include "srbf/convert.h"
#include "srbf/load.h"
#include "srbf/shader.h"

namespace SRBF_NAMESPACE {

/// An isotropic BRDF as a table in Rusinkiewicz coordinates. Cells beyond 89.7° are extrapolated.
MerlTable tabulate_merl(const Evaluate& brdf, std::array<std::uint32_t, 3> size = k_merl_size);
/// The material of a model as it is. A measurement becomes a table in Rusinkiewicz coordinates, or one table for
/// each part of a BSDF; a BSDF with a view-by-view part also becomes tables. Returns an error for an anisotropic
/// measurement. `path` appears in errors only.
Result<Material> material_of(const AnyBrdf& brdf, const std::string& path);
Material material_of(const Model& model);
/// The size of the tables of a BSDF.
inline constexpr std::array<std::uint32_t, 3> k_bsdf_table{128, 45, 48};

}  // namespace
