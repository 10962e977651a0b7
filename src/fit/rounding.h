// Between the lobes that are fitted and the numbers that are stored.
#pragma once
#include "fit/lobes.h"

namespace srbf {

/// (a, b) in halves whose direction is nearest to (cos angle, sin angle): their scale is free, so that among
/// the 1024 halves of one binade the larger of them may be chosen which fits best; errs by less than 3e-5
/// where plain rounding errs by 3e-4.
Parameterization rounded_direction(double angle);

/// The model of these lobes with the coefficients of the problem's last call of `loss`. Where a coefficient
/// of a lobe whose peak is 1 leaves the range in which halves have all their digits, and `log_scale`, the
/// lobes get log scales. `wavelengths`: of the problem's channels; empty: R, G, B.
PmModel to_model(const LobeProblem& problem, const Lobes& lobes, bool log_scale,
                 const std::vector<float>& wavelengths = {});

/// `model`, that of these lobes, with every number rounded to a half.
PmModel to_halves(PmModel model, const Lobes& lobes);

/// The lobes of such a model, of which they have the shape.
Lobes to_lobes(const PmModel& model, const LobeShape& shape);

/// How numbers are rounded in turn.
struct Turns {
    int count;         ///< at most; the first takes the angles, the last all that is left
    std::size_t part;  ///< the others take one in so many of what is left
    int steps;         ///< of what has not been rounded, after each turn
};

/// `lobes`, which minimise the problem's loss, with every number a half. They are not rounded at once but in turn, first the angles, then those weights
/// of which rounding costs most, a part of what is left each time; after each turn what has not been rounded follows what has.
Lobes rounded_in_turn(LobeProblem& problem, const Lobes& lobes, const Turns& turns);

}  // namespace srbf
