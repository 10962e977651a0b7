// What a graphics library draws of a subject.
#pragma once
#include "app/load.h"
#include "render/shader.h"
#include "srbf/convert.h"

namespace srbf {

/// An isotropic BRDF as a table of Rusinkiewicz' angles. It has no cells beyond 89.7°: there it goes on as before.
MerlTable table_of(const Evaluate& brdf, std::array<std::uint32_t, 3> size = k_merl_size);

/// A model as it is, a measurement as a table. Errors: an anisotropic measurement.
Result<Material> material_of(const Subject& subject);

}  // namespace srbf
