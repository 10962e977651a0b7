// Surfaces of renderers' parameters as tensors of a model file.
#pragma once
#include <string>
#include <string_view>

#include "base/safetensors.h"
#include "srbf/models/openpbr.h"

namespace srbf {

template <> struct Stored<OpenPbrModel> {
    static constexpr std::string_view name = "openpbr", words = "surface of OpenPBR";
    static Safetensors content(const OpenPbrModel& model);
    static Result<OpenPbrModel> read(Safetensors& content, const std::string& file_name);
    static double largest(const OpenPbrModel&) { return 0; }  // its parameters have limits of their own
};

}  // namespace srbf
