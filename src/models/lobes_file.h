// The metadata of files with several models: stacks and libraries of multivariate models.
#pragma once
#include <array>
#include <string_view>
#include <utility>

namespace SRBF_NAMESPACE {

/// The metadata `srbf` of all files.
inline constexpr std::string_view k_file_version = "1";

/// The metadata `model` of files of several models, and what such a file is called, with its name for {0}.
inline constexpr std::string_view k_stack_kind = "pm-stack", k_library_kind = "pm-basis";
inline constexpr std::array<std::pair<std::string_view, std::string_view>, 2> k_kinds_of_several{
    {{k_stack_kind, "a stack of them, which {0}#0, {0}#1, .. name"},
     {k_library_kind, "a library of them, which {0}#NAME names"}}};

}  // namespace srbf
