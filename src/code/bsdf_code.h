// Shading code of BSDFs: functions that call those of the parts, and beams.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "code/defined_names.h"
#include "srbf/shading_code.h"

namespace srbf {

/// The models of a BSDF's code, with names such as NAME_transmission_front: its own parts, and for `sampling` also
/// parts that follow by exchanging light and viewer, which need their own proposals.
struct PartModels {
    std::vector<NamedModel> named;
    std::vector<std::shared_ptr<const Model>> owned;  ///< the models that `named` points to
};
PartModels part_models(const NamedModel& bsdf, bool sampling);

/// The functions NAME_bsdf, NAME_beam, NAME_mirror_beam, and for sampling NAME_sample and NAME_pdf, which follow those
/// of the parts. Their names are added to `defined`. Errors: `defined` has one of them.
Result<std::string> bsdf_code(const NamedModel& bsdf, const CodeOptions& options, DefinedNames& defined);
/// The functions of beams alone.
std::string beam_code(const std::string& name, const Beams& beams, CodeLanguage language);
std::vector<std::string> bsdf_functions(const NamedModel& bsdf, bool sampling);

}  // namespace srbf
