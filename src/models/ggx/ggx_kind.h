// `Kind` of Lambert and GGX, with its fit.
#pragma once
#include <string>
#include <string_view>

#include "base/kind.h"
#include "models/ggx/ggx_functions.h"
#include "observe/observations.h"
#include "srbf/models/ggx.h"
#include "srbf/progress.h"

namespace srbf {

template <> struct Kind<GgxModel> {
    static constexpr std::string_view name = GgxRequest::k_name, words = "Lambert and GGX";
    static Safetensors content(const GgxModel& model);
    static Result<GgxModel> read(Safetensors& content, const std::string& file_name);
    static double largest(const GgxModel& model);
    static std::string summary(const GgxModel& model);
    static void add_rows(std::string& text, const GgxModel& model);
    static Parameters members(const GgxModel& model);
    static Parameters parameters(const GgxModel& model);
    static std::vector<Model> terms(const GgxModel& model, std::size_t most);
    static std::string formula_text(const GgxModel& model, const NumberText& number);
    static bool is_of(const ParameterReader& of);
    static GgxModel made_of(ParameterReader& of);
    /// With no roughness below the observations' least. For given roughness all other parameters solve a non-negative linear
    /// problem. Roughness is optimised by pattern search, from the best value on a grid of half octaves, evaluated on a
    /// subset. The loss is Σ w |f−f̂|² over the observations, of `model` before the linear parameters are rounded. Albedos and
    /// bound pairs are not used.
    /// Errors: options out of range, fewer observations than parameters, values that are not finite; cancelled.
    static Result<Fitted<GgxModel>> fit(const Observations& observations, const GgxRequest& request = {},
                                        const FitConditions& of = {}, const ProgressToken& progress = {});
    /// Calls each(member) for all members.
    template <typename Each> static void for_members(GgxModel& of, const Each& each) {
        each(of.diffuse), each(of.lobes);
    }
};

}  // namespace srbf
