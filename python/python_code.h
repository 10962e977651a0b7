// Models as Python, for array libraries such as Dr.Jit and NumPy.
#pragma once
#include <string>

#include "srbf/model.h"
#include "srbf/result.h"

namespace SRBF_NAMESPACE {

/// The functions of a model as Python for a library of arrays: brdf(wl, wv), chosen_lobe(wv, selector),
/// sample_of_lobe(k, wv, u1, u2) for each k below `components`, light_pdf(wl, wv). The model's numbers are tables:
/// `lobes`, a row for each (coefficient, log scale, for each variate centre, unless the model is axial, and bandwidth,
/// negative if the centre is -z, then the exponents) and `variates`; or `model_numbers`. Errors: a view-by-view model,
/// a BSDF.
///
/// The text requires these names:
///   exp, exp2, log, sqrt, inversesqrt, cos, sin, abs, minimum, maximum, dot   on numbers or arrays
///   Real(x), whole(x), Vec3(x, y, z)    a number, an integer, a vector with members x, y, z
///   select(condition, a, b)             a where the condition holds, otherwise b
///   Structure(name=value, ..)           an object with any members
///   table(list), at(table, i)           constant numbers, and number i of them, i an int or an array
///   table(list, sources)                numbers of the model, with the (parameter, index) of `Table::sources` for each
/// Loops run over Python's int.
Result<std::string> python_code(const Model& model);

}  // namespace
