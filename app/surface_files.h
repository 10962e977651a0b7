// Surfaces as files for other programs.
#pragma once
#include <array>

#include "srbf/shading_code.h"

namespace srbf {

/// The kinds of files, as named by `srbf export --to`: a MaterialX document with OpenPBR Surface 1.1, or with
/// Autodesk Standard Surface; glTF 2.0 with a sphere, as text or binary; a USD stage with UsdPreviewSurface, a
/// MaterialX network and a sphere; a script that makes Blender's material of Principled BSDF.
inline constexpr std::array<std::string_view, 6> k_surface_files{"mtlx", "standard-surface", "gltf", "glb",
                                                                 "usd",  "principled"};

/// The file of a surface. Its colours are linear, in Rec.709 primaries; its lengths are in metres. It names the
/// version of each specification and, if known, ΔE_ITP of the surface against its measurement. Returns an error if the
/// model is not an OpenPBR surface, or if its light and viewer are exchanged.
Result<std::string> surface_file(std::string_view kind, const NamedModel& named);

}  // namespace srbf
