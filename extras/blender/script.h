// Materials of Blender's nodes as a script, for the program and for the page that fits.
#pragma once
#include <span>
#include <string_view>

#include "app/load.h"
#include "extras/blender/closures.h"

namespace SRBF_NAMESPACE {

/// Checks that a subject can be fitted by closures: its reflection has to be a BRDF as a function of any two
/// directions. `to` names the kind of file that is written, for messages.
Result<Done> check_reflection(const LoadedFile& subject, std::string_view to);

/// The texels of the tables, a column for each knot. A term has a row with its shape and one with its weights; then a
/// row for each colour of the diffuse ramp.
std::string table_text(const ClosureSum& sum);

struct NamedClosures {
    std::string name;
    ClosureSum sum;
};
/// A script in Python that makes materials of these names.
std::string blender_script(std::span<const NamedClosures> materials);

}  // namespace
