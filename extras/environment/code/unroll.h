// Loops of exported code, written out.
#pragma once
#include "code/syntax.h"

namespace SRBF_NAMESPACE::syntax {

/// Repeats the bodies of loops over arrays and tables whose lengths are known, up to 32, and replaces numbers of tables
/// whose indices are known by their values: some compilers of shaders do neither. The program must have been
/// specialised.
void unroll(Program& program, const std::vector<std::string>& roots);

}  // namespace srbf::syntax
