// Surfaces as files for other programs.
#pragma once
#include <span>

#include "srbf/shading_code.h"

namespace srbf {

/// A kind of file. Its colours are linear, in Rec.709 primaries; its lengths are in metres.
struct SurfaceFile {
    std::string_view name;   ///< of `srbf export --to`
    std::string_view about;  ///< for its help
    std::string (*text)(const NamedModel& named, const OpenPbrModel& model);
};
std::span<const SurfaceFile> surface_files();

/// The file of a surface. It names the version of each specification and, if known, ΔE_ITP of the surface against its
/// measurement. Returns an error if the model is not an OpenPBR surface, or if its light and viewer are exchanged.
Result<std::string> surface_text(const SurfaceFile& file, const NamedModel& named);

}  // namespace srbf
