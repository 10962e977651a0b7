// `Kind` of the multivariate model, and files with the lobes of several.
#pragma once
#include <map>
#include <string>

#include "models/kind/kind.h"
#include "models/pm/pm_functions.h"
#include "srbf/models/pm.h"

namespace SRBF_NAMESPACE {

template <> struct Kind<PmModel> {
    static constexpr std::string_view name = "pm", words = "multivariate";
    static Safetensors content(const PmModel& model);
    static Result<PmModel> read(Safetensors& content, const std::string& file_name);
    static double largest(const PmModel& model);
    static std::string summary(const PmModel& model);
    static void add_rows(std::string& text, const PmModel& model);
    static Parameters members(const PmModel& model);
    static Parameters parameters(const PmModel& model);
    static std::string formula_text(const PmModel& model, const NumberText& number);
    static bool matches(const ParameterReader& reader);
    static PmModel from_parameters(ParameterReader& reader);
};

// For files that hold the lobes of several models:
/// The tensors of a model, always with log scales, and the metadata that determine their meaning.
Safetensors lobes_content(const PmModel& model);
/// The metadata of a model, under these names.
struct LobesHeader {
    PmForm form;
    bool axial;
};
/// Removes the header's entries from `metadata` and returns them. Errors: those of `read_model`.
Result<LobesHeader> take_lobes_header(Metadata& metadata, const std::string& file_name);
/// The model with these tensors, whose names are those of `lobes_content`, or an error.
Result<PmModel> decode_lobes(const std::map<std::string, Tensor16>& tensors, const LobesHeader& header,
                             const std::string& file_name);

}  // namespace srbf
