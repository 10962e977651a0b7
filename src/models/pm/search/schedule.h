// The schedule of a multivariate fit: its stages, in order, as tables.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include "models/pm/search/options.h"

namespace SRBF_NAMESPACE {

/// The work of a stage on each of its candidates.
enum class StageKind {
    grow,         ///< adds J lobes one by one, each the best of 256 random ones
    perturb,      ///< replaces the least useful lobe or variate by a random one, if that lowers the loss
    polish,       ///< takes steps, and replaces lobes that become useless
    by_pictures,  ///< takes steps, then orders candidates by the mean ΔE_ITP of pixels instead of their loss
    finish,       ///< takes steps as long as they pay off, adds exceeded bounds, and rounds
};

/// The number of first pairs that are rows: while there are many candidates, afterwards, and in the polish.
/// Pictures are observed beside `selection` and `all`. A quick fit, with fewer observations than another's polish,
/// uses `selection` instead of `search`, because its first candidates are its only ones.
enum class Pairs : std::size_t { search = 2048, selection = 4096, polish = 16384, all = 0 };

/// A stage of a fit, a row of the tables below.
struct Stage {
    StageKind kind = StageKind::by_pictures;
    bool adds_exceeded_pairs = false;        ///< first adds pairs at which candidates exceed the measurement
    bool adds_directional_lights = false;    ///< first adds these weights, relative to the best candidate's errors
    Pairs pairs = Pairs::all;                ///< the rows
    bool albedos = false, pictures = false;  ///< terms other than that of the pairs
    double fraction = 1;                     ///< fraction of the starts that take part, at least one
    std::size_t max_candidates = std::size_t(-1);  ///< maximum number of them
    double perturbations = 0;                      ///< fraction of the options' number, since the first stage
    int steps = 0;                                 ///< maximum number of Levenberg-Marquardt steps

    std::size_t candidates(const PmFitOptions& options) const {
        return std::min(std::size_t(std::max(std::lround(fraction * starts_of(options)), 1L)), max_candidates);
    }
    int perturbations_until(const PmFitOptions& options) const {
        return int(std::lround(perturbations * perturbations_of(options)));
    }
};

namespace stages {

using enum Pairs;

// clang-format off
/// With pairs and albedos only. A candidate after the best one is finished only if its error is at most 1 % larger: the
/// last steps lower the loss by 1 to 4 %.
inline constexpr Stage by_pairs[] = {
    {.kind = StageKind::grow, .pairs = search},
    {.kind = StageKind::perturb, .adds_exceeded_pairs = true, .pairs = search, .albedos = true, .perturbations = 0.2},
    {.kind = StageKind::perturb, .adds_exceeded_pairs = true, .pairs = selection, .albedos = true,
     .fraction = 0.5, .perturbations = 0.5},
    {.kind = StageKind::perturb, .adds_exceeded_pairs = true, .pairs = selection, .albedos = true,
     .fraction = 0.25, .perturbations = 1},
    {.kind = StageKind::polish, .adds_exceeded_pairs = true, .pairs = polish, .albedos = true,
     .max_candidates = 4, .steps = 25},
    {.kind = StageKind::finish, .pairs = all, .albedos = true, .max_candidates = 3},
};
/// With pictures. Candidates with the same loss of pairs look different, and further perturbations hardly lower
/// that loss: all candidates remain for pictures to choose from. The best one after all steps is nearly always
/// among the best ones after three.
inline constexpr Stage with_pictures[] = {
    {.kind = StageKind::grow, .pairs = search},
    {.kind = StageKind::perturb, .adds_exceeded_pairs = true, .pairs = search, .albedos = true,
     .perturbations = 0.12},
    {.kind = StageKind::perturb, .adds_exceeded_pairs = true, .pairs = search, .albedos = true,
     .perturbations = 0.28},
    {.kind = StageKind::by_pictures, .adds_exceeded_pairs = true, .adds_directional_lights = true,
     .pairs = selection, .albedos = true, .pictures = true, .steps = 3},
    {.kind = StageKind::by_pictures, .pairs = selection, .albedos = true, .pictures = true,
     .fraction = 0.25, .steps = 4},
    {.kind = StageKind::by_pictures, .pairs = selection, .albedos = true, .pictures = true,
     .fraction = 0.125, .steps = 8},
    {.kind = StageKind::finish, .adds_directional_lights = true, .pairs = all, .albedos = true,
     .pictures = true, .max_candidates = 1},
};
// clang-format on

static_assert(std::ranges::all_of(with_pictures, [](const Stage& stage) {
    return !stage.pictures || stage.pairs == selection || stage.pairs == all;
}));
// Weights of directional lights are added to the subset once, and to all observations once.
static_assert(std::ranges::count_if(with_pictures, [](const Stage& stage) {
                  return stage.adds_directional_lights && stage.pairs != all;
              }) <= 1);
static_assert(std::ranges::none_of(by_pairs, [](const Stage& stage) { return stage.kind == StageKind::by_pictures; }));

}  // namespace stages

inline std::span<const Stage> schedule(bool with_pictures) {
    if (with_pictures) return stages::with_pictures;
    return stages::by_pairs;
}

}  // namespace srbf
