// The position of a BRDF's highlight: a check of the azimuths of a measurement.
#pragma once
#include "srbf/brdf.h"
#include "srbf/measured.h"

namespace srbf {

/// The directions to the viewer at which f is largest.
enum class PeakPosition {
    mirror,     ///< around the mirror direction
    retro,      ///< around the light
    beside,     ///< around the directions at 90° from the plane of incidence
    elsewhere,  ///< away from all of these
    none,       ///< all levels are within a factor of 2
    unknown     ///< fewer than two of the positions were measured, with light more than 10° off the normal
};
const char* name(PeakPosition position);

struct Peak {
    PeakPosition position = PeakPosition::unknown;
    double ratio = 1;  ///< see `peak_of`; at most `k_max_peak`
};
inline constexpr double k_max_peak = 1000;

/// The position of the highlight. With the light at (θ_l, 0), pairs with viewers within 10° of (θ_l, 180°) belong to
/// the mirror direction, of (θ_l, 0) to retro and of (θ_l, ±90°) to beside, whichever is nearest; others are elsewhere.
/// Pairs are divided into four intervals of θ_l from 10° to 70°, with θ_v ≤ 75°. The level of a position in an interval
/// is the largest mean of the luminance of f over four shells, bounded by ¼°, 1° and 4° from the direction; elsewhere
/// it is the mean of all pairs. The score of a position is the mean over the intervals of log (level / least level).
/// The peak is the position with the largest score, provided that in some interval its level is at least twice the
/// least one; `ratio` is the largest such quotient. Equal polar angles make this independent of the growth of f towards
/// grazing angles. Values that are not finite and directions below the horizon are ignored. In transmission, in the
/// frame of the part (brdf.h), the mirror direction is straight through.
Peak peak_of(std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<const Rgb> f);
/// The peak of a function for lights at four polar angles and eight azimuths, and viewers densely around four directions.
Peak peak_of(const Evaluate& brdf);
/// The peak of the samples of a measurement, or of the values of a table. For a BSDF it is the peak of the first part.
Peak peak_of(const Measured& measured);

/// A sentence about the peak, with a question if the azimuths seem wrong.
std::string peak_text(const Peak& peak, bool is_transmission = false);

}  // namespace srbf
