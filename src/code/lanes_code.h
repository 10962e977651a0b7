// C of models whose lobes are the lanes of vectors: the part that srbf_runtime.h and exported C share.
#pragma once
#include <set>
#include <string>

#include "srbf/models/pm.h"
#include "srbf/sampling.h"

namespace SRBF_NAMESPACE {

/// Functions of numbers are named srbf_NAME, functions of vectors of numbers srbf_x_NAME.
enum class CNumbers { single, vectors };
/// The definitions in C that these functions of kernel.glsl need, without those in `known`, which the others join.
std::string kernel_in_c(const std::vector<std::string>& functions, CNumbers numbers, std::set<std::string>& known);

/// The text of vectors and of values of multivariate models; the text of densities and samples of mixtures. Each has a
/// guard, so that a program may include it several times. The names of their functions are added to `known`.
std::string lobes_in_c(std::set<std::string>& known);
std::string mixtures_in_c(std::set<std::string>& known);

/// The text of pm_value for a model, and of a mixture's numbers, which precede sample_light; then of sample_light and
/// light_pdf. @NAME@ is the name of a function in the printed program.
std::string value_in_c(const PmModel& model);
std::string mixture_in_c(const MixtureProposal& mixture);
extern const char* const k_sample_in_c;
extern const char* const k_pdf_in_c;

}  // namespace
