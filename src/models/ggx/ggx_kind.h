// `Kind` of Lambert and GGX lobes.
#pragma once
#include <string>

#include "models/kind/numbers.h"
#include "observe/observations.h"
#include "srbf/kernel.h"
#include "srbf/models/ggx.h"
#include "srbf/progress.h"

namespace SRBF_NAMESPACE {

template <> struct Kind<GgxModel> : KindOfNumbers<GgxModel> {
    static constexpr std::string_view name = GgxRequest::k_name, words = "Lambert and GGX";
    using Lobe = GgxModel::Lobe;
    static constexpr Member<GgxModel, Lobe> numbers[] = {
        {.name = "diffuse", .min = 0, .max = k_unbounded, .colour = &GgxModel::diffuse, .row = "diffuse RGB"},
        {.name = "roughness", .min = k_min_roughness, .max = 1, .lobe_number = &Lobe::roughness, .row = "roughness α"},
        {.name = "f0", .min = 0, .max = k_unbounded, .lobe_colour = &Lobe::f0, .tensor = "facing", .row = "F0 RGB"},
        {.name = "f90", .min = 0, .max = k_unbounded, .lobe_number = &Lobe::f90, .tensor = "grazing", .row = "F90"},
    };
    static Result<GgxModel> read(Safetensors& content, const std::string& file_name);
    static auto rho(const GgxModel& model) {
        return [diffuse = vector_of(model.diffuse), first = lobe_of(model, 0), second = lobe_of(model, 1)](
                   Vec3f wl, Vec3f wv) { return Kernel<float>::ggx_value(diffuse, first, second, wl, wv); };
    }
    static std::string summary(const GgxModel& model);
    static std::string formula_text(const GgxModel& model, const NumberText& number);
    /// Minimises Σ w |f−f̂|² over the observations. For given roughness all other parameters solve a non-negative
    /// linear problem. Roughness is optimised by pattern search from the best values on a grid of half octaves, which
    /// is evaluated on a subset; no roughness is below the observations' least. The loss of `model` is computed before
    /// the linear parameters are rounded. If pictures are observed, all parameters are then optimised for the loss of
    /// `SurfaceData` with pixels and pairs, from this solution and from the best of the grid. Albedos and bound pairs
    /// are not used. Returns an error if options are out of range, observations fewer than parameters, or values not
    /// finite, or if it is cancelled.
    static Result<Fitted<GgxModel>> fit(const Observations& observations, const GgxRequest& request = {},
                                        const FitConditions& conditions = {}, const ProgressToken& progress = {});

  private:
    static Kernel<float>::GgxLobe lobe_of(const GgxModel& model, std::size_t i) {
        if (i >= model.lobes.size()) return {1, {0, 0, 0}, 0};
        return {model.lobes[i].roughness, vector_of(model.lobes[i].f0), model.lobes[i].f90};
    }
};

}  // namespace
