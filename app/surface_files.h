// Files of surfaces for other programs.
#pragma once
#include <algorithm>
#include <array>
#include <string>
#include <string_view>

#include "srbf/shading_code.h"

namespace srbf {

/// The kinds of files, as `srbf export --to` names them: a MaterialX document with OpenPBR Surface 1.1, or with Autodesk
/// Standard Surface; glTF 2.0 with a sphere, as text or binary; a USD stage with UsdPreviewSurface, a MaterialX network
/// and a sphere; a script that makes Blender's material.
inline constexpr std::array<std::string_view, 6> k_surface_files{"mtlx", "standard-surface", "gltf", "glb",
                                                                 "usd",  "blender"};
inline bool is_surface_file(std::string_view kind) {
    return std::ranges::find(k_surface_files, kind) != k_surface_files.end();
}

/// A surface's file. Colours in it are linear, in Rec.709 primaries, lengths in metres; it names the version of each
/// specification, and ΔE_ITP of the surface against its measurement where that is known.
/// Errors: not a surface of renderers' parameters, or one whose light and viewer are exchanged.
Result<std::string> surface_file(std::string_view kind, const NamedModel& of);

}  // namespace srbf
