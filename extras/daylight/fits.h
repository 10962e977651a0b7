// Fits to the averages over patches of a Klems matrix.
#pragma once
#include "fit/patch_fit.h"
#include "srbf/daylight.h"

namespace SRBF_NAMESPACE {

inline constexpr PatchFitter k_daylight_fits[] = {
    {"patches", [](const Measured& part) { return table_as<KlemsTable>(part) != nullptr; },
     [](const Measured& part, const FitRequest& request, const ProgressToken& progress) {
         return fit_patches(*table_as<KlemsTable>(part), request, progress);
     },
     [](const Measured& part, const Evaluate& f) {
         return sums_of(*table_as<KlemsTable>(part), k_measured_points).error_ratio(f);
     },
     [](const Measured& measured, const Evaluate& f, const Beams& beams, Part part) {
         return hemispherical(*table_as<KlemsTable>(measured), f, beams, part);
     }}};

}  // namespace
