// Lambert and GGX as tensors of a model file.
#pragma once
#include <string>
#include <string_view>

#include "base/safetensors.h"
#include "srbf/models/ggx.h"

namespace srbf {

template <> struct Kind<GgxModel> {
    static constexpr std::string_view name = "ggx", words = "Lambert and GGX";
    static Safetensors content(const GgxModel& model);
    static Result<GgxModel> read(Safetensors& content, const std::string& file_name);
    static double largest(const GgxModel& model);
    static std::string summary(const GgxModel& model);
    static void add_rows(std::string& text, const GgxModel& model);
    static Parameters members(const GgxModel& model);
    static Parameters parameters(const GgxModel& model);
    static bool is_of(const ParameterReader& of);
    static GgxModel made_of(ParameterReader& of);
    /// Calls each(member) for all members.
    template <typename Each> static void for_members(GgxModel& of, const Each& each) {
        each(of.diffuse), each(of.lobes);
    }
};

}  // namespace srbf
