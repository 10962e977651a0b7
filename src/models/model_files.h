// Definitions that files of models and of maps share.
#pragma once
#include <cstdint>

#include "srbf/map.h"

SRBF_BEGIN

/// The metadata `srbf` of all files; `model` of maps, and of maps of version 0.1 whose texels have lobes of their own.
inline constexpr std::string_view k_file_version = "1", k_map_kind = "pm-basis", k_stack_kind = "pm-stack";

/// Returns an error if a coefficient of the model, or a reflectance of its facets, is above the largest 16-bit float,
/// 65504, which `write_model` stores instead. `source` becomes `Error::source`.
Result<Done> check_range(const Model& model, const std::string& source);

/// The error if a model is expected and the file is a map.
Error map_error(const std::string& file);
/// True if these are the bytes of a map.
bool is_map_file(std::span<const std::byte> bytes);
/// A model with the mean of all texels' coefficients, and a model of lobe j alone with the coefficient 1.
Model mean_texel(const TexelMap& map);
Model lobe_alone(PmModel basis, std::size_t j);
/// The map with every number rounded to a 16-bit float.
TexelMap rounded(TexelMap map);
/// The beginning of the file of a map with these lobes and this number of texels T, up to its coefficients. They follow
/// as 16-bit floats [T,J,3], and then the errors [T].
std::vector<std::byte> beginning_of_map(const TexelMap& map, std::uint64_t texels);

SRBF_END
