// The schedule of a multivariate fit: its stages, in order, as tables.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <string_view>

#include "fit/options.h"

namespace srbf {

/// What a stage does with each of its candidates.
enum class Work {
    grow,     ///< J lobes one by one, each the best of 256 random ones
    perturb,  ///< replaces the least useful lobe or variate by a random one, if that lowers the loss
    polish,   ///< steps, and replaces lobes that become useless
    steps,    ///< steps alone
    finish,   ///< steps as long as they pay, bounds that are exceeded, and rounding
};
/// What candidates are ordered by after a stage.
enum class Order {
    loss,
    delta_e,  ///< mean ΔE_ITP of the pictures' pixels
};

/// A stage of a fit, a row of the tables below.
struct Stage {
    std::string_view name = {};
    Work work = Work::steps;
    /// Beforehand, pairs at which candidates exceed the measurement are added to the rows.
    bool bounds = false;
    /// Beforehand, weights adapt to the errors of the best candidate.
    bool reweights = false;
    std::size_t pairs = 0;                   ///< the rows: the first so many pairs; 0: all
    bool albedos = false, pictures = false;  ///< terms beside that of the pairs
    double share = 1;                        ///< of the starts: candidates that take part, at least one
    std::size_t most = std::size_t(-1);      ///< of them
    double perturbations = 0;                ///< share of the options' number, since the first stage
    int steps = 0;                           ///< at most, of Levenberg-Marquardt
    Order order = Order::loss;

    std::size_t candidates(const FitOptions& options) const {
        return std::min(std::size_t(std::max(std::lround(share * starts_of(options)), 1L)), most);
    }
    int perturbations_until(const FitOptions& options) const {
        return int(std::lround(perturbations * perturbations_of(options)));
    }
};

/// Numbers of pairs while there are many candidates, afterwards, and in the polish. A short fit, with fewer
/// observations than another's polish, uses the second number from the start: its first candidates are its only ones.
inline constexpr std::size_t k_few = 2048, k_some = 4096, k_more = 16384;

/// By pairs and albedos alone. After the best candidate another one is finished only if its error is at most 1 %
/// larger: the last steps lower the loss by 1 to 4 %.
inline constexpr Stage k_stages_by_pairs[] = {
    {.name = "grow", .work = Work::grow, .pairs = k_few},
    {.name = "perturb", .work = Work::perturb, .bounds = true, .pairs = k_few, .albedos = true, .perturbations = 0.2},
    {.name = "perturb",
     .work = Work::perturb,
     .bounds = true,
     .pairs = k_some,
     .albedos = true,
     .share = 0.5,
     .perturbations = 0.5},
    {.name = "perturb",
     .work = Work::perturb,
     .bounds = true,
     .pairs = k_some,
     .albedos = true,
     .share = 0.25,
     .perturbations = 1},
    {.name = "polish", .work = Work::polish, .bounds = true, .pairs = k_more, .albedos = true, .most = 4},
    {.name = "finish", .work = Work::finish, .albedos = true, .most = 3},
};
/// With pictures. Candidates with the same loss of pairs look different, and further perturbations lower that loss by
/// little: all of them remain for pictures to choose from. The best after all their steps are nearly always among the
/// best after three. Of the last two the least sum decides, which knows radiance; ΔE_ITP does not.
inline constexpr Stage k_stages_with_pictures[] = {
    {.name = "grow", .work = Work::grow, .pairs = k_few},
    {.name = "perturb", .work = Work::perturb, .bounds = true, .pairs = k_few, .albedos = true, .perturbations = 0.12},
    {.name = "perturb", .work = Work::perturb, .bounds = true, .pairs = k_few, .albedos = true, .perturbations = 0.28},
    {.name = "pictures",
     .work = Work::steps,
     .bounds = true,
     .reweights = true,
     .pairs = k_some,
     .albedos = true,
     .pictures = true,
     .steps = 3,
     .order = Order::delta_e},
    {.name = "pictures",
     .work = Work::steps,
     .pairs = k_some,
     .albedos = true,
     .pictures = true,
     .share = 0.25,
     .steps = 4,
     .order = Order::delta_e},
    {.name = "pictures",
     .work = Work::steps,
     .pairs = k_some,
     .albedos = true,
     .pictures = true,
     .share = 0.125,
     .steps = 8,
     .order = Order::delta_e},
    {.name = "compare",
     .work = Work::steps,
     .reweights = true,
     .albedos = true,
     .pictures = true,
     .most = 2,
     .steps = 6},
    {.name = "finish", .work = Work::finish, .reweights = true, .albedos = true, .pictures = true, .most = 1},
};
inline std::span<const Stage> schedule(bool with_pictures) {
    if (with_pictures) return k_stages_with_pictures;
    return k_stages_by_pairs;
}

}  // namespace srbf
