// The schedule of a multivariate fit: its stages, in order, as tables.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <string_view>

#include "models/pm/search/options.h"

namespace srbf {

/// The work of a stage on each of its candidates.
enum class StageKind {
    grow,         ///< J lobes one by one, each the best of 256 random ones
    perturb,      ///< replaces the least useful lobe or variate by a random one, if that lowers the loss
    polish,       ///< steps, and replaces lobes that become useless
    by_pictures,  ///< steps; candidates are then ordered by the mean ΔE_ITP of pixels, after the others by their loss
    finish,       ///< steps as long as they pay, bounds that are exceeded, and rounding
};

/// How many of the first pairs are rows: while there are many candidates, afterwards, and in the polish. Pictures are
/// observed beside `some` and `all`. A short fit, with fewer observations than another's polish, has `some` in place of
/// `few`: its first candidates are its only ones.
enum class Pairs : std::size_t { few = 2048, some = 4096, more = 16384, all = 0 };

/// A stage of a fit, a row of the tables below.
struct Stage {
    std::string_view name = {};
    StageKind work = StageKind::by_pictures;
    bool bounds = false;  ///< beforehand, pairs at which candidates exceed the measurement are added to the rows
    bool lights = false;  ///< beforehand, weights of point lights are added, relative to the best candidate's errors
    Pairs pairs = Pairs::all;                ///< the rows
    bool albedos = false, pictures = false;  ///< terms beside that of the pairs
    double share = 1;                        ///< of the starts: candidates that take part, at least one
    std::size_t most = std::size_t(-1);      ///< of them
    double perturbations = 0;                ///< share of the options' number, since the first stage
    int steps = 0;                           ///< at most, of Levenberg-Marquardt

    std::size_t candidates(const FitOptions& options) const {
        return std::min(std::size_t(std::max(std::lround(share * starts_of(options)), 1L)), most);
    }
    int perturbations_until(const FitOptions& options) const {
        return int(std::lround(perturbations * perturbations_of(options)));
    }
};

namespace stages {

inline constexpr bool o = false, x = true;
inline constexpr std::size_t every = std::size_t(-1);  ///< candidate
using enum Pairs;

// clang-format off
/// By pairs and albedos alone. After the best candidate another one is finished only if its error is at most 1 %
/// larger: the last steps lower the loss by 1 to 4 %.
inline constexpr Stage by_pairs[] = {
    // name      work            bounds   pairs albedos share   most   perturbations
    //                              lights         pictures                  steps
    {"grow",     StageKind::grow,        o, o, few,  o, o, 1,     every},
    {"perturb",  StageKind::perturb,     x, o, few,  x, o, 1,     every, 0.2},
    {"perturb",  StageKind::perturb,     x, o, some, x, o, 0.5,   every, 0.5},
    {"perturb",  StageKind::perturb,     x, o, some, x, o, 0.25,  every, 1},
    {"polish",   StageKind::polish,      x, o, more, x, o, 1,     4,     0,    25},
    {"finish",   StageKind::finish,      o, o, all,  x, o, 1,     3},
};
/// With pictures. Candidates with the same loss of pairs look different, and further perturbations lower that loss by
/// little: all of them remain for pictures to choose from. The best after all their steps are nearly always among the
/// best after three.
inline constexpr Stage with_pictures[] = {
    {"grow",     StageKind::grow,        o, o, few,  o, o, 1,     every},
    {"perturb",  StageKind::perturb,     x, o, few,  x, o, 1,     every, 0.12},
    {"perturb",  StageKind::perturb,     x, o, few,  x, o, 1,     every, 0.28},
    {"pictures", StageKind::by_pictures, x, x, some, x, x, 1,     every, 0,    3},
    {"pictures", StageKind::by_pictures, o, o, some, x, x, 0.25,  every, 0,    4},
    {"pictures", StageKind::by_pictures, o, o, some, x, x, 0.125, every, 0,    8},
    {"finish",   StageKind::finish,      o, x, all,  x, x, 1,     1},
};
// clang-format on

static_assert(std::ranges::all_of(with_pictures, [](const Stage& stage) {
    return !stage.pictures || stage.pairs == some || stage.pairs == all;
}));
// Weights of point lights are added to the subset once, and to all observations once.
static_assert(std::ranges::count_if(with_pictures,
                                    [](const Stage& stage) { return stage.lights && stage.pairs != all; }) <= 1);
static_assert(std::ranges::none_of(by_pairs, [](const Stage& stage) { return stage.work == StageKind::by_pictures; }));

}  // namespace stages

inline std::span<const Stage> schedule(bool with_pictures) {
    if (with_pictures) return stages::with_pictures;
    return stages::by_pairs;
}

}  // namespace srbf
