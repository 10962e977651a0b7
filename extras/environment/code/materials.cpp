#include "extras/environment/code/materials.h"
#include "base/errors.h"

#include <cctype>

namespace SRBF_NAMESPACE {

std::string capitalised(const std::string& name) {
    std::string words;
    bool is_first = true;
    for (const char c : name) {
        if (c != '_') words += is_first ? char(std::toupper(static_cast<unsigned char>(c))) : c;
        is_first = c == '_';
    }
    return words;
}

void replace_all(std::string& text, std::string_view place, std::string_view replacement) {
    for (auto position = text.find(place); position != text.npos;
         position = text.find(place, position + replacement.size()))
        text.replace(position, place.size(), replacement);
}

Result<Done> check_materials(std::span<const NamedModel> models) {
    for (const NamedModel& named : models) {
        if (std::holds_alternative<SuModel>(named.model->model))
            return argument_error(named.name, "model", "multivariate, or Lambert and GGX", "view by view");
        if (std::holds_alternative<BsdfModel>(named.model->model))
            return argument_error(named.name, "model", "a BRDF, such as a part of a BSDF", "a BSDF");
    }
    return Done{};
}

}  // namespace
