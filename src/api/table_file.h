// Any BRDF as a file of a measured format.
#pragma once
#include "measured/formats.h"
#include "srbf/load.h"

SRBF_BEGIN

/// True if a part is known, or follows from its counterpart. A BRDF has the front's reflection alone.
bool has_part(const AnyBrdf& brdf, Part part);
/// The beams of its parts; a missing reflection has the beam of the other side.
Beams beams_of(const AnyBrdf& brdf);

/// The bytes of a file of a format that is written (measured/formats.h), with the values of `brdf`. Scattered samples
/// become CSV as they are. An MBSDF file of a BSDF has the parts of light from the front. Returns an error if files of
/// the format do not hold an anisotropic measurement, a BSDF or beams that `brdf` has, or if it is cancelled.
Result<std::vector<std::byte>> table_file(const AnyBrdf& brdf, const Format& format, const TableOptions& options = {});

SRBF_END
