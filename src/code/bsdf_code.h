// Both sides of a surface in shading code: what chooses among the parts of a BSDF, and beams.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "code/defined_names.h"
#include "srbf/shading_code.h"

namespace srbf {

/// The models that a BSDF's code consists of, as NAME_transmission_front: its own parts, and with `sampling` also parts
/// that are answered by exchanging light and viewer, since they are drawn from otherwise.
struct PartModels {
    std::vector<NamedModel> named;
    std::vector<std::shared_ptr<const Model>> own;  ///< what `named` points to
};
PartModels part_models(const NamedModel& bsdf, bool sampling);

/// The functions NAME_bsdf, NAME_beam, NAME_mirror_beam, and with `sampling` NAME_sample and NAME_pdf, to follow those
/// of the parts, with samples and albedos if `sampling`.
/// Errors: a name in `defined`, to which theirs are added.
Result<std::string> bsdf_code(const NamedModel& bsdf, const CodeOptions& options, DefinedNames& defined);
/// The code of beams alone, for those that there are.
std::string beam_code(const std::string& name, const Beams& beams, CodeLanguage language);
/// The names of these functions.
std::vector<std::string> bsdf_functions(const NamedModel& bsdf, bool sampling);

}  // namespace srbf
