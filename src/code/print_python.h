#pragma once
#include "code/syntax.h"

namespace SRBF_NAMESPACE::syntax {

/// Definitions in Python, which require these names:
///   exp, exp2, log, sqrt, inversesqrt, cos, sin, abs, minimum, maximum, dot   on numbers or arrays
///   Real(x), whole(x), Vec3(x, y, z)    a number, an integer, a vector with members x, y, z
///   select(condition, a, b)             a where the condition holds, otherwise b
///   Structure(name=value, ..)           an object with any members
///   table(list), at(table, i)           constant numbers, and number i of them, i an int or an array
///   table(list, sources)                numbers of the model, with the (parameter, index) of `Table::sources` for each
/// Loops run over Python's int.
std::string python_text(const Table& table);
std::string python_text(const Function& function, const Program& program);

}  // namespace srbf::syntax
