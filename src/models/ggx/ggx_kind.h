#pragma once
#include <string>
#include <string_view>

#include "models/ggx/ggx_functions.h"
#include "models/kind/kind.h"
#include "observe/observations.h"
#include "srbf/models/ggx.h"
#include "srbf/progress.h"

namespace SRBF_NAMESPACE {

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
    static bool is_of(const ParameterReader& reader);
    static GgxModel made_of(ParameterReader& reader);
    /// Minimises Σ w |f−f̂|² over the observations. For given roughness all other parameters solve a non-negative
    /// linear problem. Roughness is optimised by pattern search from the best values on a grid of half octaves, which
    /// is evaluated on a subset; no roughness is below the observations' least. The loss of `model` is that before the
    /// linear parameters are rounded. If pictures are observed, all parameters are then optimised for the loss of
    /// `SurfaceData` with pixels and pairs, from this solution and from the best of the grid. Albedos and bound pairs
    /// are not used.
    /// Errors: options out of range, fewer observations than parameters, values that are not finite; cancelled.
    static Result<Fitted<GgxModel>> fit(const Observations& observations, const GgxRequest& request = {},
                                        const FitConditions& conditions = {}, const ProgressToken& progress = {});
};

}  // namespace srbf
