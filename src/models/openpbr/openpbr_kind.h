// `Kind` of OpenPBR surfaces.
#pragma once
#include <string>

#include "models/openpbr/openpbr_parameters.h"
#include "observe/observations.h"
#include "srbf/models/openpbr.h"
#include "srbf/progress.h"

namespace SRBF_NAMESPACE {

void evaluate(const OpenPbrModel& model, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f);
inline bool is_isotropic(const OpenPbrModel& model) { return model.specular_roughness_anisotropy == 0; }
inline void exchange(OpenPbrModel& model) { model.is_exchanged = !model.is_exchanged; }

template <> struct Kind<OpenPbrModel> : KindOfNumbers<OpenPbrModel> {
    static constexpr std::string_view name = OpenPbrRequest::k_name, words = "surface of OpenPBR";
    static constexpr const auto& numbers = k_openpbr_parameters;
    static Safetensors content(const OpenPbrModel& model);
    static Result<OpenPbrModel> read(Safetensors& content, const std::string& file_name);
    static void add_rows(std::string& text, const OpenPbrModel& model);
    static Parameters parameters(const OpenPbrModel& model);
    static std::string formula_text(const OpenPbrModel& model, const NumberText& number);
    static OpenPbrModel from_parameters(ParameterReader& reader);
    /// Minimises the mean of ρ(ΔE_ITP) over the pixels of the observed pictures. If there are none, minimises Σ w
    /// |f−f̂|² over the pairs, with weights adapted to large errors. The search is Levenberg-Marquardt from the best of
    /// two thousand random surfaces, and from the best results with films added. A part of the surface without which
    /// the loss rises by less than 1 %, once the others have adapted, gets its default; so does the anisotropy of an
    /// isotropic measurement.
    /// Returns an error if observations are fewer than parameters or values not finite, or if it is cancelled.
    static Result<Fitted<OpenPbrModel>> fit(const Observations& observations, const OpenPbrRequest& request = {},
                                            const FitConditions& conditions = {}, const ProgressToken& progress = {});
};

}  // namespace
