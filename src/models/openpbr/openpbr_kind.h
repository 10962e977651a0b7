// Surfaces of renderers' parameters as tensors of a model file.
#pragma once
#include <string>
#include <string_view>

#include "base/safetensors.h"
#include "srbf/models/openpbr.h"

namespace srbf {

template <> struct Kind<OpenPbrModel> {
    static constexpr std::string_view name = "openpbr", words = "surface of OpenPBR";
    static Safetensors content(const OpenPbrModel& model);
    static Result<OpenPbrModel> read(Safetensors& content, const std::string& file_name);
    static double largest(const OpenPbrModel&) { return 0; }  // its parameters have limits of their own
    static std::string summary(const OpenPbrModel& model);
    static void add_rows(std::string& text, const OpenPbrModel& model);
    static Parameters members(const OpenPbrModel& model);
    static Parameters parameters(const OpenPbrModel& model);
    static bool is_of(const ParameterReader& of);
    static OpenPbrModel made_of(ParameterReader& of);
    /// Calls each(member) for all members.
    template <typename Each> static void for_members(OpenPbrModel& of, const Each& each) {
        for (const OpenPbrParameter& parameter : k_openpbr_parameters)
            for (int c = 0; c < parameter.count(); ++c) each(number(of, parameter, c));
        each(of.is_exchanged);
    }
};

}  // namespace srbf
