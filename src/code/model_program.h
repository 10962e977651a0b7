// The program that evaluates a model: kernel.glsl with the model's numbers, before it is printed in a language.
#pragma once
#include "code/added_code.h"
#include "code/syntax.h"
#include "srbf/shading_code.h"

namespace SRBF_NAMESPACE {

/// The storage of a model's numbers in a program. Numbers of lobes are in a table.
enum class ParameterStorage {
    constants,  ///< other numbers are in the text
    tables,     ///< other numbers are in a table
    arguments,  ///< the coefficients of lobes are members of a handle, which is an argument of all functions
};

/// The definitions that these functions of kernel.glsl require (`roots`), with the numbers of the model.
syntax::Program program_of(const Model& model, const CodeOptions& options, const std::vector<std::string>& roots,
                           const AddedCode& added = {}, ParameterStorage storage = ParameterStorage::constants);

}  // namespace
