// Lambert and GGX as tensors of a model file.
#pragma once
#include <string>
#include <string_view>

#include "base/safetensors.h"
#include "srbf/models/ggx.h"

namespace srbf {

template <> struct Stored<GgxModel> {
    static constexpr std::string_view name = "ggx", words = "Lambert and GGX";
    static Safetensors content(const GgxModel& model);
    static Result<GgxModel> read(Safetensors& content, const std::string& file_name);
    static double largest(const GgxModel& model);
};

}  // namespace srbf
