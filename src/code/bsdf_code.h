// Shading code of BSDFs: functions that call the functions of the parts, and beams.
#pragma once
#include <memory>

#include "code/defined_names.h"
#include "code/syntax.h"
#include "srbf/shading_code.h"

namespace SRBF_NAMESPACE {

/// Functions that call functions of models.
struct Caller {
    std::string name;              ///< the beginning of their names
    std::string stubs = {};        ///< declarations, for the parser, of the functions that they call
    std::string stub_prefix = {};  ///< the prefix of the called functions' names in the code
};
/// The stubs of the functions of a BRDF.
std::string brdf_stubs(std::string_view name);
/// The tables of `program` and the functions of `text` in a language. `sample_light`, `light_pdf` and
/// `directional_albedo` become NAME_sample, NAME_pdf and NAME_albedo. Returns an error for a name that is `defined`.
Result<std::string> print_functions(const Caller& caller, syntax::Program program, const std::string& text,
                                    CodeLanguage language, DefinedNames& defined);

/// The models of a BSDF's code, with names such as NAME_transmission_front: its own parts, and for `sampling` also
/// parts that follow by exchanging light and viewer, which need their own proposals.
struct PartModels {
    std::vector<NamedModel> named;
    std::vector<std::shared_ptr<const Model>> owned;  ///< the models that `named` points to
};
PartModels part_models(const NamedModel& bsdf, bool sampling);

/// The functions NAME_bsdf, NAME_beam, NAME_mirror_beam, and for sampling NAME_sample and NAME_pdf, which follow the
/// functions of the parts. Adds their names to `defined`, and returns an error if it has one of them.
Result<std::string> bsdf_code(const NamedModel& bsdf, const CodeOptions& options, DefinedNames& defined);
/// The functions of beams alone.
std::string beam_code(const std::string& name, const Beams& beams, CodeLanguage language);
std::vector<std::string> bsdf_functions(const NamedModel& bsdf, bool sampling);

}  // namespace
