// Synthetic BRDFs with a highlight, and conversions that must not move it.
#pragma once
#include "app/peak.h"
#include "brdf/directions.h"
#include "brdf_functions.h"
#include "properties.h"
#include "srbf/measured.h"

namespace srbf {

using ScalarBrdf = std::function<double(const Vec3d&, const Vec3d&)>;

inline Evaluate to_evaluate(ScalarBrdf f) {
    return pairwise([f = std::move(f)](Vec3f wl, Vec3f wv) {
        const auto y = wl.z > 0 && wv.z > 0 ? float(f(to_double(wl), to_double(wv))) : 0.f;
        return Rgb{y, y, y};
    });
}
/// A lobe about a direction that depends on the light.
inline ScalarBrdf lobe(double bandwidth, double height, Vec3d (*centre)(const Vec3d&)) {
    return [=](const Vec3d& wl, const Vec3d& wv) {
        return 0.1 + height * std::exp(bandwidth * (dot(centre(wl), wv) - 1));
    };
}
inline Vec3d mirror_direction(const Vec3d& wl) { return mirror(wl); }
inline Vec3d retroreflection(const Vec3d& wl) { return wl; }
inline Vec3d rotated_quarter(const Vec3d& wl) { return {-wl.y, wl.x, wl.z}; }

/// Expects that tables made from a BRDF have its highlight at the same place, also with light and viewer exchanged.
inline void expect_peaks_kept(const std::function<std::vector<Measured>(const Evaluate&)>& tables) {
    for (const auto& [f, place] :
         {std::pair<ScalarBrdf, PeakPosition>{lobe(40, 2, mirror_direction), PeakPosition::mirror},
          {lobe(40, 2, retroreflection), PeakPosition::retro},
          {[](const Vec3d&, const Vec3d&) { return 0.2; }, PeakPosition::none}})
        for (Measured measured : tables(to_evaluate(f))) {
            EXPECT_EQ(peak_of(measured).position, place) << measured.format;
            exchange(measured);
            EXPECT_EQ(peak_of(measured).position, place) << measured.format << " exchanged";
        }
}

}  // namespace srbf
