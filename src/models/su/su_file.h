// The view-by-view model as tensors of a model file.
#pragma once
#include <string>
#include <string_view>

#include "base/safetensors.h"
#include "srbf/models/su.h"

namespace srbf {

template <> struct Stored<SuModel> {
    static constexpr std::string_view name = "su", words = "view by view";
    static Safetensors content(const SuModel& model);
    static Result<SuModel> read(Safetensors& content, const std::string& file_name);
    static double largest(const SuModel& model);
};

}  // namespace srbf
