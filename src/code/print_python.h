// The syntax tree in Python.
#pragma once
#include <string>

#include "code/syntax.h"

namespace srbf::syntax {

/// Definitions in Python, which require of the names before them
///   exp, exp2, log, sqrt, inversesqrt, cos, sin, abs, minimum, maximum, dot   on numbers or arrays
///   Real(x), whole(x), Vec3(x, y, z)    a number, an integer, a vector with members x, y, z
///   select(condition, a, b)             a where the condition holds, otherwise b
///   Structure(name=value, ..)           an object with any members
///   table(list), at(table, i)           constant numbers, and number i of them, i an int or an array
///   table(list, sources)                numbers of the model, each a (parameter, index) as in `Table::sources`
/// Loops and the indices in them are over Python's int.
std::string python_text(const Table& table);
/// `function` of that program.
std::string python_text(const Function& function, const Program& program);

}  // namespace srbf::syntax
