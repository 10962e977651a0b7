// Constants of MBSDF files.
#pragma once
#include <string_view>

namespace SRBF_NAMESPACE {

/// The first line, and the lines at the head of a block. Reflection has two alternatives.
inline constexpr std::string_view k_mbsdf_magic = "NVIDIA ARC MBSDF V1", k_mbsdf_reflection = "MBSDF_DATA_REFLECTION=",
                                  k_mbsdf_data = "MBSDF_DATA=", k_mbsdf_transmission = "MBSDF_DATA_TRANSMISSION=";

/// True for characters that a line of the header may not contain.
inline bool is_control(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }

}  // namespace srbf
