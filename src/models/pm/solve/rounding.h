// Conversion between the lobes of a fit and stored numbers.
#pragma once
#include "models/pm/solve/lobe_problem.h"

namespace SRBF_NAMESPACE {

/// The (a, b) in 16-bit floats whose direction is nearest to (cos angle, sin angle). Their scale is free, so that
/// the larger one may be any of the 1024 halves of a binade. The error is below 3e-5; plain rounding has 3e-4.
Parameterization rounded_direction(double angle);

/// The model of these lobes, with coefficients 0.
PmModel without_coefficients(const Lobes& lobes);

/// The model of these lobes with the coefficients of the problem's last call of `loss`. Lobes of form
/// gaussian have log scales if the coefficient of one leaves the normal range of 16-bit floats. `wavelengths` belong to
/// the problem's channels; if empty, these are R, G, B.
PmModel to_model(const LobeProblem& problem, const Lobes& lobes, const std::vector<float>& wavelengths = {});

/// Rounds every number of `model`, whose lobes are `lobes`, to a 16-bit float.
PmModel to_halves(PmModel model, const Lobes& lobes);

/// The lobes of a model with this shape.
Lobes to_lobes(const PmModel& model, const LobeShape& shape);

/// Rounds `lobes`, which minimise the problem's loss, to 16-bit floats; `unrounded` is their loss. If that raises
/// the loss, they are rounded one after the other, and after each the remaining ones move to the minimum of the
/// loss, to second order (Babai 1986, nearest plane).
Lobes round_lobes(LobeProblem& problem, const Lobes& lobes, double unrounded);

}  // namespace
