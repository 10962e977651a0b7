// `Kind` of the view-by-view model.
#pragma once
#include <string>

#include "models/kind/kind.h"
#include "models/su/su_functions.h"
#include "srbf/models/su.h"

namespace SRBF_NAMESPACE {

template <> struct Kind<SuModel> {
    static constexpr std::string_view name = "su", words = "view by view";
    static Safetensors content(const SuModel& model);
    static Result<SuModel> read(Safetensors& content, const std::string& file_name);
    static double largest(const SuModel& model);
    static std::string summary(const SuModel& model);
    static void add_rows(std::string& text, const SuModel& model);
    static Parameters members(const SuModel& model);
    static Parameters parameters(const SuModel& model);
    static std::string formula_text(const SuModel& model, const NumberText& number);
    static bool matches(const ParameterReader& reader);
    static SuModel from_parameters(ParameterReader& reader);
};

}  // namespace
