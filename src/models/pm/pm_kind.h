// `Kind` of the multivariate model.
#pragma once
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

/// The tensors of a model and the metadata that determine their meaning.
Safetensors lobes_content(const PmModel& model, bool with_log_scale = true);

}  // namespace
