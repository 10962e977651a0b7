// `Kind` of surfaces of renderers' parameters, with its fit.
#pragma once
#include <string>
#include <string_view>

#include "base/kind.h"
#include "models/openpbr/openpbr_functions.h"
#include "models/openpbr/openpbr_parameters.h"
#include "observe/observations.h"
#include "srbf/models/openpbr.h"
#include "srbf/progress.h"

namespace srbf {

template <> struct Kind<OpenPbrModel> {
    static constexpr std::string_view name = OpenPbrRequest::k_name, words = "surface of OpenPBR";
    static constexpr const char* not_for_radiance = "a surface";
    static Safetensors content(const OpenPbrModel& model);
    static Result<OpenPbrModel> read(Safetensors& content, const std::string& file_name);
    static double largest(const OpenPbrModel&) { return 0; }  // its parameters have limits of their own
    static std::string summary(const OpenPbrModel& model);
    static void add_rows(std::string& text, const OpenPbrModel& model);
    static Parameters members(const OpenPbrModel& model);
    static Parameters parameters(const OpenPbrModel& model);
    static std::vector<Model> terms(const OpenPbrModel& model, std::size_t most);
    static std::string formula_text(const OpenPbrModel& model, const NumberText& number);
    static bool is_of(const ParameterReader& of);
    static OpenPbrModel made_of(ParameterReader& of);
    /// By Levenberg-Marquardt from those of some two thousand surfaces that come nearest, and from the best under films: to
    /// the pixels of the observed pictures, or where there are none to the pairs, whose weights are adapted to large errors.
    /// Parts without which the loss, once the others have adapted, rises by less than 1 % are left at their defaults; of what
    /// is isotropic the anisotropy. The loss is the mean over pixels of ρ(ΔE_ITP), or without pictures Σ w |f−f̂|².
    /// Errors: fewer observations than parameters, values that are not finite; cancelled.
    static Result<Fitted<OpenPbrModel>> fit(const Observations& observations, const OpenPbrRequest& request = {},
                                            const FitConditions& of = {}, const ProgressToken& progress = {});
    /// Calls each(member) for all members.
    template <typename Each> static void for_members(OpenPbrModel& of, const Each& each) {
        for (const OpenPbrParameter& parameter : k_openpbr_parameters)
            for (int c = 0; c < parameter.count(); ++c) each(number(of, parameter, c));
        each(of.is_exchanged);
    }
};

}  // namespace srbf
