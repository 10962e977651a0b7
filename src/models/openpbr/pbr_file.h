// Surfaces of renderers' parameters as tensors of a model file.
#pragma once
#include <string>
#include <string_view>

#include "base/safetensors.h"
#include "srbf/models/openpbr.h"

namespace srbf {

template <> struct Stored<PbrModel> {
    static constexpr std::string_view name = "pbr", words = "surface of OpenPBR";
    static Safetensors content(const PbrModel& model);
    static Result<PbrModel> read(Safetensors& content, const std::string& file_name);
    static double largest(const PbrModel&) { return 0; }  // its parameters have limits of their own
};

}  // namespace srbf
