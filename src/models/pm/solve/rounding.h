// Conversion between the lobes of a fit and the stored numbers.
#pragma once
#include "models/pm/solve/lobe_problem.h"

namespace srbf {

/// The (a, b) in 16-bit floats whose direction is nearest to (cos angle, sin angle). Their scale is free, so the larger
/// one may be any of the 1024 halves of a binade: the error is below 3e-5, that of plain rounding 3e-4.
Parameterization rounded_direction(double angle);

/// The model of these lobes with the coefficients of the problem's last call of `loss`. With `log_scale`, the lobes get
/// log scales if the coefficient of a lobe with peak 1 leaves the normal range of 16-bit floats. `wavelengths`: of the
/// problem's channels; empty: R, G, B.
PmModel to_model(const LobeProblem& problem, const Lobes& lobes, bool log_scale,
                 const std::vector<float>& wavelengths = {});

/// `model`, which has these lobes, with every number rounded to a 16-bit float.
PmModel to_halves(PmModel model, const Lobes& lobes);

/// The lobes of a model of this shape.
Lobes to_lobes(const PmModel& model, const LobeShape& shape);

/// `lobes`, at which the problem's loss is the least, `unrounded`, with every number a 16-bit float. If that raises the loss,
/// they are rounded one after the other: those not yet rounded move to where the loss, to second order, is least with those
/// that are (Babai 1986, nearest plane).
Lobes rounded_lobes(LobeProblem& problem, const Lobes& lobes, double unrounded);

}  // namespace srbf
