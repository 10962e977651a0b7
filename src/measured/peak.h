// Where the highlight of a BRDF is: a check of the azimuths of a measurement.
#pragma once
#include <span>
#include <string>

#include "srbf/brdf.h"
#include "srbf/measured.h"

namespace [[gnu::visibility("default")]] srbf {

/// Where f is largest, of directions at the polar angle of the light.
enum class PeakPlace {
    mirror,     ///< about the mirror direction
    retro,      ///< about the light
    beside,     ///< about the directions at 90° from the plane of incidence
    elsewhere,  ///< away from all of these
    none,       ///< nowhere: all are within a factor of 2
    unknown     ///< nothing was measured about two of them, with light more than 10° off the normal
};
const char* name(PeakPlace place);

struct Peak {
    PeakPlace place = PeakPlace::unknown;
    double ratio = 1;  ///< see `peak_of`; at most `k_most_peak`
};
inline constexpr double k_most_peak = 1000;

/// The place of the highlight. With the light at θ_l and azimuth 0, pairs within 10° of (θ_l, 180°) are of the mirror
/// direction, of (θ_l, 0) retro and of (θ_l, ±90°) beside, whichever is nearest; others are elsewhere. The level of a place
/// is the largest of the means of the luminance of f within ¼°, to 1°, to 4° and beyond; elsewhere it is the mean of
/// all. The levels are of four intervals of θ_l from 10 to 70°, with θ_v ≤ 75°. A place has a score, the mean over the
/// intervals of the logarithm of its level over the least one there; the place with the largest score has the peak, if in
/// one of the intervals its level is at least twice the least one: `ratio` is the largest of these. Equal polar angles make
/// this independent of what happens towards grazing. What is not finite is left out; light below the horizon too.
/// In transmission, in the frame of the part (bsdf.h), the mirror direction is straight through.
Peak peak_of(std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<const Rgb> f);
/// The peak of a function, of pairs of lights at four polar angles and eight azimuths, with viewers dense about the four
/// directions.
Peak peak_of(const Evaluate& brdf);
/// The peak of the samples of a measurement, or of the values of a table; of a BSDF that of its first part.
Peak peak_of(const Measured& measured);

/// A sentence about the peak, which asks about the azimuths where they seem wrong.
std::string peak_text(const Peak& peak, bool is_transmission = false);

}  // namespace srbf
